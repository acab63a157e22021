// DDS samples as bytes: CDR as OMG DDSI-RTPS 2.3, 10, calls it, and the key hash of DDSI-RTPS 9.6.3.8.
#pragma once
#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "transport/message_bytes.h"
#include "transport/wire_fields.h"

namespace strandcast {

/// Encapsulation: two bytes for the encoding, two that are 0. Alignment counts from behind it.
inline constexpr size_t kCdrHead = 4;

/// Writes a message in this machine's byte order. A visitor of wire_fields.h.
class CdrWriter {
 public:
  /// What does not fit `to` is counted and not written.
  explicit CdrWriter(std::span<uint8_t> to) : to_(to) {
    const uint8_t head[kCdrHead] = {0, std::endian::native == std::endian::little, 0, 0};
    put(head, sizeof head, 1);
  }
  /// Bytes of all that was passed.
  size_t size() const { return size_; }

  void key(const char*, const auto& value) { number("", value); }
  void number(const char*, const auto& value) { put(&value, sizeof value, sizeof value); }
  void text(const char*, const std::string& value, size_t limit) {
    const auto length = static_cast<uint32_t>(std::min(value.size(), limit));
    number("", length + 1);
    put(value.data(), length, 1);
    number("", uint8_t{0});
  }
  void items(const char*, const auto& values) {
    constexpr size_t kSize = sizeof values[0];
    put(values.data(), kSize * values.size(), kSize);
  }
  void array(const char*, const auto& values, size_t) {
    number("", static_cast<uint32_t>(values.size()));
    if (!values.empty()) items("", values);  // an empty one is not aligned
  }

 private:
  void put(const void* from, size_t bytes, size_t alignment) {
    const size_t padding = (kCdrHead - size_) % alignment;  // modulo 2^64: alignments are powers of 2
    const size_t end = size_ + padding + bytes;
    if (end <= to_.size()) {
      std::fill_n(to_.data() + size_, padding, uint8_t{0});
      if (bytes > 0) std::memcpy(to_.data() + end - bytes, from, bytes);
    }
    size_ = end;
  }
  std::span<uint8_t> to_;
  size_t size_ = 0;
};

/// Reads either byte order, without parameter lists. Does not trust lengths: arrays never exceed their limit
/// or the bytes that are there. After the first mismatch ok() is false and the values read are unspecified. A
/// visitor of wire_fields.h.
class CdrReader {
 public:
  explicit CdrReader(std::span<const uint8_t> bytes) : bytes_(bytes) {
    const uint8_t* const head = take(kCdrHead, 1);
    ok_ = head != nullptr && head[0] == 0 && head[1] <= 1;
    swaps_ = ok_ && (head[1] == 1) != (std::endian::native == std::endian::little);
  }
  /// Bytes behind the last field do not count: senders pad samples.
  bool ok() const { return ok_; }

  void key(const char*, auto& value) { numbers(&value, 1); }
  void number(const char*, auto& value) { numbers(&value, 1); }
  void text(const char*, std::string& value, size_t limit) {
    const size_t length = this->length(1, bytes_.size());
    const uint8_t* const from = take(length, 1);
    if (from == nullptr || (length > 0 && from[length - 1] != 0)) {
      ok_ = false;
      return;
    }
    // An empty text may come without its final zero: Fast CDR accepts that too.
    value.assign(reinterpret_cast<const char*>(from), std::min(length - (length > 0 ? 1 : 0), limit));
  }
  void items(const char*, auto& values) { numbers(values.data(), values.size()); }
  void array(const char*, auto& values, size_t limit) {
    values.resize(length(sizeof values[0], limit));
    if (!values.empty()) numbers(values.data(), values.size());
  }

 private:
  /// Length of an array; 0 when it exceeds `limit` or the bytes that are left.
  size_t length(size_t item_bytes, size_t limit) {
    uint32_t count = 0;
    numbers(&count, 1);
    if (count <= limit && count <= (bytes_.size() - at_) / item_bytes) return count;
    ok_ = false;
    return 0;
  }
  template <class Number>
  void numbers(Number* to, size_t count) {
    const uint8_t* const from = take(count * sizeof(Number), sizeof(Number));
    if (from == nullptr) return;
    std::memcpy(to, from, count * sizeof(Number));
    if (!swaps_ || sizeof(Number) == 1) return;
    for (Number* number = to; number != to + count; ++number) {
      auto* const bytes = reinterpret_cast<uint8_t*>(number);
      std::reverse(bytes, bytes + sizeof(Number));
    }
  }
  const uint8_t* take(size_t count, size_t alignment) {
    const size_t padding = (kCdrHead - at_) % alignment;  // as in CdrWriter
    if (!ok_ || count + padding > bytes_.size() - at_) {
      ok_ = false;
      return nullptr;
    }
    at_ += padding + count;
    return bytes_.data() + at_ - count;
  }
  std::span<const uint8_t> bytes_;
  size_t at_ = 0;
  bool ok_ = true, swaps_ = false;
};

/// The keys of a message, big-endian, which name its instance; at most 16 bytes. A visitor of wire_fields.h.
class CdrKeyWriter {
 public:
  void key(const char*, const auto& value) {
    size_ += (0 - size_) % sizeof value;
    storeBigEndian(value, &bytes_.at(size_ + sizeof value - 1) + 1 - sizeof value);
    size_ += sizeof value;
  }
  void number(const char*, const auto&) {}
  void text(const char*, const std::string&, size_t) {}
  void items(const char*, const auto&) {}
  void array(const char*, const auto&, size_t) {}
  /// Zeros behind size().
  const std::array<uint8_t, 16>& bytes() const { return bytes_; }
  size_t size() const { return size_; }

 private:
  std::array<uint8_t, 16> bytes_{};
  size_t size_ = 0;
};

/// Writes a message, as far as it fits, and returns its size in bytes.
template <class Message>
size_t writeCdr(const Message& message, std::span<uint8_t> to) {
  CdrWriter writer(to);
  fields(writer, message, std::type_identity<Message>());
  return writer.size();
}

/// False on damage; the content of the message is unspecified then. Field values are not checked.
template <class Message>
bool readCdr(std::span<const uint8_t> bytes, Message& message) {
  CdrReader reader(bytes);
  fields(reader, message, std::type_identity<Message>());
  return reader.ok();
}

template <class Message>
CdrKeyWriter cdrKey(const Message& message) {
  CdrKeyWriter key;
  fields(key, message, std::type_identity<Message>());
  return key;
}

}  // namespace strandcast
