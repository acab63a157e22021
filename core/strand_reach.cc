#include "core/strand_reach.h"

#include <algorithm>

#include "core/broad_phase.h"

namespace strandcast {
namespace {

constexpr float kStretch = 1.1f;  // more than edges before a pin stretch

bool isHeldElsewhere(const StrandModel& model, uint32_t strand) {
  for (uint32_t v = model.offsets[strand]; v < model.offsets[strand + 1]; ++v)
    if (model.isBonePinned(strand, v)) return true;
  return false;
}

// Bounding box of `box` after it is carried by `pose`.
Box carried(const Box& box, const Pose& pose) {
  const Eigen::Vector3f middle(pose.apply(Vec3(box.center())));
  const Eigen::Vector3f half = pose.rotation.toRotationMatrix().cwiseAbs() * (0.5f * box.sizes());
  return {middle - half, middle + half};
}

}  // namespace

StrandReach::StrandReach(const StrandModel& model, const StrandOrder& order, std::span<const float> lengths)
    : reach_(order.neighbourhoods()) {
  for (uint32_t n = 0; n < reach_.size(); ++n) {
    const size_t first = roots_.size();
    for (const uint32_t s : order.strandsOf(n)) {
      const uint16_t bone = model.rootBone(s);
      auto known = std::find_if(roots_.begin() + static_cast<ptrdiff_t>(first), roots_.end(),
                                [&](const Roots& roots) { return roots.bone == bone; });
      if (known == roots_.end()) known = roots_.insert(known, {n, bone, Box()});
      known->box.extend(Eigen::Vector3f(model.rest_roots[s].position));
      reach_[n] = std::max(reach_[n], isHeldElsewhere(model, s) ? kEndless : kStretch * lengths[s]);
    }
  }
}

void StrandReach::place(std::span<const Pose> begin, std::span<const Pose> end, float margin,
                        std::span<Box> boxes) const {
  for (Box& box : boxes) box.setEmpty();
  for (const Roots& roots : roots_)
    boxes[roots.neighbourhood]
        .extend(carried(roots.box, begin[roots.bone]))
        .extend(carried(roots.box, end[roots.bone]));
  for (size_t n = 0; n < boxes.size(); ++n) {
    boxes[n].min().array() -= reach_[n] + margin;
    boxes[n].max().array() += reach_[n] + margin;
  }
}

}  // namespace strandcast
