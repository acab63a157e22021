#pragma once
#include "core/geometry.h"

namespace strandcast {

/// Bounds on each coordinate for origin rebasing, m. A head within kNearOrigin of the world's origin has that
/// origin. A head farther than kFarFromOrigin from its origin needs a new one.
constexpr float kNearOrigin = 4, kFarFromOrigin = 8;

/// Origin of the coordinates in which backends and external forces compute (origin rebasing). Local
/// coordinates are relative to it and have the world's axes. Far from the world's origin, positions in float
/// are too coarse: hair would stretch and tremble.
struct Origin {
  Vec3 position = Vec3::Zero();  ///< m, world, whole metres: near it, conversions round nothing

  /// Origin for a head at this pose (world): the world's own if the head is near that, otherwise one near the
  /// head.
  static Origin forHead(const Pose& head) {
    const bool near = head.position.cwiseAbs().maxCoeff() <= kNearOrigin;
    return {near ? Vec3(Vec3::Zero()) : Vec3(head.position.array().round())};
  }
  /// Whether a head at this pose (world) needs another origin.
  bool isFar(const Pose& head) const { return toLocal(head.position).cwiseAbs().maxCoeff() > kFarFromOrigin; }
  /// Whether this is the world's origin: local coordinates are world coordinates.
  bool isWorld() const { return position.isZero(); }

  Vec3 toLocal(const Vec3& world) const { return world - position; }
  Vec3 toWorld(const Vec3& local) const { return local + position; }
  Pose toLocal(const Pose& world) const { return {toLocal(world.position), world.rotation}; }
  Pose toWorld(const Pose& local) const { return {toWorld(local.position), local.rotation}; }
};

}  // namespace strandcast
