#include "core/broad_phase.h"

#include <algorithm>
#include <numeric>

namespace strandcast {
namespace {

class AllPairs final : public BroadPhase {
 public:
  void findPairs(std::span<const Box> bodies, std::span<const Box> neighbourhoods,
                 NearBodyLists& out) override {
    out.offsets.assign(1, 0);
    out.bodies.clear();
    for (const Box& neighbourhood : neighbourhoods) {
      for (uint32_t i = 0; i < bodies.size(); ++i)
        if (neighbourhood.intersects(bodies[i])) out.bodies.push_back(i);
      out.offsets.push_back(static_cast<uint32_t>(out.bodies.size()));
    }
  }
};

}  // namespace

std::unique_ptr<BroadPhase> makeAllPairs() { return std::make_unique<AllPairs>(); }

namespace {

/// Positions of the roots on a Z-order curve (Morton 1966) through their box: neighbours on the curve are
/// neighbours on the head.
std::vector<uint32_t> mortonCodes(const std::vector<Pose>& roots) {
  Box box;
  for (const Pose& root : roots) box.extend(root.position);
  const float cell = std::max(box.sizes().maxCoeff(), 1e-6f) / 1023;
  std::vector<uint32_t> codes(roots.size());
  for (size_t s = 0; s < roots.size(); ++s)
    for (int axis = 0; axis < 3; ++axis) {
      const auto place = static_cast<uint32_t>((roots[s].position[axis] - box.min()[axis]) / cell);
      for (int bit = 0; bit < 10; ++bit) codes[s] |= (place >> bit & 1u) << (3 * bit + axis);
    }
  return codes;
}

}  // namespace

StrandOrder strandOrder(const StrandModel& model) {
  StrandOrder order;
  order.strands.resize(model.strands());
  std::iota(order.strands.begin(), order.strands.end(), 0u);
  const std::vector<uint32_t> place = mortonCodes(model.rest_roots);
  std::stable_sort(order.strands.begin(), order.strands.end(), [&](uint32_t a, uint32_t b) {
    return std::pair(model.verticesOf(a), place[a]) < std::pair(model.verticesOf(b), place[b]);
  });
  order.neighbourhood_of.resize(model.strands());
  for (uint32_t i = 0; i < order.strands.size(); ++i) {
    const bool more = i > 0 && i - order.offsets.back() < kNeighbours &&
                      model.verticesOf(order.strands[i]) == model.verticesOf(order.strands[i - 1]);
    if (i > 0 && !more) order.offsets.push_back(i);
    order.neighbourhood_of[order.strands[i]] = static_cast<uint32_t>(order.offsets.size()) - 1;
  }
  if (!order.strands.empty()) order.offsets.push_back(static_cast<uint32_t>(order.strands.size()));
  return order;
}

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
