#include "render/hair_selection.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

namespace strandcast {
namespace {

constexpr float kPlausibleDistance = 1e3f;  // m

}  // namespace

PlausibleBounds::PlausibleBounds(std::span<const Vec3> rest) {
  std::vector<float> along;
  for (int axis = 0; axis < 3; ++axis) {
    along.clear();
    for (const Vec3& p : rest)
      if (p.allFinite()) along.push_back(p[axis]);
    if (along.empty()) return;
    // The median, which is robust against a few damaged vertices.
    const auto middle = along.begin() + static_cast<ptrdiff_t>(along.size() / 2);
    std::nth_element(along.begin(), middle, along.end());
    rest_middle_[axis] = *middle;
  }
  middle_ = rest_middle_;
}

bool PlausibleBounds::holds(const Vec3& position) const {
  return position.allFinite() && (position - middle_).cwiseAbs().maxCoeff() < kPlausibleDistance;
}

float detailKey(const Hair& hair) { return hair.width * hair.importance / std::max(1 - hair.dither, 1e-7f); }

float HysteresisSize::of(float size, float band) {
  const float widen = 1 + band;
  if (!(size <= held_ && size * widen * widen >= held_)) held_ = size * widen;
  return held_;
}

HairDetail detailOfPart(std::span<const Hair> hairs, float part) {
  HairDetail detail;
  detail.hairs = hairs.size();
  if (hairs.empty() || !(part < 1)) return detail;
  const double wanted = std::ceil(static_cast<double>(part) * static_cast<double>(hairs.size()));
  detail.hairs = std::clamp<size_t>(static_cast<size_t>(wanted), 1, hairs.size());
  detail.threshold = 1 / std::max(detailKey(hairs[detail.hairs - 1]), 1e-9f);
  return detail;
}

HairDetail detailOfSize(std::span<const Hair> hairs, float hair_pixels, float finest) {
  HairDetail detail;
  detail.hairs = hairs.size();
  if (!(hair_pixels > 0 && finest > 0)) return detail;
  detail.threshold = hair_pixels / finest;
  // Slightly below 1, so that rounding in the shader never selects a hair that is not in the list.
  const float least = 0.999f / detail.threshold;
  const auto end = std::partition_point(hairs.begin(), hairs.end(),
                                        [&](const Hair& hair) { return detailKey(hair) >= least; });
  detail.hairs = static_cast<size_t>(end - hairs.begin());
  return detail;
}

double lengthKept(const StrandSet& strands, int pieces) {
  double chords = 0, arcs = 0;
  for (size_t s = 0; s < strands.strands(); ++s) {
    const auto points = strands.strand(s);
    const float length = arcLength(points);
    if (points.size() < 2 || !std::isfinite(length) || !(length > 0)) continue;
    arcs += length;
    Vec3 last = points.front();
    int piece = 1;
    float run = 0;
    for (size_t i = 1; i < points.size(); ++i) {
      const float edge = (points[i] - points[i - 1]).norm();
      for (; piece < pieces && run + edge >= length * static_cast<float>(piece) / static_cast<float>(pieces);
           ++piece) {
        const float part =
            (length * static_cast<float>(piece) / static_cast<float>(pieces) - run) / std::max(edge, 1e-12f);
        const Vec3 at = Vec3(points[i - 1] + part * (points[i] - points[i - 1]));
        chords += static_cast<double>((at - last).norm());
        last = at;
      }
      run += edge;
    }
    chords += static_cast<double>((points.back() - last).norm());
  }
  return arcs > 0 ? chords / arcs : 1;
}

int strideFor(float segment_pixels, float longest, int segments, int min_segments) {
  int stride = 1;
  while (2 * static_cast<float>(stride) * segment_pixels <= longest &&
         segments >= 2 * stride * std::max(min_segments, 1))
    stride *= 2;
  return stride;
}

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
                        hair.example_scale * example_reach + hair.reach;
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
