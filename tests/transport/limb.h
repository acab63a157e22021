#pragma once
#include <cmath>
#include <memory>
#include <random>

#include "moving_hair.h"
#include "sample_messages.h"

namespace strandcast {

constexpr uint32_t kLimb = 7;

/// A part of a skinned body. Its skin is the plane y = 0, within 4 cm of `x` along the x axis, m.
inline Collider limb(uint32_t id = kLimb, float x = 0) {
  auto field = std::make_shared<DistanceField>();
  field->grid = {{x - 0.04f, -0.04f, -0.04f}, 0.01f, {1, 1, 1}, 0.02f, 1e-5f, 0, 0, 0};
  field->index = {0};
  const auto height = [](uint32_t sample) {
    const int above = static_cast<int>(sample / kBrickSide % kBrickSide) - 4;
    return static_cast<uint16_t>(1000 * above);
  };
  for (uint32_t i = 0; i < kBrickWords; ++i)
    field->samples.push_back(height(2 * i) | static_cast<uint32_t>(height(2 * i + 1)) << 16);
  for (const float y : {-0.04f, -0.04f, 0.04f, 0.04f, -0.04f, -0.04f, 0.04f, 0.04f})
    field->corners.push_back(y);
  Collider limb{id, false, true, {}};
  limb.shapes.emplace_back().kind = PrimitiveKind::kField;
  limb.shapes.back().field = field;
  return limb;
}

inline ColliderSet limbs(std::vector<Collider> colliders, uint32_t revision = 1) {
  ColliderSet set;
  set.groom_id = 1;
  set.session = 11;
  set.revision = revision;
  set.colliders = std::move(colliders);
  return set;
}

/// Hair that grows everywhere on the limb's skin, along its normal.
inline GroomDescription limbGroom(size_t strands, size_t vertices) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> place(-0.035f, 0.035f);
  GroomDescription groom;
  groom.groom_id = 1;
  groom.session = 11;
  groom.revision = 1;
  groom.name = "fur";
  std::vector<Vec3> points(vertices);
  for (size_t s = 0; s < strands; ++s) {
    points[0] = Vec3(place(random), 0, place(random));
    for (size_t i = 1; i < vertices; ++i) points[i] = points[i - 1] + Vec3(0.001f, 0.002f, 0);
    groom.guides.append(points);
  }
  return groom;
}

/// Frame `number` at 60 Hz: the limb swings by 30 degrees about a joint 30 cm above it, twice a second, and
/// carries its hair. With `is_head` the head moves in the same way.
inline GuideFrame limbFrame(const GroomDescription& groom, uint64_t number, bool is_head = false) {
  GuideFrame frame = frameOf(groom, number);
  const auto angle = static_cast<float>(0.5 * std::sin(12 * frame.simulation_time));
  const Vec3 joint(0, 0.3f, 0);
  Pose swing;
  swing.rotation = Quat(Eigen::AngleAxisf(angle, Eigen::Vector3f(0.6f, 0, 0.8f)));
  swing.position = joint - swing.rotate(joint);
  if (is_head) frame.head = swing;
  frame.colliders = {{kLimb, swing, {}}};
  for (const Vec3& point : groom.guides.positions) frame.positions.push_back(swing.apply(point));
  return frame;
}

/// Whether a frame satisfies what readers are guaranteed.
inline bool isSound(const GuideFrame& frame, size_t vertices) {
  bool is_sound = frame.positions.size() == vertices && frame.colliders.size() <= kMaxPlacedColliders;
  for (const Vec3& position : frame.positions) is_sound = is_sound && position.allFinite();
  for (const PlacedCollider& placed : frame.colliders)
    is_sound = is_sound && placed.pose.position.allFinite() &&
               std::abs(placed.pose.rotation.squaredNorm() - 1) < 1e-3f;
  return is_sound;
}

/// m: largest distance between the limb's positions in two frames.
inline float limbOff(const GuideFrame& a, const GuideFrame& b) {
  float off = 0;
  for (const Vec3& point : {Vec3(-0.04f, 0, 0), Vec3(0.04f, 0, 0.04f), Vec3(0, 0.04f, -0.04f)})
    off = std::max(off, (a.colliders.at(0).pose.apply(point) - b.colliders.at(0).pose.apply(point)).norm());
  return off;
}

}  // namespace strandcast
