#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/geometry.h"

namespace strandcast {

/// x_world = linear * x_local + translation; scale and shear are possible.
using Placement = Eigen::Transform<double, 3, Eigen::AffineCompact, Eigen::DontAlign>;

/// Transform of a joint relative to its parent: scale, then rotation, then translation.
struct JointTransform {
  Vec3 translation = Vec3::Zero();
  Quat rotation = Quat::Identity();
  Vec3 scale = Vec3::Ones();

  /// The transform as an affine map.
  Placement placement() const;
};

/// A joint of a skeleton.
struct SkeletonJoint {
  std::string name;
  int parent = -1;  ///< index of an earlier joint; -1 for a root
  JointTransform rest;
};

/// A tree of joints, parents before children.
struct Skeleton {
  std::vector<SkeletonJoint> joints;
  Placement root = Placement::Identity();  ///< parent frame of the root joints: units and axes

  /// Index of the joint called `name`; -1 if none. An empty name finds the first joint whose name contains
  /// "head", ignoring case.
  int find(const std::string& name) const;
  /// Rest transform of each joint, relative to its parent.
  std::vector<JointTransform> rest() const;
  /// World transform of each joint. `locals`: one per joint.
  std::vector<Placement> worldTransforms(std::span<const JointTransform> locals) const;
};

/// Interpolation between keys (glTF 2.0 specification, appendix C).
enum class ClipInterpolation : uint8_t { kStep, kLinear, kCubicSpline };
enum class ClipPath : uint8_t { kTranslation, kRotation, kScale };

/// Values over time, constant before the first key and after the last.
struct ClipSampler {
  ClipInterpolation interpolation = ClipInterpolation::kLinear;
  uint32_t components = 3;    ///< 1, 3, or 4: a quaternion x y z w
  std::vector<float> times;   ///< s, at least one, ascending
  std::vector<float> values;  ///< per key `components`; of a cubic spline three times as many: in-tangent,
                              ///< value, out-tangent

  /// Value at `seconds`. A quaternion is interpolated spherically (linear) or normalised (cubic spline).
  Eigen::Vector4f at(double seconds) const;
};

/// Animation of one property of a joint by a sampler of the clip.
struct ClipChannel {
  uint32_t joint = 0;
  ClipPath path = ClipPath::kTranslation;
  uint32_t sampler = 0;
};

/// Weight of a morph target over time.
struct MorphChannel {
  uint32_t target = 0;   ///< index into SkinnedMesh::targets
  uint32_t sampler = 0;  ///< a sampler of one component
};

/// A motion of a skeleton and of the morph targets of its meshes.
struct SkeletonClip {
  std::string name;
  std::vector<ClipSampler> samplers;
  std::vector<ClipChannel> channels;  ///< at most one per joint and path
  std::vector<MorphChannel> morphs;   ///< at most one per target
  double duration = 0;                ///< s, the time of the last key

  /// Whether the clip moves nothing.
  bool isStill() const { return channels.empty() && morphs.empty(); }

  /// Writes the clip's values at `seconds` into `locals`, one per joint of the skeleton; others stay.
  void pose(double seconds, std::span<JointTransform> locals) const;
  /// Writes the clip's values at `seconds` into `weights`, one per target; others stay.
  void weigh(double seconds, std::span<float> weights) const;
};

/// Rotation of a joint. For a mirroring joint, the rotation of the point-reflected joint; rotations between
/// two such joints are then those of the joints.
Quat jointRotation(const Placement& joint);

}  // namespace strandcast
