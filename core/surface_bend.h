#pragma once
#include <array>
#include <cstdint>

#include "core/geometry.h"

namespace strandcast {

/// Deformation of a body's surface from its rest shape, in the body's frame: the point at p was at p + w(p)
/// at rest. w is a quadratic polynomial in p - middle. kernels/surface_bend.h has the formulas.
struct SurfaceBend {
  Vec3 middle = Vec3::Zero();
  /// Coefficients of 1 (m), x, y, z, xx (1/m), yy, zz, xy, yz, zx.
  std::array<Vec3, 10> terms = filled();

  bool isNone() const;
  Vec3 shift(const Vec3& p) const;  ///< w(p), m
  /// Bent position of the point that is at `rest` at rest, m. If no such position exists, the nearest
  /// approximation found.
  Vec3 placed(const Vec3& rest) const;
  /// Normal at p, not normalised, of a bent surface whose unit normal there was `rest` at rest.
  Vec3 normal(const Vec3& p, const Vec3& rest) const;
  /// The same deformation with another `middle`.
  SurfaceBend about(const Vec3& other) const;

 private:
  static std::array<Vec3, 10> filled() {
    std::array<Vec3, 10> none;
    none.fill(Vec3::Zero());
    return none;
  }
};

/// Linear interpolation between two bends, t in [0, 1], about the middle of b.
SurfaceBend interpolate(const SurfaceBend& a, const SurfaceBend& b, float t);

/// Bend of a field over one step in the format of all backends in ShapeData::words: floats. Terms are about
/// the centre of the field's grid and are interpolated linearly over the step.
struct MovingBend {
  float begin[10][3], end[10][3];
  float reach[3];  ///< m, half extents of the box in which w is a polynomial: the field's grid
  float stretch;   ///< factor by which it may stretch distances, 1 or more; 0 = no bend in this step
  float shift;     ///< m, upper bound of the surface's displacement by the bend in the step
};
constexpr uint32_t kBendWords = sizeof(MovingBend) / sizeof(float);
static_assert(kBendWords == 65);

/// `middle`, `reach`: centre and half extents of the field's grid, m, in the body's frame.
MovingBend movingBend(const SurfaceBend& begin, const SurfaceBend& end, const Vec3& middle,
                      const Vec3& reach);
/// Upper bound of the surface's displacement from rest at either end of the step, m.
float farthestShift(const MovingBend& bend);

}  // namespace strandcast
