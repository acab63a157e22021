#include "transport/wire_types.h"

#include <utility>

namespace strandcast {
void toWire(GroomChunk& chunk, v4::GroomChunk& wire) {
  wire.session(chunk.session);
  wire.groom_id(chunk.groom_id);
  wire.chunk_index(chunk.chunk_index);
  wire.chunk_count(chunk.chunk_count);
  wire.revision(chunk.revision);
  wire.total_strands(chunk.total_strands);
  wire.total_vertices(chunk.total_vertices);
  wire.first_strand(chunk.first_strand);
  wire.first_vertex(chunk.first_vertex);
  wire.hair_radius(chunk.hair_radius);
  wire.arrays(chunk.arrays);
  wire.name(shortened(chunk.name));
  std::swap(wire.vertex_counts(), chunk.vertex_counts);
  std::swap(wire.positions(), chunk.positions);
  std::swap(wire.pinned(), chunk.pinned);
  std::swap(wire.radii(), chunk.radii);
  std::swap(wire.uvs(), chunk.uvs);
  std::swap(wire.parts(), chunk.parts);
}

void fromWire(v4::GroomChunk& wire, GroomChunk& chunk) {
  chunk.session = wire.session();
  chunk.groom_id = wire.groom_id();
  chunk.chunk_index = wire.chunk_index();
  chunk.chunk_count = wire.chunk_count();
  chunk.revision = wire.revision();
  chunk.total_strands = wire.total_strands();
  chunk.total_vertices = wire.total_vertices();
  chunk.first_strand = wire.first_strand();
  chunk.first_vertex = wire.first_vertex();
  chunk.hair_radius = wire.hair_radius();
  chunk.arrays = wire.arrays();
  chunk.name = shortened(wire.name());
  std::swap(wire.vertex_counts(), chunk.vertex_counts);
  std::swap(wire.positions(), chunk.positions);
  std::swap(wire.pinned(), chunk.pinned);
  std::swap(wire.radii(), chunk.radii);
  std::swap(wire.uvs(), chunk.uvs);
  std::swap(wire.parts(), chunk.parts);
}

void toWire(BodyChunk& chunk, v4::BodyChunk& wire) {
  wire.session(chunk.session);
  wire.groom_id(chunk.groom_id);
  wire.chunk_index(chunk.chunk_index);
  wire.chunk_count(chunk.chunk_count);
  wire.revision(chunk.revision);
  wire.total_positions(chunk.total_positions);
  wire.total_triangles(chunk.total_triangles);
  wire.first_position(chunk.first_position);
  wire.first_triangle(chunk.first_triangle);
  wire.arrays(chunk.arrays);
  wire.name(shortened(chunk.name));
  std::swap(wire.positions(), chunk.positions);
  std::swap(wire.normals(), chunk.normals);
  std::swap(wire.head_weights(), chunk.head_weights);
  std::swap(wire.triangles(), chunk.triangles);
}

void fromWire(v4::BodyChunk& wire, BodyChunk& chunk) {
  chunk.session = wire.session();
  chunk.groom_id = wire.groom_id();
  chunk.chunk_index = wire.chunk_index();
  chunk.chunk_count = wire.chunk_count();
  chunk.revision = wire.revision();
  chunk.total_positions = wire.total_positions();
  chunk.total_triangles = wire.total_triangles();
  chunk.first_position = wire.first_position();
  chunk.first_triangle = wire.first_triangle();
  chunk.arrays = wire.arrays();
  chunk.name = shortened(wire.name());
  std::swap(wire.positions(), chunk.positions);
  std::swap(wire.normals(), chunk.normals);
  std::swap(wire.head_weights(), chunk.head_weights);
  std::swap(wire.triangles(), chunk.triangles);
}

void toWire(ColliderChunk& chunk, v4::ColliderChunk& wire) {
  wire.session(chunk.session);
  wire.groom_id(chunk.groom_id);
  wire.chunk_index(chunk.chunk_index);
  wire.chunk_count(chunk.chunk_count);
  wire.revision(chunk.revision);
  wire.total_shapes(chunk.total_shapes);
  wire.total_words(chunk.total_words);
  wire.first_shape(chunk.first_shape);
  wire.first_word(chunk.first_word);
  std::swap(wire.colliders(), chunk.colliders);
  std::swap(wire.word_counts(), chunk.word_counts);
  std::swap(wire.numbers(), chunk.numbers);
  std::swap(wire.kinds(), chunk.kinds);
  std::swap(wire.follows_head(), chunk.follows_head);
  std::swap(wire.words(), chunk.words);
}

void fromWire(v4::ColliderChunk& wire, ColliderChunk& chunk) {
  chunk.session = wire.session();
  chunk.groom_id = wire.groom_id();
  chunk.chunk_index = wire.chunk_index();
  chunk.chunk_count = wire.chunk_count();
  chunk.revision = wire.revision();
  chunk.total_shapes = wire.total_shapes();
  chunk.total_words = wire.total_words();
  chunk.first_shape = wire.first_shape();
  chunk.first_word = wire.first_word();
  std::swap(wire.colliders(), chunk.colliders);
  std::swap(wire.word_counts(), chunk.word_counts);
  std::swap(wire.numbers(), chunk.numbers);
  std::swap(wire.kinds(), chunk.kinds);
  std::swap(wire.follows_head(), chunk.follows_head);
  std::swap(wire.words(), chunk.words);
}

void toWire(GuideChunk& chunk, v4::GuideChunk& wire) {
  wire.session(chunk.session);
  wire.frame(chunk.frame);
  wire.publish_time(chunk.publish_time);
  wire.simulation_time(chunk.simulation_time);
  wire.groom_id(chunk.groom_id);
  wire.chunk_index(chunk.chunk_index);
  wire.chunk_count(chunk.chunk_count);
  wire.revision(chunk.revision);
  wire.first_strand(chunk.first_strand);
  wire.strand_count(chunk.strand_count);
  wire.first_vertex(chunk.first_vertex);
  wire.vertex_count(chunk.vertex_count);
  wire.head_position(chunk.head_position);
  wire.head_rotation(chunk.head_rotation);
  wire.key_frame(chunk.key_frame);
  wire.encoding(static_cast<v4::Encoding>(chunk.encoding));
  std::swap(wire.colliders(), chunk.colliders);
  std::swap(wire.collider_poses(), chunk.collider_poses);
  std::swap(wire.payload(), chunk.payload);
}

void fromWire(v4::GuideChunk& wire, GuideChunk& chunk) {
  chunk.session = wire.session();
  chunk.frame = wire.frame();
  chunk.publish_time = wire.publish_time();
  chunk.simulation_time = wire.simulation_time();
  chunk.groom_id = wire.groom_id();
  chunk.chunk_index = wire.chunk_index();
  chunk.chunk_count = wire.chunk_count();
  chunk.revision = wire.revision();
  chunk.first_strand = wire.first_strand();
  chunk.strand_count = wire.strand_count();
  chunk.first_vertex = wire.first_vertex();
  chunk.vertex_count = wire.vertex_count();
  chunk.head_position = wire.head_position();
  chunk.head_rotation = wire.head_rotation();
  chunk.key_frame = wire.key_frame();
  chunk.encoding = static_cast<Encoding>(wire.encoding());
  std::swap(wire.colliders(), chunk.colliders);
  std::swap(wire.collider_poses(), chunk.collider_poses);
  std::swap(wire.payload(), chunk.payload);
}

void toWire(const Command& command, v4::Command& wire) {
  wire.id(command.id);
  wire.groom_id(command.groom_id);
  wire.name(shortened(command.name));
  wire.kind(static_cast<uint32_t>(command.kind));
  wire.values(command.values);
}

void fromWire(const v4::Command& wire, Command& command) {
  command.id = wire.id();
  command.groom_id = wire.groom_id();
  command.name = shortened(wire.name());
  command.kind = static_cast<CommandKind>(wire.kind());
  command.values = wire.values();
}

void toWire(const Status& status, v4::Status& wire) {
  wire.session(status.session);
  wire.strands(status.strands);
  wire.vertices(status.vertices);
  wire.frames(status.frames);
  wire.non_finite(status.non_finite);
  wire.strands_reset(status.strands_reset);
  wire.last_command(status.last_command);
  wire.simulation_time(status.simulation_time);
  wire.step_ms_median(status.step_ms_median);
  wire.step_ms_p95(status.step_ms_p95);
  wire.mean_stretch(status.mean_stretch);
  wire.max_stretch(status.max_stretch);
  wire.max_penetration(status.max_penetration);
  wire.groom_id(status.groom_id);
  wire.readers(status.readers);
  wire.codec(shortened(status.encoding.codec));
  wire.codec_max_error(status.encoding.max_error);
  wire.codec_worst_error(status.encoding.worst_error);
  wire.frame_bytes(status.encoding.frame_bytes);
  wire.strands_sent_finer(status.encoding.strands_sent_finer);
  wire.groom_name(shortened(status.groom_name));
  wire.backend(shortened(status.backend));
  wire.device(shortened(status.device));
  wire.last_command_error(shortened(status.last_command_error));
}

void fromWire(const v4::Status& wire, Status& status) {
  status.session = wire.session();
  status.strands = wire.strands();
  status.vertices = wire.vertices();
  status.frames = wire.frames();
  status.non_finite = wire.non_finite();
  status.strands_reset = wire.strands_reset();
  status.last_command = wire.last_command();
  status.simulation_time = wire.simulation_time();
  status.step_ms_median = wire.step_ms_median();
  status.step_ms_p95 = wire.step_ms_p95();
  status.mean_stretch = wire.mean_stretch();
  status.max_stretch = wire.max_stretch();
  status.max_penetration = wire.max_penetration();
  status.groom_id = wire.groom_id();
  status.readers = wire.readers();
  status.encoding.codec = shortened(wire.codec());
  status.encoding.max_error = wire.codec_max_error();
  status.encoding.worst_error = wire.codec_worst_error();
  status.encoding.frame_bytes = wire.frame_bytes();
  status.encoding.strands_sent_finer = wire.strands_sent_finer();
  status.groom_name = shortened(wire.groom_name());
  status.backend = shortened(wire.backend());
  status.device = shortened(wire.device());
  status.last_command_error = shortened(wire.last_command_error());
}

}  // namespace strandcast
