#pragma once
#include <type_traits>

#include "transport/chunks.h"

namespace strandcast {

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
