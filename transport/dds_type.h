// The type of a topic of the wire for Fast DDS, made of the message's list of fields.
#pragma once
#include <fastrtps/utils/md5.h>
#include <fastdds/dds/topic/TopicDataType.hpp>

#include <algorithm>
#include <functional>
#include <string>

#include "transport/cdr.h"

namespace strandcast {

/// Samples are the messages themselves: the pointers that Fast DDS passes are to a Message.
template <class Message>
class WireType final : public eprosima::fastdds::dds::TopicDataType {
 public:
  WireType() {
    const std::string version = std::to_string(kWireVersion);
    setName(("strandcast::v" + version + "::" + kWireName<Message>).c_str());
    m_typeSize = kMaxSampleBytes;
    m_isGetKeyDefined = true;
  }

  bool serialize(void* data, eprosima::fastrtps::rtps::SerializedPayload_t* payload) override {
    const size_t size = writeCdr(*static_cast<const Message*>(data), {payload->data, payload->max_size});
    if (size > payload->max_size) return false;
    payload->length = static_cast<uint32_t>(size);
    payload->encapsulation = std::endian::native == std::endian::little ? CDR_LE : CDR_BE;
    return true;
  }

  bool deserialize(eprosima::fastrtps::rtps::SerializedPayload_t* payload, void* data) override {
    return readCdr(std::span<const uint8_t>(payload->data, payload->length), *static_cast<Message*>(data));
  }

  std::function<uint32_t()> getSerializedSizeProvider(void* data) override {
    return [message = static_cast<const Message*>(data)] {
      return static_cast<uint32_t>(writeCdr(*message, {}));
    };
  }

  /// `force_md5`: with security, so that handles do not tell the keys.
  bool getKey(void* data, eprosima::fastrtps::rtps::InstanceHandle_t* handle, bool force_md5) override {
    const CdrKeyWriter key = cdrKey(*static_cast<const Message*>(data));
    std::array<uint8_t, 16> bytes = key.bytes();
    if (force_md5) {
      MD5 md5;
      md5.update(key.bytes().data(), static_cast<MD5::size_type>(key.size()));
      md5.finalize();
      std::copy_n(md5.digest, bytes.size(), bytes.begin());
    }
    for (size_t i = 0; i < bytes.size(); ++i) handle->value[i] = bytes[i];
    return true;
  }

  void* createData() override { return new Message; }
  void deleteData(void* data) override { delete static_cast<Message*>(data); }

 private:
  /// What Fast DDS sets aside for a sample at first: arrays of kMaxChunkBytes, and the other fields. It
  /// grows.
  static constexpr uint32_t kMaxSampleBytes = 66000;
};

}  // namespace strandcast
