#pragma once
#include <array>
#include <cstddef>
#include <vector>

#include "groom/usda_stage.h"

namespace strandcast {

/// How the points of a BasisCurves prim make curves, and how many values a primvar has of each
/// interpolation. Source: UsdGeomBasisCurves of OpenUSD (its tables of "vertex" and "varying" sizes).
class UsdaCurves {
 public:
  /// Throws UsdaFault for a type, basis or wrap that is not read, and for counts that do not fit the points.
  explicit UsdaCurves(const UsdaPrim& prim);

  size_t curves() const { return counts_.size(); }
  size_t points() const { return first_point_.back(); }
  size_t pointsOf(size_t curve) const { return counts_[curve]; }
  size_t firstPoint(size_t curve) const { return first_point_[curve]; }
  /// Varying values are those of the ends of segments.
  size_t varyings() const { return first_varying_.back(); }
  size_t firstVarying(size_t curve) const { return first_varying_[curve]; }
  size_t varyingsOf(size_t curve) const { return first_varying_[curve + 1] - first_varying_[curve]; }
  /// Whether the curve has an edge at least, and a cubic one whole segments.
  bool isWhole(size_t curve) const;

  bool isLinear() const { return linear_; }

  /// A vertex of a strand: a place on the curve. Linear curves give their points, cubic ones the ends of
  /// their segments, bezier curves, whose segments have three points of their own, their thirds too.
  struct Vertex {
    size_t first;                   ///< of the four control points (one of a linear curve) that make it
    std::array<double, 4> weights;  ///< of these
    size_t segment;                 ///< index of the varying value before it
    double fraction;                ///< 0 to 1, towards the next varying value
  };
  /// Calls give(Vertex) for those of a whole curve that has `count` points with the phantom ones that
  /// pinned() adds.
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
  /// What stands at a vertex, by the values of the control points.
  template <class Value>
  Value at(const std::vector<Value>& controls, const Vertex& vertex) const {
    if (linear_) return controls[vertex.first];
    const std::array<double, 4>& w = vertex.weights;
    return w[0] * controls[vertex.first] + w[1] * controls[vertex.first + 1] +
           w[2] * controls[vertex.first + 2] + w[3] * controls[vertex.first + 3];
  }
  /// Adds the phantom points that make a pinned curve reach its first and last point.
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
