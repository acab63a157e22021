#include "groom/groom_operations.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>
#include <vector>

#include "core/error.h"
#include "core/strand_block.h"
#include "core/strand_model.h"
#include "io/strand_edit.h"

namespace strandcast {
namespace {

/// Partition of a strand into runs of vertices that lie too near each other. Each run becomes one vertex.
struct Runs {
  std::vector<uint32_t> first;  ///< first vertex of each run
  std::vector<uint32_t> kept;   ///< vertex of the run that stays: its first one; in the last run the tip
};

void findRuns(std::span<const Vec3> points, Runs& runs) {
  const float length = arcLength(points);
  size_t before, now = points.size();
  do {  // removing vertices lengthens the mean edge and so raises the threshold
    before = now;
    const float nearest = kShortestEdge * length / (static_cast<float>(before) - 1);
    auto apart = [&](size_t a, size_t b) { return (points[a] - points[b]).norm() > nearest; };
    std::vector<uint32_t>& first = runs.first;
    first.clear();
    for (uint32_t i = 0; i < points.size(); ++i)
      if (i == 0 || apart(i, first.back())) first.push_back(i);
    while (first.size() > 1 && !apart(points.size() - 1, first[first.size() - 2])) first.pop_back();
    now = first.size();
  } while (now < before);
  runs.kept = runs.first;
  if (runs.kept.size() > 1) runs.kept.back() = static_cast<uint32_t>(points.size() - 1);
}

/// Moves the pin of a vertex that is merged away to the vertex that stays.
void transferPinsOfRemoved(StrandSet& strands, size_t s, const Runs& runs) {
  if (strands.pinned.empty()) return;
  uint8_t* pinned = strands.pinned.data() + strands.offsets[s];
  size_t run = 0;
  for (uint32_t i = 0; i < strands.verticesOf(s); ++i) {
    if (run + 1 < runs.first.size() && runs.first[run + 1] == i) ++run;
    if (pinned[i]) pinned[runs.kept[run]] = 1;
  }
}

/// One pass of merging and dropping. `median`: median length that sets the scale.
void mergeAndDrop(Groom& groom, float median) {
  StrandSet cleaned;
  Runs runs;
  for (size_t s = 0; s < groom.strands.strands(); ++s) {
    const std::span<const Vec3> points = groom.strands.strand(s);
    findRuns(points, runs);
    const float length = arcLength(points);
    if (runs.kept.size() < kMinVerticesPerStrand || !(length > 0) || length < kShortestOfMedian * median) {
      ++groom.report.dropped_short;
      continue;
    }
    groom.report.duplicate_vertices += points.size() - runs.kept.size();
    transferPinsOfRemoved(groom.strands, s, runs);
    appendStrand(cleaned, groom.strands, s, runs.kept);
  }
  groom.strands = std::move(cleaned);
}

size_t countBothEndsPinned(const StrandSet& strands) {
  size_t count = 0;
  for (size_t s = 0; s < strands.strands(); ++s)
    if (strands.verticesOf(s) >= 2 && strands.isPinned(s, strands.verticesOf(s) - 1)) ++count;
  return count;
}

/// Reverses strand `s` in place, pins included. The former root stays pinned only if the other end was pinned
/// as well: then the file pins both ends, else it pins whatever vertex comes first.
void reverseStrand(StrandSet& strands, size_t s) {
  const std::span<Vec3> points = strands.strand(s);
  std::reverse(points.begin(), points.end());
  const auto first = static_cast<std::ptrdiff_t>(strands.offsets[s]);
  const auto last = static_cast<std::ptrdiff_t>(strands.offsets[s + 1]);
  if (!strands.radii.empty()) std::reverse(strands.radii.begin() + first, strands.radii.begin() + last);
  if (strands.pinned.empty()) return;
  const auto begin = strands.pinned.begin() + first, end = strands.pinned.begin() + last;
  std::reverse(begin, end);
  if (*begin == 0) {
    for (auto pin = end; pin != begin && *(pin - 1) != 0; --pin) *(pin - 1) = 0;
    *begin = 1;
  }
}

}  // namespace

void cleanStrands(Groom& groom) {
  if (groom.report.strands_read == 0) groom.report.strands_read = groom.strands.strands();
  const float median = medianLength(groom.strands);
  mergeAndDrop(groom, median);
  size_t too_many = 0;
  for (size_t s = 0; s < groom.strands.strands(); ++s)
    if (groom.strands.verticesOf(s) > kMaxVerticesPerStrand) ++too_many;
  if (too_many > 0) {
    StrandSet capped;
    for (size_t s = 0; s < groom.strands.strands(); ++s) {
      StrandSet one;
      appendStrand(one, groom.strands, s);
      if (one.vertices() > kMaxVerticesPerStrand) one = equalize(one, kMaxVerticesPerStrand);
      appendStrand(capped, one, 0);
    }
    groom.strands = std::move(capped);
    groom.report.resampled += too_many;
    // A strand that runs back along itself may have got two coincident vertices.
    mergeAndDrop(groom, median);
  }
  groom.report.both_ends_pinned = countBothEndsPinned(groom.strands);
}

void orientRoots(Groom& groom, const ClosestPoint& scalp) {
  constexpr float kNearerByLength = 0.5f;
  StrandSet& strands = groom.strands;
  for (size_t s = 0; s < strands.strands(); ++s) {
    const std::span<const Vec3> points = strands.strand(s);
    if (points.size() < 2) continue;
    const float root_distance = scalp(points.front()).distance;
    const float tip_distance = scalp(points.back()).distance;
    if (!(root_distance - tip_distance > kNearerByLength * arcLength(points))) continue;
    reverseStrand(strands, s);
    ++groom.report.reversed;
  }
}

RootBinding bindRoots(const StrandSet& strands, const ClosestPoint& scalp) {
  RootBinding binding;
  binding.roots.reserve(strands.strands());
  double sum = 0;
  for (size_t s = 0; s < strands.strands(); ++s) {
    binding.roots.push_back(scalp(strands.strand(s).front()));
    const float distance = binding.roots.back().distance;
    sum += distance;
    binding.max_distance = std::max(binding.max_distance, distance);
  }
  if (!binding.roots.empty())
    binding.mean_distance = static_cast<float>(sum / static_cast<double>(binding.roots.size()));
  return binding;
}

namespace {

/// A strand and the positions of its new vertices, as arc lengths from the root in m.
class EvenCut {
 public:
  void start(const StrandSet& strands, size_t s, size_t count) {
    points_ = strands.strand(s);
    at_.assign(points_.size(), 0.0);
    for (size_t i = 1; i < points_.size(); ++i) at_[i] = at_[i - 1] + (point(i) - point(i - 1)).norm();
    places_.assign(count, 0.0);
    computePlaces();
  }
  /// Arc length of new vertex `k`, m.
  double place(size_t k) const { return places_[k]; }
  /// Arc length of vertex `vertex` of the original strand, m.
  double at(size_t vertex) const { return at_[vertex]; }
  /// Index of the new vertex at an arc length; fractional between two vertices.
  double vertexAt(double place) const {
    const auto next = std::upper_bound(places_.begin(), places_.end(), place);
    if (next == places_.begin() || !(places_.back() > 0)) return 0;
    const auto k = static_cast<size_t>(next - places_.begin()) - 1;
    if (next == places_.end()) return static_cast<double>(places_.size() - 1);
    return static_cast<double>(k) + (place - places_[k]) / (places_[k + 1] - places_[k]);
  }

  /// A point on the original strand: an edge and the fraction along it, 0 to 1.
  struct OnEdge {
    size_t edge, end;
    double part;
  };
  OnEdge onEdge(double place) const {
    const auto next = std::lower_bound(at_.begin() + 1, at_.end(), place);
    const size_t end = std::min(static_cast<size_t>(next - at_.begin()), at_.size() - 1);
    const size_t edge = end > 0 ? end - 1 : 0;
    const double length = at_[end] - at_[edge];
    return {edge, end, length > 0 ? std::clamp((place - at_[edge]) / length, 0.0, 1.0) : 0.0};
  }
  Vec3 pointAt(const OnEdge& on) const {
    const Eigen::Vector3d a = point(on.edge), b = point(on.end);
    return (a + on.part * (b - a)).cast<float>();
  }

 private:
  Eigen::Vector3d point(size_t i) const { return points_[i].cast<double>(); }

  /// Places points `chord` apart in a straight line, one after another, each at the first such point of the
  /// polyline; beyond the tip the last edge is extended. Returns how far beyond the tip the last point lies,
  /// m.
  double march(double chord) {
    size_t edge = 0;
    Eigen::Vector3d from = point(0);
    for (size_t k = 1; k < places_.size(); ++k) {
      while (edge < last_edge_ && (point(edge + 1) - from).norm() < chord) ++edge;
      const Eigen::Vector3d start = point(edge), along = (point(edge + 1) - start).normalized();
      const double nearest = along.dot(from - start),
                   aside2 = (from - start).squaredNorm() - nearest * nearest;
      const double part = nearest + std::sqrt(std::max(chord * chord - aside2, 0.0));
      from = start + part * along;
      places_[k] = at_[edge] + part;
    }
    return places_.back() - at_.back();
  }

  /// Finds the chord with which march() ends at the tip, by false position (the Illinois rule; Dowell and
  /// Jarratt 1971, "A modified regula falsi method"). Returns false where there is none, as may be in a
  /// strand that returns to itself.
  bool marchToTip() {
    constexpr int kMaxMarches = 60;
    const double length = at_.back(), exact = 1e-10 * length;
    // The upper bound holds because a chord is the shortest path.
    double low = 0, high = length / static_cast<double>(places_.size() - 1);
    double below = -length, above = march(high);
    if (above <= exact) return true;
    for (int marches = 0, side = 0; marches < kMaxMarches; ++marches) {
      const double chord = (low * above - high * below) / (above - below), beyond = march(chord);
      if (std::abs(beyond) <= exact) return true;
      const int now = beyond > 0 ? 1 : -1;
      (now > 0 ? high : low) = chord;
      (now > 0 ? above : below) = beyond;
      if (now == side) (now > 0 ? below : above) /= 2;
      side = now;
    }
    return false;
  }
  void computePlaces() {
    const double length = at_.back();
    last_edge_ = 0;
    for (size_t e = 0; e + 1 < at_.size(); ++e)
      if (at_[e + 1] > at_[e]) last_edge_ = e;
    const auto last = static_cast<double>(std::max<size_t>(places_.size() - 1, 1));
    if (places_.size() < 3 || !(length > 0) || !marchToTip())
      for (size_t k = 0; k < places_.size(); ++k) places_[k] = length * static_cast<double>(k) / last;
    if (places_.size() > 1) places_.back() = length;
  }

  std::span<const Vec3> points_;
  std::vector<double> at_, places_;
  size_t last_edge_ = 0;  ///< the last edge of nonzero length
};

/// A new vertex is pinned if it lies between two pinned neighbours. In addition each pinned vertex pins the
/// new vertex nearest to it: an isolated pin would otherwise be lost between two samples.
void transferPins(const StrandSet& from, size_t s, const EvenCut& cut, std::span<uint8_t> pins) {
  const uint8_t* old_pins = from.pinned.data() + from.offsets[s];
  const size_t old_count = from.verticesOf(s);
  const auto last = static_cast<double>(pins.size() - 1);
  for (size_t i = 0; i < old_count; ++i) {
    if (!old_pins[i]) continue;
    const double place = cut.vertexAt(cut.at(i));
    pins[static_cast<size_t>(std::clamp(std::round(place), 0.0, last))] = 1;
    if (i + 1 == old_count || !old_pins[i + 1]) continue;
    for (double k = std::ceil(place); k <= std::min(cut.vertexAt(cut.at(i + 1)), last); ++k)
      pins[static_cast<size_t>(k)] = 1;
  }
}

void resampleStrand(const StrandSet& from, size_t s, size_t count, EvenCut& cut, StrandSet& to) {
  cut.start(from, s, count);
  const uint32_t first = from.offsets[s];
  for (size_t k = 0; k < count; ++k) {
    const EvenCut::OnEdge on = cut.onEdge(cut.place(k));
    Vec3 point = cut.pointAt(on);
    if (k == 0) point = from.strand(s).front();
    if (k + 1 == count && count > 1) point = from.strand(s).back();
    to.positions.push_back(point);
    if (!from.radii.empty()) {
      const float a = from.radii[first + on.edge], b = from.radii[first + on.end];
      to.radii.push_back(a + static_cast<float>(on.part) * (b - a));
    }
  }
  if (!from.pinned.empty()) {
    to.pinned.resize(to.positions.size(), 0);
    transferPins(from, s, cut, std::span(to.pinned).last(count));
  }
  appendStrandValues(to, from, s);
  to.offsets.push_back(static_cast<uint32_t>(to.positions.size()));
}

void checkCount(int vertices) {
  if (vertices < static_cast<int>(kMinVerticesPerStrand) ||
      vertices > static_cast<int>(kMaxVerticesPerStrand))
    throw Error(fmt::format("strands cannot have {} vertices", vertices), "resampling",
                fmt::format("choose {} to {}", kMinVerticesPerStrand, kMaxVerticesPerStrand));
}

template <class CountOf>
StrandSet resampleAll(const StrandSet& strands, CountOf count_of) {
  StrandSet result;
  EvenCut cut;
  for (size_t s = 0; s < strands.strands(); ++s) resampleStrand(strands, s, count_of(s), cut, result);
  return result;
}

}  // namespace

StrandSet resample(const StrandSet& strands, int vertices) {
  checkCount(vertices);
  return resampleAll(strands, [&](size_t) { return static_cast<size_t>(vertices); });
}

StrandSet equalize(const StrandSet& strands, int max_vertices) {
  checkCount(max_vertices);
  return resampleAll(
      strands, [&](size_t s) { return std::min(strands.verticesOf(s), static_cast<size_t>(max_vertices)); });
}

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
