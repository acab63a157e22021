#pragma once
#include <Eigen/Geometry>
#include <cstddef>
#include <vector>

#include "core/strand_block.h"

namespace strandcast {

/// Memory layout of a cubic grid: x fastest. Rows and layers are padded, so every row, layer and grid has an
/// element before its first and behind its last one, and vectors of 16 may read and write past the end of a
/// row. An index may be -1 or `cells` on one axis at a time.
struct GridShape {
  int cells = 0;  ///< per axis

  size_t row() const { return static_cast<size_t>(cells) + 16; }
  size_t layer() const { return row() * (static_cast<size_t>(cells) + 1); }
  size_t size() const { return layer() * (static_cast<size_t>(cells) + 2) + 16; }
  size_t at(int i, int j, int k) const {
    return layer() * static_cast<size_t>(k + 1) + row() * static_cast<size_t>(j) + static_cast<size_t>(i);
  }
  /// Stride between neighbours along `axis`.
  size_t next(int axis) const { return axis == 0 ? 1 : axis == 1 ? row() : layer(); }
};

/// Nodes or cells from min() to max(), both inclusive.
using NodeBox = Eigen::AlignedBox3i;

/// Values of a grid; GridShape::size() elements (times the components of a node).
template <class Scalar>
using GridArray = std::vector<Scalar, CacheLineAllocator<Scalar>>;

}  // namespace strandcast
