#include "groom/groom.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "io/strand_edit.h"

namespace strandcast {

std::vector<std::string> GroomReport::lines() const {
  std::vector<std::string> out;
  auto add = [&](size_t count, const char* what) {
    if (count > 0) out.push_back(fmt::format("{} {}", count, what));
  };
  add(dropped_short, "strands dropped: too short to simulate");
  add(duplicate_vertices, "vertices merged into their neighbours, which were too near");
  add(reversed, "strands reversed: their tip was at the scalp");
  add(both_ends_pinned, "strands are pinned at both ends");
  add(resampled, "strands resampled");
  if (!left_out.empty()) out.push_back(fmt::format("read without {}", fmt::join(left_out, ", ")));
  return out;
}

GroomSummary summarize(const StrandSet& strands) {
  GroomSummary summary;
  summary.strands = strands.strands();
  summary.vertices = strands.vertices();
  if (summary.strands == 0) return summary;
  summary.median_length = medianLength(strands);
  summary.min_vertices = std::numeric_limits<size_t>::max();
  summary.min_length = std::numeric_limits<float>::max();
  for (size_t s = 0; s < strands.strands(); ++s) {
    const size_t count = strands.verticesOf(s);
    const float length = arcLength(strands.strand(s));
    summary.min_vertices = std::min(summary.min_vertices, count);
    summary.max_vertices = std::max(summary.max_vertices, count);
    summary.min_length = std::min(summary.min_length, length);
    summary.max_length = std::max(summary.max_length, length);
    if (count < 2 || !(length > 0) || length < kShortestOfMedian * summary.median_length)
      ++summary.degenerate_strands;
  }
  for (const Vec3& point : strands.positions) summary.bounds.extend(Eigen::Vector3f(point));
  return summary;
}

}  // namespace strandcast
