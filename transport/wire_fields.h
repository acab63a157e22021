// The fields of every message of the wire: names, keys and bounds, once.
#pragma once
#include <cstdint>
#include <type_traits>

#include "transport/chunks.h"
#include "transport/metrics.h"
#include "transport/parameter_table.h"
#include "transport/show.h"

namespace strandcast {

/// What a reader shows, needs and receives, told to the daemon of its groom.
struct ReaderReport {
  /// Messages that are missing here.
  enum Wants : uint32_t {
    kGroomAndBody = 1,
    kColliders = 2,
    kMaterials = 4,
    kLights = 8,
    kHairs = 16,
    kHairMesh = 32
  };
  uint64_t reader = 0;   ///< random per start of the reader, not 0
  uint64_t session = 0;  ///< of the daemon whose frames it shows; 0 = none
  uint64_t frames_received = 0, frames_lost = 0;
  uint32_t groom_id = 0, wants = 0;  ///< wants: bits of Wants
  /// Diameter of the hair's bounding sphere in its largest picture, to 1e6; 0: in none, and casts no shadow
  /// into one; -1: unknown
  float pixels = -1;
  float rate = 0;                                ///< pictures per second; 0 = unknown
  float latency_ms_p50 = 0, latency_ms_p99 = 0;  ///< from publish_time to the complete frame
};

bool isSound(const ReaderReport& report);

/// Written by each daemon that claims a shared groom: its session.
struct Claim {
  uint64_t session = 0;
  uint32_t groom_id = 0;
};

/// Of the schemas, strandcast.idl and strandcast.lcm.
inline constexpr int kWireVersion = 7;

/// The message's struct in strandcast.idl.
template <class Message>
inline constexpr const char* kWireName = nullptr;
template <>
inline constexpr const char* kWireName<GroomChunk> = "GroomChunk";
template <>
inline constexpr const char* kWireName<HairChunk> = "HairChunk";
template <>
inline constexpr const char* kWireName<BodyChunk> = "BodyChunk";
template <>
inline constexpr const char* kWireName<ColliderChunk> = "ColliderChunk";
template <>
inline constexpr const char* kWireName<GuideChunk> = "GuideChunk";
template <>
inline constexpr const char* kWireName<PoseSamples> = "PoseSamples";
template <>
inline constexpr const char* kWireName<ReaderReport> = "ReaderReport";
template <>
inline constexpr const char* kWireName<Command> = "Command";
template <>
inline constexpr const char* kWireName<Status> = "Status";
template <>
inline constexpr const char* kWireName<Claim> = "Claim";
template <>
inline constexpr const char* kWireName<ShowChunk> = "ShowChunk";

/// fields(visitor, message, std::type_identity<Message>()) passes each field to a visitor, in the order of
/// idl/strandcast.idl and lcm/strandcast.lcm, which a test compares with these lists. MessageWriter and
/// MessageReader (message_bytes.h) and LcmFingerprint (lcm/lcm_messages.h) are visitors. Members of a
/// visitor:
///
///   key(name, number)            a number, and a key of the DDS topic
///   number(name, number)
///   text(name, string, limit)    bytes; a longer text is cut, written or read
///   items(name, std::array)
///   array(name, vector, limit)   items; a reader refuses more before it allocates them, a writer is never
///                                given more
///
/// 8-byte fields come first: strandcast.idl says why.

namespace wire_limits {
inline constexpr size_t kOctets = kMaxChunkBytes, kShorts = kMaxChunkBytes / 2, kWords = kMaxChunkBytes / 4;
inline constexpr size_t kScales = 6400;  // of a message full of poses
}  // namespace wire_limits

template <class Visitor>
void chunkFields(Visitor& v, auto& m) {
  v.key("chunk_index", m.chunk_index);
  v.number("chunk_count", m.chunk_count);
  v.number("revision", m.revision);
}

template <class Visitor>
void fields(Visitor& v, auto& m, std::type_identity<GroomChunk>) {
  using namespace wire_limits;
  v.number("session", m.session);
  v.key("groom_id", m.groom_id);
  chunkFields(v, m);
  v.number("total_strands", m.total_strands);
  v.number("total_vertices", m.total_vertices);
  v.number("first_strand", m.first_strand);
  v.number("first_vertex", m.first_vertex);
  v.number("growth", m.growth);
  v.number("hair_radius", m.hair_radius);
  v.number("arrays", m.arrays);
  v.text("name", m.name, kMaxTextBytes);
  v.array("vertex_counts", m.vertex_counts, kWords);
  v.array("positions", m.positions, kWords);
  v.array("pinned", m.pinned, kOctets);
  v.array("radii", m.radii, kWords);
  v.array("uvs", m.uvs, kWords);
  v.array("parts", m.parts, kShorts);
  v.array("seeded", m.seeded, kOctets);
  v.array("ids", m.ids, kWords);
}

template <class Visitor>
void fields(Visitor& v, auto& m, std::type_identity<HairChunk>) {
  v.number("session", m.session);
  v.key("groom_id", m.groom_id);
  chunkFields(v, m);
  v.number("total_hairs", m.total_hairs);
  v.number("total_vertices", m.total_vertices);
  v.number("first_hair", m.first_hair);
  v.number("first_vertex", m.first_vertex);
  v.number("hair_count", m.hair_count);
  v.number("vertex_count", m.vertex_count);
  v.number("arrays", m.arrays);
  v.number("encoding", m.encoding);
  v.number("step", m.step);
  v.number("radius_step", m.radius_step);
  v.items("uv_box", m.uv_box);
  v.array("payload", m.payload, wire_limits::kOctets);
}

template <class Visitor>
void fields(Visitor& v, auto& m, std::type_identity<BodyChunk>) {
  using namespace wire_limits;
  v.number("session", m.session);
  v.key("groom_id", m.groom_id);
  chunkFields(v, m);
  v.number("total_positions", m.total_positions);
  v.number("total_triangles", m.total_triangles);
  v.number("first_position", m.first_position);
  v.number("first_triangle", m.first_triangle);
  v.number("arrays", m.arrays);
  v.text("name", m.name, kMaxTextBytes);
  v.array("positions", m.positions, kWords);
  v.array("normals", m.normals, kWords);
  v.array("head_weights", m.head_weights, kWords);
  v.array("triangles", m.triangles, kWords);
}

template <class Visitor>
void fields(Visitor& v, auto& m, std::type_identity<ColliderChunk>) {
  using namespace wire_limits;
  v.number("session", m.session);
  v.key("groom_id", m.groom_id);
  chunkFields(v, m);
  v.number("total_shapes", m.total_shapes);
  v.number("total_words", m.total_words);
  v.number("first_shape", m.first_shape);
  v.number("first_word", m.first_word);
  v.array("colliders", m.colliders, kWords);
  v.array("word_counts", m.word_counts, kWords);
  v.array("numbers", m.numbers, kWords);
  v.array("kinds", m.kinds, kWords);
  v.array("follows_head", m.follows_head, kWords);
  v.array("words", m.words, kWords);
}

template <class Visitor>
void fields(Visitor& v, auto& m, std::type_identity<GuideChunk>) {
  v.number("session", m.session);
  v.number("frame", m.frame);
  v.number("publish_time", m.publish_time);
  v.number("key_frame", m.key_frame);
  v.number("pose_source", m.pose_source);
  v.number("pose_time", m.pose_time);
  v.number("simulation_time", m.simulation_time);
  v.key("groom_id", m.groom_id);
  chunkFields(v, m);
  v.number("first_strand", m.first_strand);
  v.number("strand_count", m.strand_count);
  v.number("first_vertex", m.first_vertex);
  v.number("vertex_count", m.vertex_count);
  v.number("writer", m.writer);
  v.number("writers", m.writers);
  v.number("continuity", m.continuity);
  v.items("head_position", m.head_position);
  v.items("head_rotation", m.head_rotation);
  v.number("encoding", m.encoding);
  v.array("colliders", m.colliders, kMaxPlacedColliders);
  v.array("collider_poses", m.collider_poses, 7 * kMaxPlacedColliders);
  v.array("bent_colliders", m.bent_colliders, kMaxPlacedColliders);
  v.array("collider_bends", m.collider_bends, kBendNumbers * kMaxPlacedColliders);
  v.array("payload", m.payload, wire_limits::kOctets);
}

template <class Visitor>
void fields(Visitor& v, auto& m, std::type_identity<PoseSamples>) {
  v.key("source", m.source);
  v.number("time", m.time);
  v.number("sent_time", m.sent_time);
  v.key("groom_id", m.groom_id);
  v.number("newest", m.newest);
  v.number("epoch", m.epoch);
  v.number("names_revision", m.names_revision);
  v.text("names", m.names, kMaxPoseNameBytes + 1);  // not cut to another name: isSound() refuses longer ones
  v.text("weight_names", m.weight_names, kMaxWeightNameBytes + 1);
  v.array("ages", m.ages, kMaxPoseSamples);
  v.array("poses", m.poses, wire_limits::kWords);
  v.array("scales", m.scales, wire_limits::kScales);
  v.array("weights", m.weights, kMaxPoseSamples * kMaxWeightNames);
}

template <class Visitor>
void fields(Visitor& v, auto& m, std::type_identity<Command>) {
  v.number("id", m.id);
  v.key("groom_id", m.groom_id);
  v.number("kind", m.kind);
  v.text("name", m.name, kMaxTextBytes + 1);  // a longer one is not cut to another name: isSound() refuses it
  v.array("values", m.values, kMaxCommandValues);
}

template <class Visitor>
void fields(Visitor& v, auto& m, std::type_identity<ReaderReport>) {
  v.key("reader", m.reader);
  v.number("session", m.session);
  v.number("frames_received", m.frames_received);
  v.number("frames_lost", m.frames_lost);
  v.key("groom_id", m.groom_id);
  v.number("wants", m.wants);
  v.number("pixels", m.pixels);
  v.number("rate", m.rate);
  v.number("latency_ms_p50", m.latency_ms_p50);
  v.number("latency_ms_p99", m.latency_ms_p99);
}

template <class Visitor>
void fields(Visitor& v, auto& m, std::type_identity<Status>) {
  v.key("session", m.session);
  v.number("strands", m.strands);
  v.number("vertices", m.vertices);
  v.number("frames", m.frames);
  v.number("non_finite", m.non_finite);
  v.number("strands_reset", m.strands_reset);
  v.number("last_command", m.last_command);
  v.number("frame_bytes", m.encoding.frame_bytes);
  v.number("strands_sent_finer", m.encoding.strands_sent_finer);
  v.number("simulation_time", m.simulation_time);
  v.number("step_ms_median", m.step_ms_median);
  v.number("step_ms_p95", m.step_ms_p95);
  v.number("mean_stretch", m.mean_stretch);
  v.number("max_stretch", m.max_stretch);
  v.number("max_penetration", m.max_penetration);
  v.number("codec_max_error", m.encoding.max_error);
  v.number("codec_worst_error", m.encoding.worst_error);
  v.key("groom_id", m.groom_id);
  v.number("readers", m.readers);
  v.number("writers", m.writers);
  v.text("groom_name", m.groom_name, kMaxTextBytes);
  v.text("backend", m.backend, kMaxTextBytes);
  v.text("device", m.device, kMaxTextBytes);
  v.text("codec", m.encoding.codec, kMaxTextBytes);
  v.text("last_command_error", m.last_command_error, kMaxTextBytes);
  v.text("parameter_names", m.parameters.names, kMaxTableNameBytes);
  v.text("metric_names", m.metrics.names, kMaxMetricNameBytes);
  v.array("parameter_components", m.parameters.components, kMaxTableEntries);
  v.array("parameter_values", m.parameters.values, kMaxTableValues);
  v.array("metric_values", m.metrics.values, kMaxMetrics);
}

template <class Visitor>
void fields(Visitor& v, auto& m, std::type_identity<Claim>) {
  v.number("session", m.session);
  v.key("groom_id", m.groom_id);
}

template <class Visitor>
void fields(Visitor& v, auto& m, std::type_identity<ShowChunk>) {
  v.number("session", m.session);
  v.key("groom_id", m.groom_id);
  v.key("part", m.part);
  chunkFields(v, m);
  v.array("payload", m.payload, wire_limits::kOctets);
}

}  // namespace strandcast
