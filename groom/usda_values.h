#pragma once
#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "groom/usda_primvar.h"

namespace strandcast {

/// The values of a primvar over the curves of a prim. A value that cannot be used (without a valid index, not
/// finite) is mended.
template <class Value>
struct UsdaValues {
  std::optional<UsdaPrimvar::Interpolation> how;  ///< none where there are none
  std::vector<Value> values;                      ///< one, or one a curve, a varying or a point, by `how`
  bool guessed = false;                           ///< the count of values told `how`
  size_t mended = 0;
  std::string fault;  ///< why there are none, where the file has some; else empty

  /// At a point of a curve (index over all curves). Varying values, which points do not have, give `nothing`.
  Value ofControl(size_t curve, size_t point, const Value& nothing) const {
    using Interpolation = UsdaPrimvar::Interpolation;
    if (!how || how == Interpolation::kVarying) return nothing;
    return values[how == Interpolation::kConstant ? 0 : how == Interpolation::kUniform ? curve : point];
  }
  /// Of varying values, that at a vertex of the curve whose first varying is `first`.
  Value varying(size_t first, const UsdaCurves::Vertex& vertex) const {
    const Value& before = values[first + vertex.segment];
    if (vertex.fraction == 0) return before;
    return (1 - vertex.fraction) * before + vertex.fraction * values[first + vertex.segment + 1];
  }
};

/// In units of the prim, not negative; mended ones are the mean of the others.
using UsdaWidths = UsdaValues<double>;
/// Mended ones are (0, 0).
using UsdaUvs = UsdaValues<Eigen::Vector2d>;

/// The properties that may hold them. The first that can be used is.
const std::vector<std::string>& usdaWidthNames();
const std::vector<std::string>& usdaUvNames();

UsdaWidths usdaWidthsOf(const UsdaStage& stage, size_t prim, const UsdaCurves& curves);
UsdaUvs usdaUvsOf(const UsdaStage& stage, size_t prim, const UsdaCurves& curves);

}  // namespace strandcast
