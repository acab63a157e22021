#include "io/strand_edit.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

#include "core/error.h"

namespace strandcast {

void appendStrandValues(StrandSet& to, const StrandSet& from, size_t s) {
  const auto append = [s](auto& values, const auto& all) {
    if (!all.empty()) values.push_back(all[s]);
  };
  append(to.uvs, from.uvs);
  append(to.parts, from.parts);
  append(to.ids, from.ids);
  append(to.is_guide, from.is_guide);
  append(to.groups, from.groups);
  append(to.colours, from.colours);
}

void appendStrand(StrandSet& to, const StrandSet& from, size_t s, std::span<const uint32_t> vertices) {
  const uint32_t first = from.offsets[s];
  for (const uint32_t v : vertices) {
    to.positions.push_back(from.positions[first + v]);
    if (!from.pinned.empty()) to.pinned.push_back(from.pinned[first + v]);
    if (!from.radii.empty()) to.radii.push_back(from.radii[first + v]);
  }
  appendStrandValues(to, from, s);
  to.offsets.push_back(static_cast<uint32_t>(to.positions.size()));
}

void appendStrand(StrandSet& to, const StrandSet& from, size_t s) {
  const auto begin = static_cast<std::ptrdiff_t>(from.offsets[s]);
  const auto end = static_cast<std::ptrdiff_t>(from.offsets[s + 1]);
  to.positions.insert(to.positions.end(), from.positions.begin() + begin, from.positions.begin() + end);
  if (!from.pinned.empty())
    to.pinned.insert(to.pinned.end(), from.pinned.begin() + begin, from.pinned.begin() + end);
  if (!from.radii.empty())
    to.radii.insert(to.radii.end(), from.radii.begin() + begin, from.radii.begin() + end);
  appendStrandValues(to, from, s);
  to.offsets.push_back(static_cast<uint32_t>(to.positions.size()));
}

void removeNonFinite(StrandSet& strands, FileReport& report, const std::string& where) {
  const auto isFinite = [&](size_t s) {
    const std::span<const Vec3> points = std::as_const(strands).strand(s);
    return std::all_of(points.begin(), points.end(), [](const Vec3& p) { return p.allFinite(); });
  };
  size_t dropped = 0;
  for (size_t s = 0; s < strands.strands(); ++s) dropped += isFinite(s) ? 0 : 1;
  if (dropped == 0) return;
  if (dropped == strands.strands())
    throw Error("no strand has positions that are all finite", where,
                "the file is damaged, export or copy it again");
  StrandSet kept;
  for (size_t s = 0; s < strands.strands(); ++s)
    if (isFinite(s)) appendStrand(kept, strands, s);
  strands = std::move(kept);
  report.addOmission(
      fmt::format("{} strand{} with a position that is not finite", dropped, dropped == 1 ? "" : "s"));
}

float medianLength(const StrandSet& strands) {
  std::vector<float> lengths;
  lengths.reserve(strands.strands());
  for (size_t s = 0; s < strands.strands(); ++s)
    if (strands.verticesOf(s) >= 2) lengths.push_back(arcLength(strands.strand(s)));
  if (lengths.empty()) return 0;
  const auto middle = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2);
  std::nth_element(lengths.begin(), middle, lengths.end());
  return *middle;
}

}  // namespace strandcast
