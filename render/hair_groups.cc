#include "render/hair_groups.h"

#include <algorithm>
#include <numeric>

namespace strandcast {
namespace {

Vec3 rootOf(const StrandSet& guides, uint32_t guide) {
  const auto points = guides.strand(guide);
  return !points.empty() && points.front().allFinite() ? points.front() : Vec3(Vec3::Zero());
}

/// Recursively halves the guides across the longest axis of their roots' box, down to kGroupGuides.
void split(const StrandSet& guides, std::span<uint32_t> all, std::vector<uint32_t>& group_of,
           uint32_t& groups) {
  if (all.size() <= HairGroups::kGroupGuides) {
    for (const uint32_t guide : all) group_of[guide] = groups;
    ++groups;
    return;
  }
  Box box;
  for (const uint32_t guide : all) box.extend(Eigen::Vector3f(rootOf(guides, guide)));
  int axis = 0;
  box.sizes().maxCoeff(&axis);
  const size_t half = all.size() / 2;
  std::nth_element(all.begin(), all.begin() + static_cast<ptrdiff_t>(half), all.end(),
                   [&](uint32_t a, uint32_t b) { return rootOf(guides, a)[axis] < rootOf(guides, b)[axis]; });
  split(guides, all.first(half), group_of, groups);
  split(guides, all.subspan(half), group_of, groups);
}

/// Bounds how far a spline may leave its vertices' box.
float longestEdge(std::span<const Vec3> points) {
  float longest = 0;
  for (size_t i = 1; i < points.size(); ++i) longest = std::max(longest, (points[i] - points[i - 1]).norm());
  return std::isfinite(longest) ? longest : 0;
}

}  // namespace

HairGroups::HairGroups(const StrandSet& guides, std::span<const Hair> hairs, const HairGrowth& growth)
    : offsets_(guides.offsets), guide_boxes_(guides.strands()) {
  std::vector<uint32_t> order(guides.strands()), group_of_guide(guides.strands(), 0);
  std::iota(order.begin(), order.end(), 0u);
  uint32_t groups = 0;
  if (!order.empty()) split(guides, order, group_of_guide, groups);
  groups_.resize(groups);
  group_of_.reserve(hairs.size());
  const float profile = growth.lock_profile.maxCoeff();
  const float example_reach = growth.curl_example ? growth.curl_example->reach : 0;
  for (const Hair& hair : hairs) {
    group_of_.push_back(group_of_guide[hair.guides[0]]);
    Group& group = groups_[group_of_.back()];
    const float root = std::hypot(hair.beside[0], hair.beside[1]);
    const float lock = std::hypot(hair.offset[0], hair.offset[1]) * profile;
    const float reach = root + lock + hair.tip_deviation + hair.whole_deviation + hair.curl_radius +
                        hair.example_scale * example_reach;
    group.reach = std::max(group.reach, reach);
    mean_reach_ += reach / static_cast<float>(hairs.size());
    for (const uint32_t guide : hair.guides) group.guides.push_back(guide);
  }
  for (Group& group : groups_) {
    reach_ = std::max(reach_, group.reach);
    std::sort(group.guides.begin(), group.guides.end());
    group.guides.erase(std::unique(group.guides.begin(), group.guides.end()), group.guides.end());
    float edge = 0;
    for (const uint32_t guide : group.guides) edge = std::max(edge, longestEdge(guides.strand(guide)));
    group.reach += edge;
  }
}

void HairGroups::place(std::span<const Vec3> positions, const PlausibleBounds& place, float beside) {
  for (size_t guide = 0; guide < guide_boxes_.size(); ++guide) {
    Box& box = guide_boxes_[guide];
    box.setEmpty();
    for (const Vec3& p : positions.subspan(offsets_[guide], offsets_[guide + 1] - offsets_[guide]))
      if (place.holds(p)) box.extend(Eigen::Vector3f(p));
  }
  for (Group& group : groups_) {
    group.box.setEmpty();
    for (const uint32_t guide : group.guides) group.box.extend(guide_boxes_[guide]);
    if (group.box.isEmpty()) continue;
    const Eigen::Vector3f margin = Eigen::Vector3f::Constant(group.reach + beside);
    group.box = Box(group.box.min() - margin, group.box.max() + margin);
  }
}

}  // namespace strandcast
