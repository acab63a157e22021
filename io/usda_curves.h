#pragma once
#include <array>
#include <cstddef>
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

}  // namespace strandcast
