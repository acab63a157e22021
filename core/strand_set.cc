#include "core/strand_set.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "core/error.h"

namespace strandcast {

void StrandSet::append(std::span<const Vec3> points) {
  positions.insert(positions.end(), points.begin(), points.end());
  offsets.push_back(static_cast<uint32_t>(positions.size()));
}

void checkStrandSet(const StrandSet& strands, const std::string& where) {
  const auto require = [&](bool holds, const char* what, const char* remedy) {
    if (!holds) throw Error(what, where, remedy);
  };
  const std::vector<uint32_t>& offsets = strands.offsets;
  require(!offsets.empty() && offsets.front() == 0 && offsets.back() == strands.vertices(),
          "the groom's offsets do not fit its positions", "the first is 0, the last the number of positions");
  require(std::adjacent_find(offsets.begin(), offsets.end(), std::greater_equal<>()) == offsets.end(),
          "the groom's offsets do not increase", "every strand has a vertex");
  const auto fits = [](size_t size, size_t expected) { return size == 0 || size == expected; };
  require(
      fits(strands.pinned.size(), strands.vertices()) && fits(strands.radii.size(), strands.vertices()) &&
          fits(strands.uvs.size(), strands.strands()) && fits(strands.parts.size(), strands.strands()) &&
          fits(strands.ids.size(), strands.strands()) && fits(strands.is_guide.size(), strands.strands()) &&
          fits(strands.groups.size(), strands.strands()) && fits(strands.colours.size(), strands.strands()),
      "an array of the groom has the wrong length", "leave it empty, or one entry per vertex or strand");
  const auto is_finite = [](const auto& vector) { return vector.allFinite(); };
  require(
      std::all_of(strands.positions.begin(), strands.positions.end(), is_finite) &&
          std::all_of(strands.uvs.begin(), strands.uvs.end(), is_finite) &&
          std::all_of(strands.colours.begin(), strands.colours.end(), is_finite) &&
          std::all_of(strands.radii.begin(), strands.radii.end(), [](float r) { return std::isfinite(r); }),
      "the groom has a number that is not finite", "clean the groom first");
  require(std::all_of(strands.radii.begin(), strands.radii.end(), [](float r) { return r >= 0; }),
          "the groom has a negative radius", "give 0 or more, or no radii");
  require(std::all_of(strands.colours.begin(), strands.colours.end(),
                      [](const Vec3& colour) { return colour.minCoeff() >= 0; }),
          "the groom has a negative colour", "give 0 or more, or no colours");
}

float arcLength(std::span<const Vec3> points) {
  float length = 0;
  for (size_t i = 1; i < points.size(); ++i) length += (points[i] - points[i - 1]).norm();
  return length;
}

}  // namespace strandcast
