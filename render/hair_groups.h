#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "render/hair_growth.h"
#include "render/plausible_bounds.h"

namespace strandcast {

/// Groups of neighbouring hairs, of up to kGroupGuides guides each, with a bounding box per group for
/// culling.
class HairGroups {
 public:
  static constexpr size_t kGroupGuides = 32;

  HairGroups() = default;
  /// `guides`: at rest. `hairs`: from growHairs() with these guides and this growth.
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
