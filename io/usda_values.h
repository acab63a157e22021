#pragma once
#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "io/usda_primvar.h"

namespace strandcast {

/// Values of a primvar over the curves of a prim. Unusable values (not finite, or without a valid index) are
/// replaced.
template <class Value>
struct UsdaValues {
  std::optional<UsdaPrimvar::Interpolation> how;  ///< none if there are no values
  std::vector<Value> values;  ///< one in all, or one per curve, varying value or point, by `how`
  bool guessed = false;       ///< `how` was deduced from the count of values
  size_t mended = 0;          ///< number of values replaced
  std::string fault;          ///< why there are no values although the file has some; else empty

  /// Value at a point of a curve (index over all curves); `nothing` for varying values, which points do not
  /// have.
  Value ofControl(size_t curve, size_t point, const Value& nothing) const {
    using Interpolation = UsdaPrimvar::Interpolation;
    if (!how || how == Interpolation::kVarying) return nothing;
    return values[how == Interpolation::kConstant ? 0 : how == Interpolation::kUniform ? curve : point];
  }
  /// For varying values: the value at a vertex of the curve whose first varying value is `first`.
  Value varying(size_t first, const UsdaCurves::Vertex& vertex) const {
    const Value& before = values[first + vertex.segment];
    if (vertex.fraction == 0) return before;
    return (1 - vertex.fraction) * before + vertex.fraction * values[first + vertex.segment + 1];
  }
};

/// In units of the prim, not negative. Unusable values are replaced by the mean of the others.
using UsdaWidths = UsdaValues<double>;
/// Unusable values are replaced by (0, 0).
using UsdaUvs = UsdaValues<Eigen::Vector2d>;

/// Names of the properties that may hold widths or UVs, in order of preference. The first usable property is
/// read.
const std::vector<std::string>& usdaWidthNames();
const std::vector<std::string>& usdaUvNames();

/// Widths and UVs of a prim of curves. `prim`: index into UsdaStage::prims.
UsdaWidths usdaWidthsOf(const UsdaStage& stage, size_t prim, const UsdaCurves& curves);
UsdaUvs usdaUvsOf(const UsdaStage& stage, size_t prim, const UsdaCurves& curves);

}  // namespace strandcast
