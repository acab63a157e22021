// Bytes in LCM's encoding, which LCM messages, recordings and shows are made of: writer and reader.
#pragma once
#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace strandcast {

/// LCM's encoding of numbers, texts and arrays: big-endian; a text's length includes a final zero byte.
/// Writer and reader have the same members, so that one function describes a message or a record. Those with
/// names are the visitors of wire_fields.h.
template <size_t kBytes>
using UnsignedOf = std::conditional_t<
    kBytes == 8, uint64_t,
    std::conditional_t<kBytes == 4, uint32_t, std::conditional_t<kBytes == 2, uint16_t, uint8_t>>>;

template <class Number>
void storeBigEndian(Number value, uint8_t* to) {
  auto bits = std::bit_cast<UnsignedOf<sizeof(Number)>>(value);
  for (size_t i = sizeof bits; i-- > 0; bits = static_cast<decltype(bits)>(bits >> (sizeof bits > 1 ? 8 : 0)))
    to[i] = static_cast<uint8_t>(bits);
}

template <class Number>
Number loadBigEndian(const uint8_t* from) {
  using Bits = UnsignedOf<sizeof(Number)>;
  Bits bits = 0;
  for (size_t i = 0; i < sizeof bits; ++i)
    bits = static_cast<Bits>((sizeof bits > 1 ? bits << 8 : 0) | from[i]);
  return std::bit_cast<Number>(bits);
}

/// Appends a message to a byte vector.
class MessageWriter {
 public:
  explicit MessageWriter(std::vector<uint8_t>& bytes) : bytes_(bytes) { bytes_.clear(); }
  template <class Number>
  void number(const Number& value) {
    storeBigEndian(value, grow(sizeof value));
  }
  void text(std::string_view value) {
    number(static_cast<uint32_t>(value.size() + 1));
    std::copy(value.begin(), value.end(), grow(value.size() + 1));  // the byte after it is 0
  }
  template <class Array>
  void items(const Array& values) {
    constexpr size_t kSize = sizeof(values[0]);
    uint8_t* to = grow(values.size() * kSize);
    for (const auto& value : values) storeBigEndian(value, to), to += kSize;
  }
  template <class Number>
  void array(const std::vector<Number>& values) {
    number(static_cast<uint32_t>(values.size()));
    items(values);
  }

  void key(const char*, const auto& value) { number(value); }
  void number(const char*, const auto& value) { number(value); }
  void text(const char*, std::string_view value, size_t limit) { text(value.substr(0, limit)); }
  void items(const char*, const auto& values) { items(values); }
  void array(const char*, const auto& values, size_t) { array(values); }

 private:
  /// Appends zeros.
  uint8_t* grow(size_t count) {
    bytes_.resize(bytes_.size() + count);
    return bytes_.data() + bytes_.size() - count;
  }
  std::vector<uint8_t>& bytes_;
};

/// Does not trust lengths: arrays never exceed the bytes that are there. After the first mismatch ok() is
/// false and the values read are unspecified.
class MessageReader {
 public:
  explicit MessageReader(std::span<const uint8_t> bytes) : bytes_(bytes) {}
  bool ok() const { return ok_; }
  bool atEnd() const { return ok_ && bytes_.empty(); }
  template <class Number>
  void number(Number& value) {
    if (const uint8_t* from = take(sizeof value)) value = loadBigEndian<Number>(from);
  }
  void text(std::string& value) {
    const size_t length = this->length(1);
    const uint8_t* from = take(length);
    if (length == 0 || from == nullptr || from[length - 1] != 0) {
      ok_ = false;
      return;
    }
    value.assign(reinterpret_cast<const char*>(from), length - 1);
  }
  template <class Array>
  void items(Array& values) {
    constexpr size_t kSize = sizeof(values[0]);
    const uint8_t* from = take(values.size() * kSize);
    if (from == nullptr) return;
    for (auto& value : values) {
      value = loadBigEndian<std::remove_reference_t<decltype(value)>>(from);
      from += kSize;
    }
  }
  template <class Number>
  void array(std::vector<Number>& values, size_t limit = std::numeric_limits<uint32_t>::max()) {
    values.resize(length(sizeof(Number), limit));
    items(values);
  }

  void key(const char*, auto& value) { number(value); }
  void number(const char*, auto& value) { number(value); }
  void text(const char*, std::string& value, size_t limit) {
    text(value);
    if (value.size() > limit) value.resize(limit);
  }
  void items(const char*, auto& values) { items(values); }
  void array(const char*, auto& values, size_t limit) { array(values, limit); }

 private:
  /// Length of an array; 0 when it exceeds `limit` or the bytes that are left.
  size_t length(size_t item_bytes, size_t limit = std::numeric_limits<uint32_t>::max()) {
    uint32_t count = 0;
    number(count);
    if (count <= limit && count <= bytes_.size() / item_bytes) return count;
    ok_ = false;
    return 0;
  }
  const uint8_t* take(size_t count) {
    if (!ok_ || count > bytes_.size()) {
      ok_ = false;
      return nullptr;
    }
    const uint8_t* from = bytes_.data();
    bytes_ = bytes_.subspan(count);
    return from;
  }
  std::span<const uint8_t> bytes_;
  bool ok_ = true;
};

}  // namespace strandcast
