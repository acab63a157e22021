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

}  // namespace strandcast
