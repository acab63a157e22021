#pragma once
#include <array>
#include <cstdint>

#include "core/geometry.h"

namespace strandcast {

/// How the surface of a body differs from rest, in the body's frame: what is at p was at rest at p + w(p). w
/// is quadratic in p - middle; kernels/surface_bend.h has what is done with it.
struct SurfaceBend {
  Vec3 middle = Vec3::Zero();
  /// Factors of 1 (m), x, y, z, xx (1/m), yy, zz, xy, yz, zx.
  std::array<Vec3, 10> terms = filled();

  bool isNone() const;
  Vec3 shift(const Vec3& p) const;  ///< w(p), m
  /// Where what is at `rest` at rest is, m; where nothing is, as near as is found.
  Vec3 placed(const Vec3& rest) const;
  /// The normal at p, of any length, of a surface that had the unit normal `rest` there at rest.
  Vec3 normal(const Vec3& p, const Vec3& rest) const;
  /// The same about another point.
  SurfaceBend about(const Vec3& other) const;

 private:
  static std::array<Vec3, 10> filled() {
    std::array<Vec3, 10> none;
    none.fill(Vec3::Zero());
    return none;
  }
};

/// Between two bends, t in [0, 1], about the middle of b.
SurfaceBend interpolate(const SurfaceBend& a, const SurfaceBend& b, float t);

/// The bend of a field over one step, as every backend reads it in ShapeData::words: floats. Terms are about
/// the middle of the field's grid and go evenly from beginning to end.
struct MovingBend {
  float begin[10][3], end[10][3];
  float reach[3];  ///< m, of the box that w is a polynomial in: the field's grid
  float stretch;   ///< by how much it may stretch distances, 1 or more; 0 = there is no bend in this step
  float shift;     ///< m, at most what the surface moves by in the step for it
};
constexpr uint32_t kBendWords = sizeof(MovingBend) / sizeof(float);
static_assert(kBendWords == 65);

/// `middle`, `reach`: m, of the field's grid in the body's frame.
MovingBend movingBend(const SurfaceBend& begin, const SurfaceBend& end, const Vec3& middle,
                      const Vec3& reach);
/// At most how far it moves the surface from rest at either end, m.
float farthestShift(const MovingBend& bend);

}  // namespace strandcast
