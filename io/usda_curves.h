// BasisCurves of a .usda stage: their points, primvars, widths, UVs and labels of strands.
#pragma once
#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/usda_stage.h"

namespace strandcast {

/// Division of the points of a BasisCurves prim into curves, and the number of values that a primvar has for
/// each interpolation. Source: UsdGeomBasisCurves of OpenUSD (its tables of "vertex" and "varying" sizes).
class UsdaCurves {
 public:
  /// Throws UsdaFault for an unsupported type, basis or wrap, and for counts that do not match the points.
  explicit UsdaCurves(const UsdaPrim& prim);

  size_t curves() const { return counts_.size(); }
  size_t points() const { return first_point_.back(); }
  size_t pointsOf(size_t curve) const { return counts_[curve]; }
  size_t firstPoint(size_t curve) const { return first_point_[curve]; }
  /// Number of varying values: one per end of a segment.
  size_t varyings() const { return first_varying_.back(); }
  size_t firstVarying(size_t curve) const { return first_varying_[curve]; }
  size_t varyingsOf(size_t curve) const { return first_varying_[curve + 1] - first_varying_[curve]; }
  /// Whether the curve has at least one edge and, if cubic, only whole segments.
  bool isWhole(size_t curve) const;

  bool isLinear() const { return linear_; }

  /// A vertex of a strand: a point on the curve. Linear curves give their points; cubic curves the ends of
  /// their segments. Segments of bezier curves have three points of their own, so their thirds are vertices,
  /// too.
  struct Vertex {
    size_t first;                   ///< of the four control points (one in a linear curve) that define it
    std::array<double, 4> weights;  ///< of these control points
    size_t segment;                 ///< index of the preceding varying value
    double fraction;                ///< 0 to 1, towards the next varying value
  };
  /// Calls give(Vertex) for each vertex of a whole curve. `count`: its points, including the phantom points
  /// that pin() adds.
  template <class Give>
  void forVertices(size_t count, const Give& give) const {
    if (linear_) {
      for (size_t i = 0; i < count; ++i) give(Vertex{i, {1, 0, 0, 0}, i, 0});
      return;
    }
    constexpr double kThird = 1.0 / 27;
    constexpr std::array<double, 4> kOneThird = {8 * kThird, 12 * kThird, 6 * kThird, kThird};
    constexpr std::array<double, 4> kTwoThirds = {kThird, 6 * kThird, 12 * kThird, 8 * kThird};
    const size_t step = stride();
    size_t segment = 0;
    for (size_t first = 0; first + 4 <= count; first += step, ++segment) {
      give(Vertex{first, beginWeights(), segment, 0});
      if (basis_ != Basis::kBezier) continue;
      give(Vertex{first, kOneThird, segment, 1.0 / 3});
      give(Vertex{first, kTwoThirds, segment, 2.0 / 3});
    }
    give(Vertex{count - 4, endWeights(), segment, 0});
  }
  /// Interpolates the values of the control points at a vertex.
  template <class Value>
  Value at(const std::vector<Value>& controls, const Vertex& vertex) const {
    if (linear_) return controls[vertex.first];
    const std::array<double, 4>& w = vertex.weights;
    return w[0] * controls[vertex.first] + w[1] * controls[vertex.first + 1] +
           w[2] * controls[vertex.first + 2] + w[3] * controls[vertex.first + 3];
  }
  /// Adds the phantom points with which a pinned curve reaches its first and last point.
  template <class Value>
  void pin(std::vector<Value>& controls) const {
    if (linear_ || !pinned_ || basis_ == Basis::kBezier || controls.size() < 2) return;
    const Value before = 2 * controls[0] - controls[1];
    const Value behind = 2 * controls.back() - controls[controls.size() - 2];
    controls.insert(controls.begin(), before);
    controls.push_back(behind);
  }

 private:
  enum class Basis { kBezier, kBspline, kCatmullRom };

  size_t stride() const { return basis_ == Basis::kBezier ? 3 : 1; }
  size_t varyingsFor(size_t count) const;
  std::array<double, 4> beginWeights() const;
  std::array<double, 4> endWeights() const;

  bool linear_ = false, pinned_ = false;
  Basis basis_ = Basis::kBezier;
  std::vector<size_t> counts_, first_point_ = {0}, first_varying_ = {0};
};

/// Values of one primvar (or of a property that is read like one, as `widths`) over the curves of a prim.
class UsdaPrimvar {
 public:
  enum class Interpolation { kConstant, kUniform, kVarying, kVertex };
  enum class Kind { kNumbers, kStrings };

  /// Finds the primvar `name` on the prim or, if constant, on the nearest ancestor that has it. None where
  /// there is no value. A primvar without interpolation has `otherwise`; where its count of values does not
  /// match that, it has the first interpolation that the count matches (guessed() is then true). Throws
  /// UsdaFault when the interpolation does not exist for curves, or the values do not match it or are not of
  /// the kind.
  static std::optional<UsdaPrimvar> of(const UsdaStage& stage, size_t prim, const std::string& name,
                                       const UsdaCurves& curves, Interpolation otherwise,
                                       Kind kind = Kind::kNumbers);

  Interpolation interpolation() const { return interpolation_; }
  bool guessed() const { return guessed_; }
  /// Number of values for the curves of the prim.
  size_t elements() const { return elements_; }
  /// Numbers per value: those of its type times `elementSize`.
  size_t components() const { return components_; }
  /// Numbers of one value. `element` is 0 for a constant primvar, else the index of the curve, varying value
  /// or point. Empty where its index is the unauthored one or out of range.
  std::span<const double> at(size_t element) const;
  /// The string of one value, likewise; null in place of empty.
  const std::string* stringAt(size_t element) const;

 private:
  UsdaPrimvar() = default;
  /// Index among the stored values.
  std::optional<size_t> stored(size_t element) const;
  void choose(const UsdaProperty& property, const UsdaCurves& curves, Interpolation otherwise);

  Interpolation interpolation_ = Interpolation::kConstant;
  bool guessed_ = false;
  size_t components_ = 1, elements_ = 1, stored_ = 0;
  std::span<const double> values_, indices_;
  std::span<const std::string> strings_;
  bool indexed_ = false;
  double unauthored_ = -1;
};

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
  /// The values of a curve from its root on: one where they are constant or uniform. Precondition: `how`.
  std::span<const Value> of(const UsdaCurves& curves, size_t curve) const {
    using Interpolation = UsdaPrimvar::Interpolation;
    const std::span<const Value> all(values);
    if (how == Interpolation::kVarying)
      return all.subspan(curves.firstVarying(curve), curves.varyingsOf(curve));
    if (how == Interpolation::kVertex) return all.subspan(curves.firstPoint(curve), curves.pointsOf(curve));
    return all.subspan(how == Interpolation::kConstant ? 0 : curve, 1);
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

/// Names of all properties that may hold the values below.
std::vector<std::string> usdaValueNames();

/// Widths and UVs of a prim of curves. `prim`: index into UsdaStage::prims. Of several properties that may
/// hold them the first usable one is read.
UsdaWidths usdaWidthsOf(const UsdaStage& stage, size_t prim, const UsdaCurves& curves);
UsdaUvs usdaUvsOf(const UsdaStage& stage, size_t prim, const UsdaCurves& curves);

/// Labels of the strands of a prim of curves, under the names that Unreal's grooms have, with or without
/// "primvars:". One unusable id or group id makes all those of the prim unusable.
/// https://dev.epicgames.com/documentation/unreal-engine/using-alembic-for-grooms-in-unreal-engine
struct UsdaLabels {
  static constexpr size_t kLongestName = 255;

  UsdaValues<double> ids;        ///< whole, 0 to 2^32 - 1
  UsdaValues<double> guides;     ///< 0 or 1 (a guide); unusable values are replaced by 0
  UsdaValues<double> group_ids;  ///< whole, -2^31 to 2^31 - 1
  /// Views of the stage, with their escapes; at most kLongestName bytes without. Unusable values are replaced
  /// by "".
  UsdaValues<std::string_view> group_names;
  /// groom_color or displayColor: linear RGB, 0 or more, within the range of a float. Unusable values are
  /// replaced by the mean of the others.
  UsdaValues<Eigen::Vector3d> colours;
};
UsdaLabels usdaLabelsOf(const UsdaStage& stage, size_t prim, const UsdaCurves& curves);

}  // namespace strandcast
