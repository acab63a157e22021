#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "render/hair_growth.h"
#include "render/hair_place.h"

namespace strandcast {

/// Hairs that grow side by side, up to kGroupGuides guides' worth, and a box about each group: so that whole
/// groups outside a picture are left out.
class HairGroups {
 public:
  static constexpr size_t kGroupGuides = 32;

  HairGroups() = default;
  HairGroups(const StrandSet& guides, std::span<const Hair> hairs, const HairGrowth& growth);

  size_t count() const { return groups_.size(); }
  uint32_t groupOf(size_t hair) const { return group_of_[hair]; }

  /// m, that any hair may be beside its guides' curves, and the mean of what each may.
  float reach() const { return reach_; }
  float meanReach() const { return mean_reach_; }

  /// Boxes of where the guides are now, but for what `place` does not hold; `beside` metres are added to all
  /// sides.
  void place(std::span<const Vec3> positions, const HairPlace& place, float beside);
  /// Holds every hair of the group; empty where no guide of it is finite.
  const Box& box(size_t group) const { return groups_[group].box; }

 private:
  struct Group {
    std::vector<uint32_t> guides;  ///< that its hairs follow, those of neighbouring groups among them
    float reach = 0;               ///< m, that a hair may be beside its guides
    Box box;
  };
  std::vector<uint32_t> offsets_;  ///< of the guides' vertices
  std::vector<Group> groups_;
  std::vector<uint32_t> group_of_;  ///< per hair
  std::vector<Box> guide_boxes_;
  float reach_ = 0, mean_reach_ = 0;
};

}  // namespace strandcast
