// Which hairs a picture draws: level of detail, and groups with bounding boxes for culling.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "core/geometry.h"
#include "render/hair_growth.h"

namespace strandcast {

/// The box of plausible hair positions: within 1000 m of the groom's median position along each axis, carried
/// by the head. Received positions outside it do not enlarge bounding boxes.
class PlausibleBounds {
 public:
  PlausibleBounds() = default;  ///< of a groom about the origin
  explicit PlausibleBounds(std::span<const Vec3> rest);

  void carryTo(const Pose& head) { middle_ = head.rotation.normalized() * rest_middle_ + head.position; }
  bool holds(const Vec3& position) const;

 private:
  Vec3 rest_middle_ = Vec3::Zero(), middle_ = Vec3::Zero();
};

/// The level of detail of the hair in a picture: fewer hairs, each wider, and every `node_stride`-th node.
/// Let p be `threshold` x width x importance, clamped to 1. A hair is drawn where 1 - dither is below p,
/// hence with probability p, and its width is divided by p. The rest of its dither selects how many samples
/// it covers. The expected covered area is unchanged, and a hair that appears or disappears covers no sample
/// at that moment.
struct HairDetail {
  float threshold = 1e9f;  ///< above 0
  size_t hairs = 0;        ///< number of hairs to draw, from the first
  int node_stride = 1;     ///< of hairs grown from a seed
  int vertex_stride = 1;   ///< of bound hairs, which keep their last vertex
};

/// A size with hysteresis. The held size is `band` (0 = none) larger than the true one and changes only where
/// the true one exceeds it or falls below it by (1 + band)^2. It is never less than the true one, so a level
/// of detail chosen by it is never too coarse.
class HysteresisSize {
 public:
  /// Returns the held size for the present true size.
  float of(float size, float band);

 private:
  float held_ = 0;
};

/// The sort key of hairs, largest first: a threshold t draws those with a key of at least 1 / t.
float detailKey(const Hair& hair);
/// The detail that draws the fraction `part`, above 0 to 1, of sorted hairs.
HairDetail detailOfPart(std::span<const Hair> hairs, float part);
/// The detail for a hair of width 1 that covers `hair_pixels` pixels at its nearest point. With `finest` the
/// size of a sample in pixels, only hairs that cover no sample there are left out; a larger value leaves out
/// more.
HairDetail detailOfSize(std::span<const Hair> hairs, float hair_pixels, float finest);
/// The fraction of the strands' length that remains when each is replaced by `pieces` chords of equal arc
/// length.
double lengthKept(const StrandSet& strands, int pieces);
/// The largest node stride, a power of 2, that keeps segments of `segment_pixels` pixels at their nearest
/// point within `longest` pixels, and leaves at least `min_segments` of the `segments`.
int strideFor(float segment_pixels, float longest, int segments, int min_segments);

/// Groups of neighbouring hairs, of up to kGroupGuides guides each, with a bounding box per group for
/// culling.
class HairGroups {
 public:
  static constexpr size_t kGroupGuides = 32;

  HairGroups() = default;
  /// `guides`: at rest. `hairs`: from growHairs() and boundHairs() with these guides and this growth.
  HairGroups(const StrandSet& guides, std::span<const Hair> hairs, const HairGrowth& growth);

  size_t count() const { return groups_.size(); }
  uint32_t groupOf(size_t hair) const { return group_of_[hair]; }

  /// m, largest distance of any hair from its guides' curves, and the mean over hairs.
  float reach() const { return reach_; }
  float meanReach() const { return mean_reach_; }

  /// Computes the groups' boxes from the guides' positions, except those outside `place`; `beside` metres are
  /// added on all sides.
  void place(std::span<const Vec3> positions, const PlausibleBounds& place, float beside);
  /// Bounds every hair of the group; empty where no guide of it is finite.
  const Box& box(size_t group) const { return groups_[group].box; }

 private:
  struct Group {
    std::vector<uint32_t> guides;  ///< followed by its hairs, including guides of neighbouring groups
    float reach = 0;               ///< m, largest distance of a hair from its guides
    Box box;
  };
  std::vector<uint32_t> offsets_;  ///< of the guides' vertices
  std::vector<Group> groups_;
  std::vector<uint32_t> group_of_;  ///< group index per hair
  std::vector<Box> guide_boxes_;
  float reach_ = 0, mean_reach_ = 0;
};

}  // namespace strandcast
