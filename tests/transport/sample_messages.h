#pragma once
#include <array>
#include <cstring>
#include <memory>
#include <random>

#include "transport/codec/guide_encoder.h"
#include "transport/frame_queue.h"
#include "transport/messages.h"

namespace strandcast {

/// A seeded groom with every optional array, or with none. Strand s has `vertices(s)` vertices.
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

/// A ball that follows the head, and a body of every other kind of shape that does not.
inline ColliderSet sampleColliders(uint64_t session = 11) {
  ColliderSet set;
  set.groom_id = 1;
  set.session = session;
  set.revision = 1;
  const auto shape = [](PrimitiveKind kind) {
    ContactPrimitive made;
    made.kind = kind;
    made.a = Vec3(0.1f, 0.2f, 0.3f);
    made.radius = 0.05f;
    made.radius_b = 0.02f;
    made.extent = Vec3(0.1f, 0.05f, 0.2f);
    made.rotation = Quat(0.6f, 0, 0.8f, 0);
    return made;
  };
  set.colliders.push_back({0, true, true, {shape(PrimitiveKind::kSphere)}});
  Collider body{7, false, true, {}};
  for (const PrimitiveKind kind :
       {PrimitiveKind::kCapsule, PrimitiveKind::kPlane, PrimitiveKind::kTaperedCapsule,
        PrimitiveKind::kEllipsoid, PrimitiveKind::kBox})
    body.shapes.push_back(shape(kind));
  ContactPrimitive convex = shape(PrimitiveKind::kConvex);
  auto block = std::make_shared<ConvexBody>();
  for (int c = 0; c < 3; ++c) {
    for (const float side : {-1.0f, 1.0f}) {
      std::array<float, 4> plane{0, 0, 0, 0.1f};
      plane[static_cast<size_t>(c)] = side;
      block->planes.push_back(plane);
    }
  }
  block->bounds = Box(Eigen::Vector3f::Constant(-0.1f), Eigen::Vector3f::Constant(0.1f));
  convex.convex = block;
  body.shapes.push_back(convex);
  ContactPrimitive field = shape(PrimitiveKind::kField);
  auto grid = std::make_shared<DistanceField>();
  grid->grid = {{-0.1f, 0, 0.1f}, 0.01f, {2, 1, 1}, 0.02f, 1e-5f, 0, 0, 0};
  grid->index = {0, kOutsideBrick};
  for (uint32_t i = 0; i < kBrickWords; ++i) grid->samples.push_back(i * 77);
  for (int i = 0; i < 12; ++i) grid->corners.push_back(0.01f * static_cast<float>(i - 3));
  field.field = grid;
  body.shapes.push_back(field);
  set.colliders.push_back(std::move(body));
  return set;
}

inline bool areAlike(const ContactPrimitive& a, const ContactPrimitive& b) {
  const bool numbers = a.kind == b.kind && a.a == b.a && a.b == b.b && a.radius == b.radius &&
                       a.radius_b == b.radius_b && a.friction == b.friction && a.extent == b.extent &&
                       a.rotation.coeffs() == b.rotation.coeffs();
  if (!numbers || !a.convex != !b.convex || !a.field != !b.field) return false;
  const auto same = [](const auto& x, const auto& y) {
    return x.size() == y.size() && std::memcmp(x.data(), y.data(), x.size() * sizeof(x[0])) == 0;
  };
  if (a.convex && !(same(a.convex->planes, b.convex->planes) && a.convex->bounds.isApprox(b.convex->bounds)))
    return false;
  return !a.field || (std::memcmp(&a.field->grid, &b.field->grid, sizeof(FieldGrid)) == 0 &&
                      same(a.field->index, b.field->index) && same(a.field->samples, b.field->samples) &&
                      same(a.field->corners, b.field->corners));
}

inline bool areAlike(const ColliderSet& a, const ColliderSet& b) {
  if (a.colliders.size() != b.colliders.size()) return false;
  for (size_t i = 0; i < a.colliders.size(); ++i) {
    const Collider &x = a.colliders[i], &y = b.colliders[i];
    if (x.id != y.id || x.follows_head != y.follows_head || x.is_whole != y.is_whole ||
        x.shapes.size() != y.shapes.size())
      return false;
    for (size_t k = 0; k < x.shapes.size(); ++k)
      if (!areAlike(x.shapes[k], y.shapes[k])) return false;
  }
  return true;
}

/// All numbers differ.
inline SurfaceBend sampleBend(uint64_t number) {
  SurfaceBend bend;
  float next = static_cast<float>(number);
  bendNumbers(bend, [&](float& into) { into = next += 0.25f; });
  return bend;
}
inline bool areAlike(const SurfaceBend& a, const SurfaceBend& b) {
  return a.middle == b.middle && a.terms == b.terms;
}

/// Two samples of a head, a joint and a body, and of one weight.
inline PoseSamples samplePoses() {
  PoseSamples samples;
  samples.source = 7;
  samples.time = 2'000'000'000;
  samples.newest = 41;
  samples.names = "head joint:left%20arm body:chair";
  samples.weight_names = "smile";
  samples.ages = {0, 16'666'667};
  for (int i = 0; i < 6; ++i)
    samples.poses.insert(samples.poses.end(), {0.1f * static_cast<float>(i), 1, 2, 0, 0.6f, 0, 0.8f});
  samples.weights = {0.5f, 0.25f};
  return samples;
}

/// Frame `number` of a groom: every position encodes its vertex and frame.
inline void fillSampleFrame(const GroomDescription& groom, uint64_t number, GuideFrame& frame) {
  frame.groom_id = groom.groom_id;
  frame.session = groom.session;
  frame.revision = groom.revision;
  frame.frame = number;
  frame.simulation_time = static_cast<double>(number) / 60;
  frame.publish_time = systemTime();
  frame.head.position = Vec3(0, static_cast<float>(number), 0);
  frame.head.rotation = Quat(0.6f, 0, 0.8f, 0);
  const Pose at{Vec3(0, 0, static_cast<float>(number)), Quat(0.6f, 0, 0.8f, 0)};
  frame.colliders = {{7, at, sampleBend(number)}, {8, at, {}}};
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

/// All chunks of a frame, as a publisher with these options encodes them.
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
  if (frame.colliders.size() != 2 || frame.colliders[0].id != 7 || frame.colliders[1].id != 8 ||
      !areAlike(frame.colliders[0].bend, sampleBend(frame.frame)) || !frame.colliders[1].bend.isNone())
    return false;
  for (const PlacedCollider& placed : frame.colliders)
    if (placed.pose.position != Vec3(0, 0, static_cast<float>(frame.frame))) return false;
  return frame.head.position.y() == static_cast<float>(frame.frame) && !frame.positions.empty();
}

}  // namespace strandcast
