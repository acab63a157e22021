#include "io/usda_curves.h"

#include <fmt/format.h>

#include <cmath>

namespace strandcast {
UsdaCurves::UsdaCurves(const UsdaPrim& prim) {
  const auto fail = [&](const std::string& what) { throw UsdaFault{what, prim.line}; };
  const std::string type = prim.token("type", "cubic"), basis = prim.token("basis", "bezier"),
                    wrap = prim.token("wrap", "nonperiodic");
  linear_ = type == "linear";
  if (type != "cubic" && !linear_) fail(fmt::format("curves of type {:?} are not known", type));
  if (basis == "bspline")
    basis_ = Basis::kBspline;
  else if (basis == "catmullRom")
    basis_ = Basis::kCatmullRom;
  else if (basis != "bezier" && !linear_)
    fail(fmt::format("curves of basis {:?} are not read", basis));
  if (wrap == "periodic") fail("its curves are closed, hair has a root and a tip");
  pinned_ = wrap == "pinned";
  if (!pinned_ && wrap != "nonperiodic") fail(fmt::format("curves of wrap {:?} are not known", wrap));

  const UsdaProperty* points = prim.find("points");
  const UsdaProperty* counts = prim.find("curveVertexCounts");
  for (const std::string_view name : {"points", "curveVertexCounts"})
    if (const UsdaProperty* property = prim.find(name); property != nullptr && !property->misfit.empty())
      throw UsdaFault{fmt::format("{} {}", name, property->misfit), property->line};
  const size_t numbers = points == nullptr ? 0 : points->numbers.size();
  const auto most = static_cast<double>(numbers / 3);
  double sum = 0;
  if (counts != nullptr)
    for (const double count : counts->numbers) {
      sum += count;
      if (!(count >= 0) || count != std::floor(count) || sum > most)
        fail("curveVertexCounts has a number that is no count of its points");
      counts_.push_back(static_cast<size_t>(count));
      first_point_.push_back(first_point_.back() + counts_.back());
      first_varying_.push_back(first_varying_.back() + varyingsFor(counts_.back()));
    }
  if (numbers != 3 * first_point_.back())
    fail(fmt::format("it has {} numbers for the {} points of its curves", numbers, first_point_.back()));
}

size_t UsdaCurves::varyingsFor(size_t count) const {
  if (linear_) return count;
  if (pinned_ && basis_ != Basis::kBezier) return (count > 2 ? count - 2 : 0) + 2;
  return (count > 4 ? count - 4 : 0) / stride() + 2;
}

bool UsdaCurves::isWhole(size_t curve) const {
  const size_t count = counts_[curve];
  if (linear_ || (pinned_ && basis_ != Basis::kBezier)) return count >= 2;
  return count >= 4 && (count - 4) % stride() == 0;
}

std::array<double, 4> UsdaCurves::beginWeights() const {
  if (basis_ == Basis::kBezier) return {1, 0, 0, 0};
  if (basis_ == Basis::kBspline) return {1.0 / 6, 4.0 / 6, 1.0 / 6, 0};
  return {0, 1, 0, 0};
}
std::array<double, 4> UsdaCurves::endWeights() const {
  if (basis_ == Basis::kBezier) return {0, 0, 0, 1};
  if (basis_ == Basis::kBspline) return {0, 1.0 / 6, 4.0 / 6, 1.0 / 6};
  return {0, 0, 1, 0};
}

}  // namespace strandcast
