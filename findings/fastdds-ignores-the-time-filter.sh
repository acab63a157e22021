#!/usr/bin/env bash
# Fast DDS 2.9.1: TIME_BASED_FILTER is accepted and has no effect.
# Package: libfastrtps-dev 2.9.1 (Debian 12)
# Expected: DDS 1.4, 2.2.3.12: at most one sample of an instance each minimum_separation; a reader that cannot is not made.
# Seen: the reader is made, says the separation when it is asked for its settings, and gets everything.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
# have PACKAGE VERSION: it is installed in this version, or is unpacked below root/.
have() {
  case $(dpkg-query -W -f "\${Version}" "$1" 2>/dev/null) in "$2"*) return ;; esac
  { apt-get download "$1" && deb=$(ls "$1"_*.deb) && dpkg -x "$deb" root; } >/dev/null 2>&1 || deb=
  case $([ -n "$deb" ] && dpkg-deb -f "$deb" Version) in "$2"*) return ;; esac
  echo "skipped: $1 $2 cannot be had"
  exit 77
}
have libfastrtps-dev 2.9.1
have libfastrtps2.9 2.9.1
have libfastcdr-dev 1.0
have libfastcdr1 1.0
lib=root/usr/lib/$(gcc -print-multiarch)
export LD_LIBRARY_PATH=$work/$lib
cat > try.cc <<'C'
#include <chrono>
#include <cstdio>
#include <cstring>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/TopicDataType.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>
#include <thread>
using namespace eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;
// A number, which is its key, too.
struct NumberType : TopicDataType {
  NumberType() {
    setName("Number");
    m_typeSize = 4;
    m_isGetKeyDefined = true;
  }
  bool serialize(void *data, rtps::SerializedPayload_t *to) override {
    std::memcpy(to->data, data, to->length = 4);
    return true;
  }
  bool deserialize(rtps::SerializedPayload_t *from, void *data) override { return std::memcpy(data, from->data, 4); }
  std::function<uint32_t()> getSerializedSizeProvider(void *) override { return [] { return 4u; }; }
  void *createData() override { return new int; }
  void deleteData(void *data) override { delete static_cast<int *>(data); }
  bool getKey(void *data, rtps::InstanceHandle_t *key, bool) override {
    std::memset(key->value, 0, 16);
    for (int i = 0; i < 4; ++i) key->value[i] = static_cast<unsigned char *>(data)[i];
    return true;
  }
};
int main() {
  auto *participant = DomainParticipantFactory::get_instance()->create_participant(0, PARTICIPANT_QOS_DEFAULT);
  if (!participant) return 77;
  TypeSupport(new NumberType).register_type(participant);
  auto *topic = participant->create_topic("numbers", "Number", TOPIC_QOS_DEFAULT);
  auto *publisher = participant->create_publisher(PUBLISHER_QOS_DEFAULT);
  auto *subscriber = participant->create_subscriber(SUBSCRIBER_QOS_DEFAULT);
  DataReaderQos settings = DATAREADER_QOS_DEFAULT;
  settings.reliability().kind = RELIABLE_RELIABILITY_QOS;
  settings.history().kind = KEEP_ALL_HISTORY_QOS;
  settings.deadline().period = {10, 0};
  settings.time_based_filter().minimum_separation = {1, 0};
  auto *reader = subscriber->create_datareader(topic, settings);
  if (!reader) return std::puts("the reader is refused"), 1;
  DataWriterQos written = DATAWRITER_QOS_DEFAULT;
  written.deadline().period = {10, 0};
  auto *writer = publisher->create_datawriter(topic, written);
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  int key = 1, received = 0;
  for (int i = 0; i < 20; ++i) {
    writer->write(&key);
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    SampleInfo info;
    while (reader->take_next_sample(&key, &info) == ReturnCode_t::RETCODE_OK) received += info.valid_data;
  }
  std::printf("separation %d s; of 20 samples in 0.4 s %d received\n",
              reader->get_qos().time_based_filter().minimum_separation.seconds, received);
  return received > 10 ? 0 : 1;
}
C
g++ -std=c++17 -w -I root/usr/include try.cc -o try -L "$lib" -l:libfastrtps.so.2.9 -l:libfastcdr.so.1 -Wl,--allow-shlib-undefined
# On a loopback of its own, so that no other program hears it.
unshare -rn true 2>/dev/null || { echo "skipped: no network namespace"; exit 77; }
unshare -rn sh -c 'ip link set lo up && exec ./try'
