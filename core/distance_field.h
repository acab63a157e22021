#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/geometry.h"

namespace strandcast {

/// Edge of a brick in cells, its samples per axis (neighbours share a face of samples, so that one brick is
/// enough for any cell of it), and how many 32-bit words hold them, two a word, the even one in the low half.
constexpr uint32_t kBrickCells = 8;
constexpr uint32_t kBrickSide = kBrickCells + 1;
constexpr uint32_t kBrickSamples = kBrickSide * kBrickSide * kBrickSide;
constexpr uint32_t kBrickWords = (kBrickSamples + 1) / 2;

/// In the index: no part of the brick is in the band.
constexpr uint32_t kOutsideBrick = 0xFFFFFFFF;
constexpr uint32_t kInsideBrick = 0xFFFFFFFE;

/// Numbers of bricks and corners are exact in a float: more than this many in a grid are refused.
constexpr uint32_t kMaxGridBricks = 1u << 24;

/// One layout for the CPU arrays and for GLSL std430.
struct alignas(16) FieldGrid {
  float origin[3];     ///< m, the low corner of brick 0
  float cell;          ///< m
  uint32_t bricks[3];  ///< per axis; (bricks + 1) multiplied is at most kMaxGridBricks
  float band;          ///< m: bricks that come nearer to the surface than this are stored
  float quantum;       ///< m, one unit of a stored sample
  // Where the arrays of the field start in ShapeData::words; 0 in a DistanceField, which has them itself.
  uint32_t index, samples, corners;
};
static_assert(sizeof(FieldGrid) == 48);

/// Sample n of a brick whose words start at `brick`, in units of FieldGrid::quantum.
inline int16_t fieldSample(const uint32_t* brick, uint32_t n) {
  return static_cast<int16_t>(brick[n / 2] >> (16 * (n % 2)));
}

/// How even the normals about a stored brick are: 0: not known; 1: no two normals in it are 60 degrees apart;
/// 2 or 3: nor with one or two cells on all sides of it, which are stored too. Two bits each, behind the
/// corners in ShapeData::words.
constexpr uint32_t kEvennessesPerWord = 16;
inline uint32_t firstEvenness(const FieldGrid& grid) {
  return grid.corners + (grid.bricks[0] + 1) * (grid.bricks[1] + 1) * (grid.bricks[2] + 1);
}

struct FieldSample {
  float distance = 0;            ///< m, negative inside
  Vec3 gradient = Vec3::Zero();  ///< of the distance; about unit length, points out of the body
};

/// Signed distance to the surface of a body, in the body's frame: sparse bricks of samples near the surface,
/// and everywhere the distance at the corners of bricks. Flat arrays, the same for every backend.
/// kernels/distance_field.h has the formulas.
struct DistanceField {
  FieldGrid grid{};
  std::vector<uint32_t>
      index;  ///< per brick of the grid, x fastest: kOutsideBrick, kInsideBrick or its number
  std::vector<uint32_t> samples;  ///< per stored brick kBrickWords words of 16-bit signed numbers, x fastest
  std::vector<float> corners;     ///< m, (bricks + 1) per axis, x fastest

  size_t bricks() const { return index.size(); }
  size_t storedBricks() const { return samples.size() / kBrickWords; }
  size_t bytes() const;
  /// Whether any sample is inside. Where none is, hair goes through it.
  bool hasInside() const;

  /// Any point, in metres. In stored bricks the trilinear interpolant and its exact gradient; elsewhere a
  /// distance that is never farther from 0 than the true one, and the direction of the corners' interpolant.
  FieldSample at(const Vec3& point) const;
  /// Of all stored bricks, as words.
  std::vector<uint32_t> evenness() const;
};

/// What is wrong with a mesh whose field has no inside.
constexpr const char* kNoInside =
    "nothing is inside it, so hair goes through it: the mesh encloses no volume, or is thinner than a cell";

/// The position of sample `i` `j` `k` of the whole grid (brick * kBrickCells + sample in the brick).
Vec3 samplePosition(const FieldGrid& grid, uint32_t i, uint32_t j, uint32_t k);

}  // namespace strandcast
