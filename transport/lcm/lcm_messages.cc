#include "transport/lcm/lcm_messages.h"

#include <type_traits>

#include "strandcast_v2/body_chunk_t.hpp"
#include "strandcast_v2/command_t.hpp"
#include "strandcast_v2/groom_chunk_t.hpp"
#include "strandcast_v2/guide_chunk_t.hpp"
#include "strandcast_v2/reader_t.hpp"
#include "strandcast_v2/status_t.hpp"
#include "transport/lcm/message_bytes.h"

namespace strandcast {
namespace {

// Each message once, for reader and writer: the order of strandcast.lcm.

template <class Stream, class Message>
void common(Stream& s, Message& m) {
  s.number(m.session);
  s.number(m.groom_id);
  s.number(m.chunk_index);
  s.number(m.chunk_count);
  s.number(m.revision);
}

template <class Stream>
void fields(Stream& s, auto& m, std::type_identity<GroomChunk>) {
  common(s, m);
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
void fields(Stream& s, auto& m, std::type_identity<BodyChunk>) {
  common(s, m);
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
void fields(Stream& s, auto& m, std::type_identity<GuideChunk>) {
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
  s.array(m.payload);
}

template <class Stream>
void fields(Stream& s, auto& m, std::type_identity<Command>) {
  s.number(m.id);
  s.number(m.groom_id);
  s.number(m.kind);
  s.text(m.name);
  s.array(m.values);
}

template <class Stream>
void fields(Stream& s, auto& m, std::type_identity<Status>) {
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
}

/// lcm-gen computes it from the schema.
template <class Generated>
int64_t fingerprint() {
  return Generated::getHash();
}

template <class Generated, class Message>
void write(const Message& message, std::vector<uint8_t>& bytes) {
  MessageWriter writer(bytes);
  writer.number(fingerprint<Generated>());
  fields(writer, message, std::type_identity<Message>());
}

template <class Generated, class Message>
bool read(std::span<const uint8_t> bytes, Message& message) {
  MessageReader reader(bytes);
  int64_t type = 0;
  reader.number(type);
  if (!reader.ok() || type != fingerprint<Generated>()) return false;
  fields(reader, message, std::type_identity<Message>());
  return reader.atEnd();
}

void shortenTexts(Status& s) {
  for (std::string* text : {&s.groom_name, &s.backend, &s.device, &s.encoding.codec, &s.last_command_error})
    *text = shortened(*text);
}

}  // namespace

void toBytes(const GroomChunk& chunk, std::vector<uint8_t>& bytes) {
  write<strandcast_v2::groom_chunk_t>(chunk, bytes);
}
void toBytes(const BodyChunk& chunk, std::vector<uint8_t>& bytes) {
  write<strandcast_v2::body_chunk_t>(chunk, bytes);
}
void toBytes(const GuideChunk& chunk, std::vector<uint8_t>& bytes) {
  write<strandcast_v2::guide_chunk_t>(chunk, bytes);
}
void toBytes(const Command& command, std::vector<uint8_t>& bytes) {
  write<strandcast_v2::command_t>(command, bytes);
}
void toBytes(const ReaderSign& sign, std::vector<uint8_t>& bytes) {
  MessageWriter writer(bytes);
  writer.number(fingerprint<strandcast_v2::reader_t>());
  writer.number(sign.reader);
  writer.number(sign.groom_id);
  writer.number(uint32_t{sign.wants_groom});
}
void toBytes(const Status& status, std::vector<uint8_t>& bytes) {
  Status own = status;
  shortenTexts(own);
  write<strandcast_v2::status_t>(own, bytes);
}

bool fromBytes(std::span<const uint8_t> bytes, GroomChunk& chunk) {
  return read<strandcast_v2::groom_chunk_t>(bytes, chunk);
}
bool fromBytes(std::span<const uint8_t> bytes, BodyChunk& chunk) {
  return read<strandcast_v2::body_chunk_t>(bytes, chunk);
}
bool fromBytes(std::span<const uint8_t> bytes, GuideChunk& chunk) {
  return read<strandcast_v2::guide_chunk_t>(bytes, chunk);
}
bool fromBytes(std::span<const uint8_t> bytes, Command& command) {
  return read<strandcast_v2::command_t>(bytes, command);
}
bool fromBytes(std::span<const uint8_t> bytes, ReaderSign& sign) {
  MessageReader reader(bytes);
  int64_t type = 0;
  uint32_t wants = 0;
  reader.number(type);
  reader.number(sign.reader);
  reader.number(sign.groom_id);
  reader.number(wants);
  sign.wants_groom = wants != 0;
  return reader.atEnd() && type == fingerprint<strandcast_v2::reader_t>();
}
bool fromBytes(std::span<const uint8_t> bytes, Status& status) {
  if (!read<strandcast_v2::status_t>(bytes, status)) return false;
  shortenTexts(status);
  return true;
}

}  // namespace strandcast
