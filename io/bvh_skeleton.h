// A BVH clip on a skeleton: joints matched by name, unit and axes deduced from the bones, rotations
// transferred.
#pragma once
#include <string>
#include <vector>

#include "io/bvh.h"
#include "io/skeleton.h"

namespace strandcast {

/// Correspondence by name between the joints of a clip and those of a skeleton.
struct BvhMatch {
  /// Per joint of the skeleton: index of the clip's joint of the same name, or -1.
  std::vector<int> namesakes;
  size_t joints = 0;  ///< joints of the skeleton that have a namesake

  /// Vector from a matched joint to the next matched joint below it, at rest. Bones of zero length are left
  /// out.
  struct Bone {
    Eigen::Vector3d body;  ///< m, in the world
    Vec3 clip;             ///< file units
  };
  std::vector<Bone> bones;

  BvhMatch(const BvhClip& clip, const Skeleton& skeleton);

  /// Rotation of the clip's axes that makes Y up: a quarter turn if the clip's bones as a whole are then
  /// closer to the directions of the body's bones, else the identity. As BvhClip::upright(head) if the bones
  /// do not decide.
  Quat upright(const BvhClip& clip, size_t head) const;
};

/// Metres per unit of a clip, with remarks.
struct BvhUnit {
  float meters = 1;
  std::vector<std::string> notes, warnings;  ///< one sentence each, without the name of the clip
};

/// `given`: metres per unit; 0: deduced. The deduced unit is the median of the ratios of the body's bones to
/// the clip's, weighted by length; without matching bones, BvhClip::guessedUnit(). `match` may be null.
BvhUnit unitOf(const BvhClip& clip, const BvhMatch* match, float given);

/// A BVH clip transferred to a skeleton with joints of the same names.
struct BvhOnSkeleton {
  SkeletonClip clip;                         ///< a cubic spline through the frames, with continuous velocity
  size_t joints = 0;                         ///< joints of the skeleton that have a namesake in the clip
  float unit_meters = 1;                     ///< of the clip, given or deduced
  std::vector<std::string> notes, warnings;  ///< on its unit, one sentence each
};

/// Transfers the rotations of joints by name. The pose with all channels zero is taken as the rest pose of
/// the skeleton, rotated by BvhMatch::upright(). Each joint gets the world rotation that its namesake has
/// relative to that pose. A root also gets its namesake's translation relative to the first frame.
///
/// `unit_meters`: metres per unit of the clip; 0: deduced, see unitOf(). Throws Error, naming `name`, when no
/// joint has a namesake.
BvhOnSkeleton onSkeleton(const BvhClip& bvh, const Skeleton& skeleton, float unit_meters,
                         const std::string& name);

}  // namespace strandcast
