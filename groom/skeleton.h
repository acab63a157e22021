#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/geometry.h"

namespace strandcast {

/// x_world = linear * x_local + translation; scale and shear are possible.
using Placement = Eigen::Transform<double, 3, Eigen::AffineCompact, Eigen::DontAlign>;

/// Where a joint is in its parent's frame: scaled, then rotated, then moved.
struct JointTransform {
  Vec3 translation = Vec3::Zero();
  Quat rotation = Quat::Identity();
  Vec3 scale = Vec3::Ones();

  Placement placement() const;
};

struct SkeletonJoint {
  std::string name;
  int parent = -1;  ///< index of an earlier joint; -1 for a root
  JointTransform rest;
};

/// A tree of joints, parents before children.
struct Skeleton {
  std::vector<SkeletonJoint> joints;
  Placement root = Placement::Identity();  ///< what the roots are in: units and axes

  /// Index of the joint called `name`; with an empty name the first whose name contains "head" in any case;
  /// -1 if none.
  int find(const std::string& name) const;
  std::vector<JointTransform> rest() const;
  /// Of every joint in the world. `locals`: one per joint.
  std::vector<Placement> place(std::span<const JointTransform> locals) const;
};

/// How a sampler goes from key to key (glTF 2.0 specification, appendix C).
enum class ClipInterpolation : uint8_t { kStep, kLinear, kCubicSpline };
enum class ClipPath : uint8_t { kTranslation, kRotation, kScale };

/// Values over time, held before the first key and after the last.
struct ClipSampler {
  ClipInterpolation interpolation = ClipInterpolation::kLinear;
  uint32_t components = 3;    ///< 1, 3, or 4: a quaternion x y z w
  std::vector<float> times;   ///< s, at least one, ascending
  std::vector<float> values;  ///< per key `components`; of a cubic spline three times as many: the tangent
                              ///< that comes in, the value, the tangent that goes out

  /// A quaternion is interpolated on the sphere (linear) or normalised (cubic spline).
  Eigen::Vector4f at(double seconds) const;
};

struct ClipChannel {
  uint32_t joint = 0;
  ClipPath path = ClipPath::kTranslation;
  uint32_t sampler = 0;
};

/// The weight of a morph target over time.
struct MorphChannel {
  uint32_t target = 0;   ///< of SkinnedMesh::targets
  uint32_t sampler = 0;  ///< of one component
};

/// A motion of a skeleton and of the morph targets of the meshes on it.
struct SkeletonClip {
  std::string name;
  std::vector<ClipSampler> samplers;
  std::vector<ClipChannel> channels;  ///< no two of one joint and path
  std::vector<MorphChannel> morphs;   ///< no two of one target
  double duration = 0;                ///< s, the time of the last key

  bool isStill() const { return channels.empty() && morphs.empty(); }

  /// Overwrites what the clip moves. `locals`: one per joint of the skeleton.
  void pose(double seconds, std::span<JointTransform> locals) const;
  /// Likewise. `weights`: one per target.
  void weigh(double seconds, std::span<float> weights) const;
};

}  // namespace strandcast
