#pragma once
#include <random>

#include "transport/codec/guide_encoder.h"
#include "transport/frame_queue.h"
#include "transport/messages.h"

namespace strandcast {

/// A seeded groom with every optional array, or with none. `vertices(s)` gives each strand's count.
template <class VerticesOf>
GroomDescription sampleGroom(size_t strands, VerticesOf vertices, bool with_arrays = true) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> unit(-1, 1);
  GroomDescription groom;
  groom.groom_id = 1;
  groom.session = 11;
  groom.revision = 1;
  groom.name = "sample";
  groom.hair_radius = 50e-6f;
  std::vector<Vec3> points;
  for (size_t s = 0; s < strands; ++s) {
    points.resize(vertices(s));
    for (Vec3& point : points) point = Vec3(unit(random), unit(random), unit(random));
    groom.guides.append(points);
  }
  if (!with_arrays) return groom;
  for (size_t v = 0; v < groom.guides.vertices(); ++v) {
    groom.guides.pinned.push_back(static_cast<uint8_t>(random() % 2));
    groom.guides.radii.push_back(1e-4f * (2 + unit(random)));
  }
  for (size_t s = 0; s < strands; ++s) {
    groom.guides.uvs.emplace_back(unit(random), unit(random));
    groom.guides.parts.push_back(static_cast<uint16_t>(random()));
  }
  return groom;
}

inline GroomDescription uniformGroom(size_t strands, size_t vertices) {
  return sampleGroom(strands, [=](size_t) { return vertices; });
}

/// A grid of size x size positions.
inline BodyDescription sampleBody(uint32_t size, bool with_arrays = true) {
  BodyDescription body;
  body.groom_id = 1;
  body.session = 11;
  body.revision = 1;
  body.mesh.name = "grid";
  for (uint32_t i = 0; i < size * size; ++i) {
    body.mesh.positions.emplace_back(static_cast<float>(i % size), 0.5f, static_cast<float>(i / size));
    if (with_arrays) body.head_weights.push_back(static_cast<float>(i) / static_cast<float>(size * size));
    const bool has_cell = i % size + 1 < size && i / size + 1 < size;
    if (has_cell) body.mesh.triangles.push_back({i, i + 1, i + size});
  }
  if (with_arrays) computeNormals(body.mesh);
  return body;
}

/// Frame `number` of a groom: every position tells its vertex and frame.
inline void fillSampleFrame(const GroomDescription& groom, uint64_t number, GuideFrame& frame) {
  frame.groom_id = groom.groom_id;
  frame.session = groom.session;
  frame.revision = groom.revision;
  frame.frame = number;
  frame.simulation_time = static_cast<double>(number) / 60;
  frame.publish_time = systemTime();
  frame.head.position = Vec3(0, static_cast<float>(number), 0);
  frame.head.rotation = Quat(0.6f, 0, 0.8f, 0);
  frame.positions.resize(groom.guides.vertices());
  for (size_t v = 0; v < frame.positions.size(); ++v) {
    frame.positions[v] = Vec3(static_cast<float>(v), static_cast<float>(number), 1);
  }
}

inline GuideFrame sampleFrame(const GroomDescription& groom, uint64_t number) {
  GuideFrame frame;
  fillSampleFrame(groom, number, frame);
  return frame;
}

/// All chunks of a frame, as a publisher with these options makes them.
inline std::vector<GuideChunk> splitFrame(const GroomDescription& groom, const GuideFrame& frame,
                                          const CodecOptions& codec = {Codec::kFloat32}) {
  GuideEncoder encoder(codec);
  encoder.setGroom(groom.guides);
  std::vector<GuideChunk> chunks(encoder.runs().size());
  for (uint32_t i = 0; i < chunks.size(); ++i) encoder.encode(frame, i, chunks[i]);
  return chunks;
}

inline bool isSampleFrame(const GuideFrame& frame) {
  for (size_t v = 0; v < frame.positions.size(); ++v) {
    if (frame.positions[v] != Vec3(static_cast<float>(v), static_cast<float>(frame.frame), 1)) return false;
  }
  return frame.head.position.y() == static_cast<float>(frame.frame) && !frame.positions.empty();
}

}  // namespace strandcast
