// Public API
// Signed distance fields of bodies, and bends of such fields. kernels/distance_field.h has the formulas.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/geometry.h"

namespace strandcast {

/// Layout of a brick: its edge in cells, its samples per axis, all samples, and their 32-bit words.
/// Neighbours share a face of samples, so that one brick is enough for any cell of it. A word holds two
/// samples, the even one in the low half.
constexpr uint32_t kBrickCells = 8;
constexpr uint32_t kBrickSide = kBrickCells + 1;
constexpr uint32_t kBrickSamples = kBrickSide * kBrickSide * kBrickSide;
constexpr uint32_t kBrickWords = (kBrickSamples + 1) / 2;

/// Index entries of bricks of which no part is in the band.
constexpr uint32_t kOutsideBrick = 0xFFFFFFFF;
constexpr uint32_t kInsideBrick = 0xFFFFFFFE;

/// Greatest number of bricks or corners of a grid: their indices must be exact in a float.
constexpr uint32_t kMaxGridBricks = 1u << 24;

/// Grid of a distance field. One layout for the CPU arrays and for GLSL std430.
struct alignas(16) FieldGrid {
  float origin[3];     ///< m, low corner of brick 0
  float cell;          ///< m, edge of a cell
  uint32_t bricks[3];  ///< per axis; the product of (bricks + 1) is at most kMaxGridBricks
  float band;          ///< m: bricks nearer to the surface than this are stored
  float quantum;       ///< m, unit of a stored sample
  // First words of the field's arrays in ShapeData::words; 0 in a DistanceField, which owns the arrays.
  uint32_t index, samples, corners;
};
static_assert(sizeof(FieldGrid) == 48);

/// Sample n of a brick whose words start at `brick`, in units of FieldGrid::quantum.
inline int16_t fieldSample(const uint32_t* brick, uint32_t n) {
  return static_cast<int16_t>(brick[n / 2] >> (16 * (n % 2)));
}

/// Evenness of a stored brick: how alike the normals around it are. 0: unknown; 1: no two normals in it
/// differ by 60 degrees; 2 or 3: the same including one or two cells on all sides, which must be stored, too.
/// Two bits each, after the corners in ShapeData::words.
constexpr uint32_t kEvennessesPerWord = 16;
inline uint32_t firstEvenness(const FieldGrid& grid) {
  return grid.corners + (grid.bricks[0] + 1) * (grid.bricks[1] + 1) * (grid.bricks[2] + 1);
}

struct FieldSample {
  float distance = 0;            ///< m, negative inside
  Vec3 gradient = Vec3::Zero();  ///< of the distance; about unit length, points out of the body
};

/// Signed distance field of a body, in the body's frame: sparse bricks of samples near the surface, and
/// distances at the corners of all bricks. Flat arrays, the same for every backend. kernels/distance_field.h
/// has the formulas.
struct DistanceField {
  FieldGrid grid{};
  std::vector<uint32_t> index;    ///< per brick of the grid, x fastest: kOutsideBrick, kInsideBrick or its
                                  ///< number among the stored bricks
  std::vector<uint32_t> samples;  ///< per stored brick kBrickWords words of 16-bit signed numbers, x fastest
  std::vector<float> corners;     ///< m, (bricks + 1) per axis, x fastest

  size_t bricks() const { return index.size(); }
  size_t storedBricks() const { return samples.size() / kBrickWords; }
  size_t bytes() const;
  /// Whether any sample is inside. Hair passes through a field without one.
  bool hasInside() const;

  /// Samples the field at any point (m). In stored bricks: the trilinear interpolant and its exact gradient.
  /// Elsewhere: a distance that is never farther from 0 than the true one, and the direction of the corners'
  /// interpolant.
  FieldSample at(const Vec3& point) const;
  /// Evenness of all stored bricks, packed into words: see firstEvenness().
  std::vector<uint32_t> evenness() const;
};

/// Error text for a mesh whose field has no inside.
constexpr const char* kNoInside =
    "the field has no inside, so hair passes through the body: the mesh encloses no volume, or is thinner "
    "than a cell";

/// Position of sample `i` `j` `k` of the whole grid, m (index = brick * kBrickCells + sample in the brick).
Vec3 samplePosition(const FieldGrid& grid, uint32_t i, uint32_t j, uint32_t k);

/// Deformation of a body's surface from its rest shape, in the body's frame: the point at p was at p + w(p)
/// at rest. w is a quadratic polynomial in p - middle. kernels/distance_field.h has the formulas.
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
