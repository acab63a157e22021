#pragma once
#include <array>
#include <concepts>
#include <cstdint>
#include <fstream>
#include <span>
#include <string>
#include <vector>

#include "transport/wire_fields.h"

namespace strandcast {

/// Sets fields to values whose bytes all differ from those of the fields before.
class DistinctValues {
 public:
  template <class... Fields>
  void operator()(Fields&... fields) {
    (set(fields), ...);
  }

 private:
  void set(std::string& field) { field = "text " + std::to_string(next_++); }
  template <class Item>
  void set(std::vector<Item>& field) {
    field.resize(3);
    for (Item& item : field) set(item);
  }
  template <class Item, size_t kLength>
  void set(std::array<Item, kLength>& field) {
    for (Item& item : field) set(item);
  }
  template <std::floating_point Number>
  void set(Number& field) {
    field = static_cast<Number>(next_++) + Number(0.1);
  }
  template <std::integral Number>
  void set(Number& field) {
    uint64_t value = 0;
    for (size_t byte = 0; byte < sizeof field; ++byte) value = value << 8 | (next_++ & 0xff);
    field = static_cast<Number>(value);
  }
  uint32_t next_ = 1;
};

inline void setDistinct(GroomChunk& m) {
  DistinctValues()(m.session, m.groom_id, m.chunk_index, m.chunk_count, m.revision, m.total_strands,
                   m.total_vertices, m.first_strand, m.first_vertex, m.growth, m.hair_radius, m.arrays,
                   m.name, m.vertex_counts, m.positions, m.pinned, m.radii, m.uvs, m.parts, m.seeded, m.ids);
}
inline void setDistinct(HairChunk& m) {
  DistinctValues()(m.session, m.groom_id, m.chunk_index, m.chunk_count, m.revision, m.total_hairs,
                   m.total_vertices, m.first_hair, m.first_vertex, m.hair_count, m.vertex_count, m.arrays,
                   m.encoding, m.step, m.radius_step, m.uv_box, m.payload);
}
inline void setDistinct(BodyChunk& m) {
  DistinctValues()(m.session, m.groom_id, m.chunk_index, m.chunk_count, m.revision, m.total_positions,
                   m.total_triangles, m.first_position, m.first_triangle, m.arrays, m.name, m.positions,
                   m.normals, m.head_weights, m.triangles);
}
inline void setDistinct(ColliderChunk& m) {
  DistinctValues()(m.session, m.groom_id, m.chunk_index, m.chunk_count, m.revision, m.total_shapes,
                   m.total_words, m.first_shape, m.first_word, m.colliders, m.word_counts, m.numbers, m.kinds,
                   m.follows_head, m.words);
}
inline void setDistinct(GuideChunk& m) {
  DistinctValues()(m.session, m.frame, m.publish_time, m.key_frame, m.pose_source, m.pose_time,
                   m.simulation_time, m.groom_id, m.chunk_index, m.chunk_count, m.revision, m.first_strand,
                   m.strand_count, m.first_vertex, m.vertex_count, m.writer, m.writers, m.continuity,
                   m.head_position, m.head_rotation, m.colliders, m.collider_poses, m.bent_colliders,
                   m.collider_bends, m.payload);
  m.encoding = Encoding::kTangent;
}
inline void setDistinct(Command& m) {
  DistinctValues()(m.id, m.groom_id, m.name, m.values);
  m.kind = CommandKind::kAddColliderFile;
}
inline void setDistinct(ReaderReport& m) {
  DistinctValues()(m.reader, m.session, m.frames_received, m.frames_lost, m.groom_id, m.wants, m.pixels,
                   m.rate, m.latency_ms_p50, m.latency_ms_p99);
}
inline void setDistinct(Claim& m) { DistinctValues()(m.session, m.groom_id); }
inline void setDistinct(ShowChunk& m) {
  DistinctValues()(m.session, m.groom_id, m.part, m.chunk_index, m.chunk_count, m.revision, m.payload);
}
inline void setDistinct(Status& m) {
  DistinctValues()(m.session, m.strands, m.vertices, m.frames, m.non_finite, m.strands_reset, m.last_command,
                   m.encoding.frame_bytes, m.encoding.strands_sent_finer, m.simulation_time, m.step_ms_median,
                   m.step_ms_p95, m.mean_stretch, m.max_stretch, m.max_penetration, m.encoding.max_error,
                   m.encoding.worst_error, m.groom_id, m.readers, m.writers, m.groom_name, m.backend,
                   m.device, m.encoding.codec, m.last_command_error, m.parameters.names, m.metrics.names,
                   m.parameters.components, m.parameters.values, m.metrics.values);
}

/// A message with every field set.
template <class Message>
Message fullMessage() {
  Message message;
  setDistinct(message);
  return message;
}

/// A line of data/wire7.txt: the bytes, in hexadecimal, that version 7 of the wire gives to a message of
/// `type`. `form`: "cdr" (with its encapsulation), "key" (the 16 bytes of a DDS instance), "lcm", each
/// followed by " empty" for a message that was never set.
inline std::string goldenBytes(const std::string& type, const std::string& form) {
  std::ifstream file(STRANDCAST_SOURCE_DIR "/tests/transport/data/wire7.txt");
  for (std::string line; std::getline(file, line);) {
    const std::string name = type + ' ' + form + ": ";
    if (line.starts_with(name)) return line.substr(name.size());
  }
  return "no line";
}

inline std::string hexadecimal(std::span<const uint8_t> bytes) {
  constexpr char kDigits[] = "0123456789abcdef";
  std::string text;
  for (const uint8_t byte : bytes) (text += kDigits[byte >> 4]) += kDigits[byte & 15];
  return text;
}

}  // namespace strandcast
