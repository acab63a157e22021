#pragma once
#include <Eigen/Geometry>
#include <cstddef>
#include <vector>

#include "core/strand_block.h"

namespace strandcast {

/// How the numbers of a cubic grid lie in memory: x fastest, rows padded so that there is a number before the
/// first and behind the last of every row, row and layer, and that vectors of 16 may read and write past a
/// row's end. Places -1 .. cells of each axis exist for one axis at a time.
struct GridShape {
  int cells = 0;  ///< per axis

  size_t row() const { return static_cast<size_t>(cells) + 16; }
  size_t layer() const { return row() * (static_cast<size_t>(cells) + 1); }
  size_t size() const { return layer() * (static_cast<size_t>(cells) + 2) + 16; }
  size_t at(int i, int j, int k) const {
    return layer() * static_cast<size_t>(k + 1) + row() * static_cast<size_t>(j) + static_cast<size_t>(i);
  }
  /// From a place to the next along `axis`.
  size_t next(int axis) const { return axis == 0 ? 1 : axis == 1 ? row() : layer(); }
};

/// Nodes or cells from min() to max(), both within.
using NodeBox = Eigen::AlignedBox3i;

/// Numbers of a grid, [GridShape::size()].
template <class Scalar>
using GridArray = std::vector<Scalar, CacheLineAllocator<Scalar>>;

}  // namespace strandcast
