#pragma once
#include <string>
#include <vector>

#include "groom/skeleton.h"
#include "scenes/bvh.h"

namespace strandcast {

/// A clip beside a skeleton: which of their joints have the same name.
struct BvhMatch {
  std::vector<int> namesakes;  ///< per joint of the skeleton: the clip's joint of its name, or -1
  size_t joints = 0;           ///< of the skeleton, that have one

  /// From one matched joint to the next one below it, at rest, where neither is in the place of the other.
  struct Bone {
    Eigen::Vector3d body;  ///< m, in the world
    Vec3 clip;             ///< file units
  };
  std::vector<Bone> bones;

  BvhMatch(const BvhClip& clip, const Skeleton& skeleton);

  /// Turns the clip's axes so that Y is up: by a quarter turn if its bones, as a whole, point more nearly
  /// where the body's do then; as BvhClip::upright(head) where no bones tell.
  Quat upright(const BvhClip& clip, size_t head) const;
};

/// How long a unit of a clip is, and what is to be said of it.
struct BvhUnit {
  float meters = 1;
  std::vector<std::string> notes, warnings;  ///< a sentence each, without the clip's name
};

/// `given`: metres, 0 = to be found. Then it is the median of the ratios of the body's bones to the clip's,
/// weighted by their length; where no bones match, BvhClip::guessedUnit(). `match` may be null.
BvhUnit unitOf(const BvhClip& clip, const BvhMatch* match, float given);

}  // namespace strandcast
