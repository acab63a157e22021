#include "groom/clean.h"

#include <algorithm>
#include <vector>

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
void handOverPins(StrandSet& strands, size_t s, const Runs& runs) {
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
    handOverPins(groom.strands, s, runs);
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

}  // namespace strandcast
