#include "render/plausible_bounds.h"

#include <algorithm>
#include <vector>

namespace strandcast {
namespace {

constexpr float kFarthest = 1e3f;  // m

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
  return position.allFinite() && (position - middle_).cwiseAbs().maxCoeff() < kFarthest;
}

}  // namespace strandcast
