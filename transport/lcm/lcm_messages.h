// The messages of strandcast.lcm as bytes, with their fingerprints.
#pragma once
#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "transport/message_bytes.h"
#include "transport/wire_fields.h"

namespace strandcast {

/// LCM's type of a field. LCM has no unsigned numbers: those of the same size hold the bits.
template <class Number>
constexpr std::string_view lcmType() {
  if constexpr (std::is_floating_point_v<Number>) return sizeof(Number) == 8 ? "double" : "float";
  switch (sizeof(Number)) {
    case 8:
      return "int64_t";
    case 4:
      return "int32_t";
    case 2:
      return "int16_t";
    default:
      return "byte";
  }
}

/// The hash that lcm-gen makes of names and types of a struct's fields: lcm_struct_hash() of lcmgen.c. A
/// visitor of wire_fields.h.
class LcmFingerprint {
 public:
  /// The first 8 bytes of a message: that of a struct without members that are structs.
  uint64_t value() const { return std::rotl(hash_, 1); }

  template <class Number>
  void key(std::string_view name, const Number&) {
    member(name, lcmType<Number>(), 0);
  }
  template <class Number>
  void number(std::string_view name, const Number&) {
    member(name, lcmType<Number>(), 0);
  }
  void text(std::string_view name, const std::string&, size_t) { member(name, "string", 0); }
  template <class Number, size_t kLength>
  void items(std::string_view name, const std::array<Number, kLength>&) {
    member(name, lcmType<Number>(), 1);
    dimension(0, std::to_string(kLength));
  }
  template <class Number>
  void array(std::string_view name, const std::vector<Number>&, size_t) {
    const std::string length = std::string(name) + "_length";
    member(length, lcmType<uint32_t>(), 0);
    member(name, lcmType<Number>(), 1);
    dimension(1, length);
  }

 private:
  void member(std::string_view name, std::string_view type, int dimensions) {
    add(name), add(type), add(static_cast<char>(dimensions));
  }
  /// `mode`: 0 a constant, 1 a field.
  void dimension(char mode, std::string_view length) { add(mode), add(length); }
  void add(std::string_view text) {
    add(static_cast<char>(text.size()));
    for (const char c : text) add(c);
  }
  void add(char c) {
    const auto high = static_cast<uint64_t>(static_cast<int64_t>(hash_) >> 55);
    hash_ = ((hash_ << 8) ^ high) + static_cast<uint64_t>(c);
  }
  uint64_t hash_ = 0x12345678;
};

template <class Message>
uint64_t lcmFingerprint() {
  static const uint64_t kValue = [] {
    LcmFingerprint fingerprint;
    const Message any;
    fields(fingerprint, any, std::type_identity<Message>());
    return fingerprint.value();
  }();
  return kValue;
}

/// Encode and decode a message with its fingerprint. lcm-gen's decoder is not used, because it allocates
/// whatever length a message states. Tests verify that both agree on valid messages.
template <class Message>
void toBytes(const Message& message, std::vector<uint8_t>& bytes) {
  MessageWriter writer(bytes);
  writer.number(lcmFingerprint<Message>());
  fields(writer, message, std::type_identity<Message>());
}

/// False on another type, another version, or damage; the content of the message is unspecified then. Field
/// values are not checked.
template <class Message>
bool fromBytes(std::span<const uint8_t> bytes, Message& message) {
  MessageReader reader(bytes);
  uint64_t type = 0;
  reader.number(type);
  if (!reader.ok() || type != lcmFingerprint<Message>()) return false;
  fields(reader, message, std::type_identity<Message>());
  return reader.atEnd();
}

}  // namespace strandcast
