#pragma once
#include <string>
#include <vector>

#include "io/bvh.h"
#include "io/skeleton.h"

namespace strandcast {

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
