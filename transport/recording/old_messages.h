// Messages and records of older recordings, field by field. None of these lists may change.
#pragma once
#include <type_traits>

#include "transport/chunks.h"
#include "transport/recording/record_file.h"
#include "transport/wire_fields.h"

namespace strandcast {

/// Recordings of version 1 have GuideChunk3, of version 2 GuideChunk5, of version 3 GuideChunk6; all of them
/// GroomChunk6 and FrameRecord3. The number of a chunk is the last version of the wire that had it. What a
/// message did not have keeps its default.
struct GroomChunk6 : GroomChunk {};
struct GuideChunk3 : GuideChunk {};
struct GuideChunk5 : GuideChunk {};
struct GuideChunk6 : GuideChunk {};
struct FrameRecord3 : FrameRecord {};

template <class Visitor>
void fields(Visitor& v, auto& m, std::type_identity<GroomChunk6>) {
  using namespace wire_limits;
  v.number("session", m.session);
  v.number("groom_id", m.groom_id);
  v.number("chunk_index", m.chunk_index);
  v.number("chunk_count", m.chunk_count);
  v.number("revision", m.revision);
  v.number("total_strands", m.total_strands);
  v.number("total_vertices", m.total_vertices);
  v.number("first_strand", m.first_strand);
  v.number("first_vertex", m.first_vertex);
  v.number("hair_radius", m.hair_radius);
  v.number("arrays", m.arrays);
  v.text("name", m.name, kMaxTextBytes);
  v.array("vertex_counts", m.vertex_counts, kWords);
  v.array("positions", m.positions, kWords);
  v.array("pinned", m.pinned, kOctets);
  v.array("radii", m.radii, kWords);
  v.array("uvs", m.uvs, kWords);
  v.array("parts", m.parts, kShorts);
}

template <class Visitor>
void oldGuideFields(Visitor& v, auto& m) {
  v.number("session", m.session);
  v.number("frame", m.frame);
  v.number("publish_time", m.publish_time);
  v.number("key_frame", m.key_frame);
  v.number("simulation_time", m.simulation_time);
  v.number("groom_id", m.groom_id);
  v.number("chunk_index", m.chunk_index);
  v.number("chunk_count", m.chunk_count);
  v.number("revision", m.revision);
  v.number("first_strand", m.first_strand);
  v.number("strand_count", m.strand_count);
  v.number("first_vertex", m.first_vertex);
  v.number("vertex_count", m.vertex_count);
  v.items("head_position", m.head_position);
  v.items("head_rotation", m.head_rotation);
  v.number("encoding", m.encoding);
}

template <class Visitor>
void oldPoseFields(Visitor& v, auto& m) {
  v.array("colliders", m.colliders, kMaxPlacedColliders);
  v.array("collider_poses", m.collider_poses, 7 * kMaxPlacedColliders);
}

template <class Visitor>
void fields(Visitor& v, auto& m, std::type_identity<GuideChunk3>) {
  oldGuideFields(v, m);
  v.array("payload", m.payload, wire_limits::kOctets);
}

template <class Visitor>
void fields(Visitor& v, auto& m, std::type_identity<GuideChunk5>) {
  oldGuideFields(v, m);
  oldPoseFields(v, m);
  v.array("payload", m.payload, wire_limits::kOctets);
}

template <class Visitor>
void fields(Visitor& v, auto& m, std::type_identity<GuideChunk6>) {
  oldGuideFields(v, m);
  oldPoseFields(v, m);
  v.array("bent_colliders", m.bent_colliders, kMaxPlacedColliders);
  v.array("collider_bends", m.collider_bends, kBendNumbers * kMaxPlacedColliders);
  v.array("payload", m.payload, wire_limits::kOctets);
}

template <class Stream>
void recordFields(Stream& s, auto& m, std::type_identity<FrameRecord3>) {
  s.number(m.number);
  s.number(m.time);
  s.number(m.state_hash);
  s.number(m.chunks);
}

}  // namespace strandcast
