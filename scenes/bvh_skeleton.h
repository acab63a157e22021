#pragma once
#include <string>
#include <vector>

#include "groom/skeleton.h"
#include "scenes/bvh.h"

namespace strandcast {

/// What a BVH clip does to a skeleton whose joints have the same names.
struct BvhOnSkeleton {
  SkeletonClip clip;                         ///< a cubic spline through the frames, without jumps in velocity
  size_t joints = 0;                         ///< of the skeleton, that have one of the same name
  float unit_meters = 1;                     ///< of the clip, given or found
  std::vector<std::string> notes, warnings;  ///< of its unit, a sentence each
};

/// A joint turns in the world as its namesake does from where all channels are zero, which is to show the
/// posture that the skeleton has at rest, turned as BvhMatch::upright(); a root also moves as its namesake
/// does from the first frame. `unit_meters` 0 = found, see unitOf(). Throws Error, naming `name`, when no
/// joint has a namesake.
BvhOnSkeleton onSkeleton(const BvhClip& bvh, const Skeleton& skeleton, float unit_meters,
                         const std::string& name);

}  // namespace strandcast
