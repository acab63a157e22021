#include "groom/neighbors.h"

#include <algorithm>

namespace strandcast {

RootTree::RootTree(const std::vector<Vec3>& roots, std::vector<uint32_t> members)
    : roots_(roots), order_(std::move(members)) {
  build(0, order_.size(), 0);
}

std::vector<uint32_t> RootTree::nearest(const Vec3& center, size_t count, uint32_t except) const {
  Search found{center, count, except, {}};
  search(0, order_.size(), 0, found);
  std::sort_heap(found.heap.begin(), found.heap.end());
  std::vector<uint32_t> members;
  for (const auto& entry : found.heap) members.push_back(entry.second);
  return members;
}

void RootTree::build(size_t first, size_t last, int axis) {
  if (last - first < 2) return;
  const size_t middle = (first + last) / 2;
  // Ties are broken by index, so that the tree is the same on all platforms.
  std::nth_element(order_.begin() + first, order_.begin() + middle, order_.begin() + last,
                   [&](uint32_t a, uint32_t b) {
                     return roots_[a][axis] != roots_[b][axis] ? roots_[a][axis] < roots_[b][axis] : a < b;
                   });
  build(first, middle, (axis + 1) % 3);
  build(middle + 1, last, (axis + 1) % 3);
}

void RootTree::search(size_t first, size_t last, int axis, Search& found) const {
  if (first >= last) return;
  auto& heap = found.heap;
  const size_t middle = (first + last) / 2;
  const uint32_t here = order_[middle];
  if (here != found.except) {
    heap.emplace_back((roots_[here] - found.center).squaredNorm(), here);
    std::push_heap(heap.begin(), heap.end());
    if (heap.size() > found.count) {
      std::pop_heap(heap.begin(), heap.end());
      heap.pop_back();
    }
  }
  const float offset = found.center[axis] - roots_[here][axis];
  const int next = (axis + 1) % 3;
  const auto near_side = offset < 0 ? std::pair{first, middle} : std::pair{middle + 1, last};
  const auto far_side = offset < 0 ? std::pair{middle + 1, last} : std::pair{first, middle};
  search(near_side.first, near_side.second, next, found);
  if (heap.size() < found.count || offset * offset < heap.front().first)
    search(far_side.first, far_side.second, next, found);
}

StrandCourse courseOf(std::span<const Vec3> points) {
  const size_t quarter = std::min(std::max<size_t>(1, points.size() / 4), points.size() - 1);
  const Vec3 start = points[quarter] - points.front();
  const Vec3 whole = points.back() - points.front();
  return {start.normalized(), whole.normalized(), arcLength(points)};
}

bool isParting(const StrandCourse& a, const StrandCourse& b) {
  constexpr float kMinAlike = 0.5f;  // cosine between directions
  constexpr float kMaxLengthRatio = 3;
  const bool are_alike = a.start.dot(b.start) > kMinAlike && a.whole.dot(b.whole) > kMinAlike &&
                         a.length < kMaxLengthRatio * b.length && b.length < kMaxLengthRatio * a.length;
  return !are_alike;
}

}  // namespace strandcast
