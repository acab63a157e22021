#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>

#include "core/error.h"
#include "groom/clean.h"
#include "io/strand_edit.h"

namespace strandcast {
namespace {

/// Roots sorted into the cells of a uniform grid, with about as many cells as roots.
class RootGrid {
 public:
  explicit RootGrid(const StrandSet& strands) {
    Box bounds;
    roots_.reserve(strands.strands());
    for (size_t s = 0; s < strands.strands(); ++s) {
      roots_.push_back(strands.strand(s).front());
      bounds.extend(Eigen::Vector3f(roots_.back()));
    }
    const Eigen::Vector3f extent = bounds.sizes();
    const float longest = std::max(extent.maxCoeff(), std::numeric_limits<float>::min());
    // A flat scalp has no third extent. A floor of a hundredth of the longest extent keeps the cells from
    // vanishing.
    const Eigen::Vector3f padded = extent.cwiseMax(0.01f * longest);
    cell_ = std::max(longest * std::cbrt(padded.x() / longest * (padded.y() / longest) *
                                         (padded.z() / longest) / static_cast<float>(roots_.size())),
                     longest / 512);
    origin_ = bounds.min();
    for (int axis = 0; axis < 3; ++axis) size_[axis] = static_cast<int>(extent[axis] / cell_) + 1;
    sortIntoCells();
  }

  const Vec3& root(uint32_t s) const { return roots_[s]; }
  size_t size() const { return roots_.size(); }

  /// Calls visit(strand) for each root that may be nearer than `radius` to `center`.
  template <class Visit>
  void visitNear(const Vec3& center, float radius, Visit visit) const {
    int low[3], high[3];
    for (int axis = 0; axis < 3; ++axis) {
      const float place = center[axis] - origin_[axis];
      low[axis] = clampedCell((place - radius) / cell_, axis);
      high[axis] = clampedCell((place + radius) / cell_, axis);
    }
    for (int z = low[2]; z <= high[2]; ++z)
      for (int y = low[1]; y <= high[1]; ++y)
        for (uint32_t i = starts_[index(low[0], y, z)]; i < starts_[index(high[0], y, z) + 1]; ++i)
          visit(sorted_[i]);
  }

 private:
  int clampedCell(float place, int axis) const {
    return static_cast<int>(std::clamp(place, 0.0f, static_cast<float>(size_[axis] - 1)));
  }
  size_t index(int x, int y, int z) const { return (static_cast<size_t>(z) * size_[1] + y) * size_[0] + x; }
  size_t cellOf(const Vec3& point) const {
    int cell[3];
    for (int axis = 0; axis < 3; ++axis)
      cell[axis] = clampedCell((point[axis] - origin_[axis]) / cell_, axis);
    return index(cell[0], cell[1], cell[2]);
  }
  void sortIntoCells() {
    starts_.assign(static_cast<size_t>(size_[0]) * size_[1] * size_[2] + 1, 0);
    for (const Vec3& root : roots_) ++starts_[cellOf(root) + 1];
    for (size_t c = 1; c < starts_.size(); ++c) starts_[c] += starts_[c - 1];
    std::vector<uint32_t> next(starts_.begin(), starts_.end() - 1);
    sorted_.resize(roots_.size());
    for (uint32_t s = 0; s < roots_.size(); ++s) sorted_[next[cellOf(roots_[s])]++] = s;
  }

  std::vector<Vec3> roots_;
  std::vector<uint32_t> starts_, sorted_;
  Vec3 origin_ = Vec3::Zero();
  float cell_ = 1;
  int size_[3] = {1, 1, 1};
};

/// The strand whose root is farthest from the centre of all roots; of equals, the lowest index.
uint32_t outermostRoot(const RootGrid& grid) {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  for (uint32_t s = 0; s < grid.size(); ++s) center += grid.root(s).cast<double>();
  center /= static_cast<double>(grid.size());
  uint32_t best = 0;
  double best_distance = -1;
  for (uint32_t s = 0; s < grid.size(); ++s) {
    const double distance = (grid.root(s).cast<double>() - center).squaredNorm();
    if (distance <= best_distance) continue;
    best_distance = distance;
    best = s;
  }
  return best;
}

}  // namespace

// Farthest point sampling (Gonzalez 1985). A new guide changes the distance only of roots nearer to it than
// the largest remaining distance. So each guide visits only the grid cells in that radius, not all roots.
std::vector<uint32_t> chooseGuides(const StrandSet& strands, size_t count) {
  std::vector<uint32_t> chosen;
  if (count == 0 || strands.strands() == 0) return chosen;
  if (count >= strands.strands()) {
    for (uint32_t s = 0; s < strands.strands(); ++s) chosen.push_back(s);
    return chosen;
  }
  const RootGrid grid(strands);
  constexpr float kChosen = -1;
  std::vector<float> distance(grid.size(), std::numeric_limits<float>::max());

  // Distances only shrink, so an entry of the queue is an upper bound. The first entry that is still current
  // is the largest distance.
  struct Candidate {
    float distance;
    uint32_t strand;
    bool operator<(const Candidate& other) const {
      return distance != other.distance ? distance < other.distance : strand > other.strand;
    }
  };
  const auto choose = [&](uint32_t guide, float reach) {
    chosen.push_back(guide);
    distance[guide] = kChosen;
    grid.visitNear(grid.root(guide), reach, [&](uint32_t s) {
      distance[s] = std::min(distance[s], (grid.root(s) - grid.root(guide)).norm());
    });
    distance[guide] = kChosen;
  };
  choose(outermostRoot(grid), std::numeric_limits<float>::max());
  std::vector<Candidate> all;
  all.reserve(grid.size());
  for (uint32_t s = 0; s < grid.size(); ++s) all.push_back({distance[s], s});
  std::priority_queue<Candidate> queue({}, std::move(all));
  while (chosen.size() < count) {
    const Candidate candidate = queue.top();
    queue.pop();
    const float now = distance[candidate.strand];
    if (now == candidate.distance && now != kChosen)
      choose(candidate.strand, now);
    else if (now != kChosen)
      queue.push({now, candidate.strand});
  }
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

StrandSet subset(const StrandSet& strands, const std::vector<uint32_t>& chosen) {
  StrandSet result;
  for (const uint32_t s : chosen) {
    if (s >= strands.strands())
      throw Error(fmt::format("unknown strand {}", s),
                  fmt::format("a groom of {} strands", strands.strands()), "choose strands of this groom");
    appendStrand(result, strands, s);
  }
  return result;
}

}  // namespace strandcast
