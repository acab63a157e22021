// Messages as bytes in LCM's encoding: writer, reader, and the fields of each message. LCM messages and
// recordings are made of them.
#pragma once
#include <bit>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "transport/chunks.h"

namespace strandcast {

/// LCM's encoding of numbers, texts and arrays: big-endian; a text's length includes a final zero byte.
/// Writer and reader have the same members, so that one function describes a message (messageFields()).
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
  void flag(bool value) { number(uint32_t{value}); }
  void text(const std::string& value) {
    number(static_cast<uint32_t>(value.size() + 1));
    std::memcpy(grow(value.size() + 1), value.c_str(), value.size() + 1);
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

 private:
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
  void flag(bool& value) {
    uint32_t number = 0;
    this->number(number);
    value = number != 0;
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
  void array(std::vector<Number>& values) {
    values.resize(length(sizeof(Number)));
    items(values);
  }

 private:
  /// Length of an array; 0 when it exceeds the bytes that are left.
  size_t length(size_t item_bytes) {
    uint32_t count = 0;
    number(count);
    if (count <= bytes_.size() / item_bytes) return count;
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

/// The fields of each message, once for MessageWriter and MessageReader, in the order of lcm/strandcast.lcm.
/// LCM messages and recordings are made of them.

template <class Stream, class Message>
void chunkFields(Stream& s, Message& m) {
  s.number(m.session);
  s.number(m.groom_id);
  s.number(m.chunk_index);
  s.number(m.chunk_count);
  s.number(m.revision);
}

template <class Stream>
void messageFields(Stream& s, auto& m, std::type_identity<GroomChunk>) {
  chunkFields(s, m);
  s.number(m.total_strands);
  s.number(m.total_vertices);
  s.number(m.first_strand);
  s.number(m.first_vertex);
  s.number(m.hair_radius);
  s.number(m.arrays);
  s.text(m.name);
  s.array(m.vertex_counts);
  s.array(m.positions);
  s.array(m.pinned);
  s.array(m.radii);
  s.array(m.uvs);
  s.array(m.parts);
}

template <class Stream>
void messageFields(Stream& s, auto& m, std::type_identity<BodyChunk>) {
  chunkFields(s, m);
  s.number(m.total_positions);
  s.number(m.total_triangles);
  s.number(m.first_position);
  s.number(m.first_triangle);
  s.number(m.arrays);
  s.text(m.name);
  s.array(m.positions);
  s.array(m.normals);
  s.array(m.head_weights);
  s.array(m.triangles);
}

template <class Stream>
void messageFields(Stream& s, auto& m, std::type_identity<ColliderChunk>) {
  chunkFields(s, m);
  s.number(m.total_shapes);
  s.number(m.total_words);
  s.number(m.first_shape);
  s.number(m.first_word);
  s.array(m.colliders);
  s.array(m.word_counts);
  s.array(m.numbers);
  s.array(m.kinds);
  s.array(m.follows_head);
  s.array(m.words);
}

/// Guide chunks of wire versions 3 and 5, which recordings of versions 1 and 2 contain.
struct GuideChunk3 : GuideChunk {};
struct GuideChunk5 : GuideChunk {};

template <class Stream>
void guideFields(Stream& s, auto& m) {
  s.number(m.session);
  s.number(m.frame);
  s.number(m.publish_time);
  s.number(m.key_frame);
  s.number(m.simulation_time);
  s.number(m.groom_id);
  s.number(m.chunk_index);
  s.number(m.chunk_count);
  s.number(m.revision);
  s.number(m.first_strand);
  s.number(m.strand_count);
  s.number(m.first_vertex);
  s.number(m.vertex_count);
  s.items(m.head_position);
  s.items(m.head_rotation);
  s.number(m.encoding);
}

template <class Stream>
void messageFields(Stream& s, auto& m, std::type_identity<GuideChunk>) {
  guideFields(s, m);
  s.array(m.colliders);
  s.array(m.collider_poses);
  s.array(m.bent_colliders);
  s.array(m.collider_bends);
  s.array(m.payload);
}

template <class Stream>
void messageFields(Stream& s, auto& m, std::type_identity<GuideChunk5>) {
  guideFields(s, m);
  s.array(m.colliders);
  s.array(m.collider_poses);
  s.array(m.payload);
}

template <class Stream>
void messageFields(Stream& s, auto& m, std::type_identity<GuideChunk3>) {
  guideFields(s, m);
  s.array(m.payload);
}

template <class Stream>
void messageFields(Stream& s, auto& m, std::type_identity<Command>) {
  s.number(m.id);
  s.number(m.groom_id);
  s.number(m.kind);
  s.text(m.name);
  s.array(m.values);
}

template <class Stream>
void messageFields(Stream& s, auto& m, std::type_identity<Status>) {
  s.number(m.session);
  s.number(m.strands);
  s.number(m.vertices);
  s.number(m.frames);
  s.number(m.non_finite);
  s.number(m.strands_reset);
  s.number(m.last_command);
  s.number(m.encoding.frame_bytes);
  s.number(m.encoding.strands_sent_finer);
  s.number(m.simulation_time);
  s.number(m.step_ms_median);
  s.number(m.step_ms_p95);
  s.number(m.mean_stretch);
  s.number(m.max_stretch);
  s.number(m.max_penetration);
  s.number(m.encoding.max_error);
  s.number(m.encoding.worst_error);
  s.number(m.groom_id);
  s.number(m.readers);
  s.text(m.groom_name);
  s.text(m.backend);
  s.text(m.device);
  s.text(m.encoding.codec);
  s.text(m.last_command_error);
  s.text(m.parameters.names);
  s.array(m.parameters.components);
  s.array(m.parameters.values);
}

}  // namespace strandcast
