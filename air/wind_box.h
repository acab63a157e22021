#pragma once
#include "core/geometry.h"

namespace strandcast {

/// Where the cubic cells of a wind are: a box along the world's axes that goes by whole cells.
class WindBox {
 public:
  WindBox(int cells, float cell) : cells_(cells), cell_(cell) {}

  Vec3 corner() const { return corner_.cast<float>(); }  ///< the low one, m
  /// Goes to where `middle` (m) lies within a cell of its own middle; gives by how many cells.
  Eigen::Vector3i centreAt(const Vec3& middle);
  /// Places are told from `way` (m) farther on from now on. It stays in its place, which need not be a whole
  /// number of cells away then.
  void moveOrigin(const Vec3& way) { corner_ -= way.cast<double>(); }

 private:
  int cells_;
  float cell_;
  /// Whole cells and whole metres add up in it without rounding.
  Eigen::Vector3d corner_ = Eigen::Vector3d::Zero();
};

}  // namespace strandcast
