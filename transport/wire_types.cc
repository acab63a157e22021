#include "transport/wire_types.h"

#include <type_traits>
#include <utility>

namespace strandcast {
namespace {

/// Copy a field of a message, `own`, to or from that of its generated type, `wire`.
struct ToWire {
  template <class Own, class Wire>
  static void value(const Own& own, Wire& wire) {
    wire = static_cast<Wire>(own);
  }
  static void text(const std::string& own, std::string& wire) { wire = shortened(own); }
  template <class Item>
  static void array(std::vector<Item>& own, std::vector<Item>& wire) {
    std::swap(own, wire);
  }
  template <class Item>
  static void array(const std::vector<Item>& own, std::vector<Item>& wire) {
    wire = own;
  }
};
struct FromWire {
  template <class Own, class Wire>
  static void value(Own& own, const Wire& wire) {
    own = static_cast<Own>(wire);
  }
  static void text(std::string& own, const std::string& wire) { own = shortened(wire); }
  template <class Item>
  static void array(std::vector<Item>& own, std::vector<Item>& wire) {
    std::swap(own, wire);
  }
  template <class Item>
  static void array(std::vector<Item>& own, const std::vector<Item>& wire) {
    own = wire;
  }
};

// Each message once, for both directions.

void chunkFields(auto copy, auto& own, auto& wire) {
  copy.value(own.session, wire.session());
  copy.value(own.groom_id, wire.groom_id());
  copy.value(own.chunk_index, wire.chunk_index());
  copy.value(own.chunk_count, wire.chunk_count());
  copy.value(own.revision, wire.revision());
}

void groomFields(auto copy, auto& own, auto& wire) {
  chunkFields(copy, own, wire);
  copy.value(own.total_strands, wire.total_strands());
  copy.value(own.total_vertices, wire.total_vertices());
  copy.value(own.first_strand, wire.first_strand());
  copy.value(own.first_vertex, wire.first_vertex());
  copy.value(own.hair_radius, wire.hair_radius());
  copy.value(own.arrays, wire.arrays());
  copy.text(own.name, wire.name());
  copy.array(own.vertex_counts, wire.vertex_counts());
  copy.array(own.positions, wire.positions());
  copy.array(own.pinned, wire.pinned());
  copy.array(own.radii, wire.radii());
  copy.array(own.uvs, wire.uvs());
  copy.array(own.parts, wire.parts());
}

void bodyFields(auto copy, auto& own, auto& wire) {
  chunkFields(copy, own, wire);
  copy.value(own.total_positions, wire.total_positions());
  copy.value(own.total_triangles, wire.total_triangles());
  copy.value(own.first_position, wire.first_position());
  copy.value(own.first_triangle, wire.first_triangle());
  copy.value(own.arrays, wire.arrays());
  copy.text(own.name, wire.name());
  copy.array(own.positions, wire.positions());
  copy.array(own.normals, wire.normals());
  copy.array(own.head_weights, wire.head_weights());
  copy.array(own.triangles, wire.triangles());
}

void colliderFields(auto copy, auto& own, auto& wire) {
  chunkFields(copy, own, wire);
  copy.value(own.total_shapes, wire.total_shapes());
  copy.value(own.total_words, wire.total_words());
  copy.value(own.first_shape, wire.first_shape());
  copy.value(own.first_word, wire.first_word());
  copy.array(own.colliders, wire.colliders());
  copy.array(own.word_counts, wire.word_counts());
  copy.array(own.numbers, wire.numbers());
  copy.array(own.kinds, wire.kinds());
  copy.array(own.follows_head, wire.follows_head());
  copy.array(own.words, wire.words());
}

void guideFields(auto copy, auto& own, auto& wire) {
  chunkFields(copy, own, wire);
  copy.value(own.frame, wire.frame());
  copy.value(own.publish_time, wire.publish_time());
  copy.value(own.simulation_time, wire.simulation_time());
  copy.value(own.first_strand, wire.first_strand());
  copy.value(own.strand_count, wire.strand_count());
  copy.value(own.first_vertex, wire.first_vertex());
  copy.value(own.vertex_count, wire.vertex_count());
  copy.value(own.head_position, wire.head_position());
  copy.value(own.head_rotation, wire.head_rotation());
  copy.value(own.key_frame, wire.key_frame());
  copy.value(own.encoding, wire.encoding());
  copy.array(own.colliders, wire.colliders());
  copy.array(own.collider_poses, wire.collider_poses());
  copy.array(own.bent_colliders, wire.bent_colliders());
  copy.array(own.collider_bends, wire.collider_bends());
  copy.array(own.payload, wire.payload());
}

void commandFields(auto copy, auto& own, auto& wire) {
  copy.value(own.id, wire.id());
  copy.value(own.groom_id, wire.groom_id());
  copy.text(own.name, wire.name());
  copy.value(own.kind, wire.kind());
  copy.array(own.values, wire.values());
}

void showFields(auto copy, auto& own, auto& wire) {
  copy.value(own.session, wire.session());
  copy.value(own.groom_id, wire.groom_id());
  copy.value(own.part, wire.part());
  copy.value(own.chunk_index, wire.chunk_index());
  copy.value(own.chunk_count, wire.chunk_count());
  copy.value(own.revision, wire.revision());
  copy.array(own.payload, wire.payload());
}

void statusFields(auto copy, auto& own, auto& wire) {
  copy.value(own.session, wire.session());
  copy.value(own.strands, wire.strands());
  copy.value(own.vertices, wire.vertices());
  copy.value(own.frames, wire.frames());
  copy.value(own.non_finite, wire.non_finite());
  copy.value(own.strands_reset, wire.strands_reset());
  copy.value(own.last_command, wire.last_command());
  copy.value(own.simulation_time, wire.simulation_time());
  copy.value(own.step_ms_median, wire.step_ms_median());
  copy.value(own.step_ms_p95, wire.step_ms_p95());
  copy.value(own.mean_stretch, wire.mean_stretch());
  copy.value(own.max_stretch, wire.max_stretch());
  copy.value(own.max_penetration, wire.max_penetration());
  copy.value(own.groom_id, wire.groom_id());
  copy.value(own.readers, wire.readers());
  copy.text(own.encoding.codec, wire.codec());
  copy.value(own.encoding.max_error, wire.codec_max_error());
  copy.value(own.encoding.worst_error, wire.codec_worst_error());
  copy.value(own.encoding.frame_bytes, wire.frame_bytes());
  copy.value(own.encoding.strands_sent_finer, wire.strands_sent_finer());
  copy.text(own.groom_name, wire.groom_name());
  copy.text(own.backend, wire.backend());
  copy.text(own.device, wire.device());
  copy.text(own.last_command_error, wire.last_command_error());
  copy.value(own.parameters.names, wire.parameter_names());  // may exceed kMaxTextBytes
  copy.array(own.parameters.components, wire.parameter_components());
  copy.array(own.parameters.values, wire.parameter_values());
}

}  // namespace

void toWire(GroomChunk& chunk, v6::GroomChunk& wire) { groomFields(ToWire(), chunk, wire); }
void fromWire(v6::GroomChunk& wire, GroomChunk& chunk) { groomFields(FromWire(), chunk, wire); }
void toWire(BodyChunk& chunk, v6::BodyChunk& wire) { bodyFields(ToWire(), chunk, wire); }
void fromWire(v6::BodyChunk& wire, BodyChunk& chunk) { bodyFields(FromWire(), chunk, wire); }
void toWire(ColliderChunk& chunk, v6::ColliderChunk& wire) { colliderFields(ToWire(), chunk, wire); }
void fromWire(v6::ColliderChunk& wire, ColliderChunk& chunk) { colliderFields(FromWire(), chunk, wire); }
void toWire(GuideChunk& chunk, v6::GuideChunk& wire) { guideFields(ToWire(), chunk, wire); }
void fromWire(v6::GuideChunk& wire, GuideChunk& chunk) { guideFields(FromWire(), chunk, wire); }
void toWire(const Command& command, v6::Command& wire) { commandFields(ToWire(), command, wire); }
void fromWire(const v6::Command& wire, Command& command) { commandFields(FromWire(), command, wire); }
void toWire(ShowChunk& chunk, v6::ShowChunk& wire) { showFields(ToWire(), chunk, wire); }
void fromWire(v6::ShowChunk& wire, ShowChunk& chunk) { showFields(FromWire(), chunk, wire); }
void toWire(const Status& status, v6::Status& wire) { statusFields(ToWire(), status, wire); }
void fromWire(const v6::Status& wire, Status& status) { statusFields(FromWire(), status, wire); }

}  // namespace strandcast
