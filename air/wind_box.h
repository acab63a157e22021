#pragma once
#include "core/geometry.h"

namespace strandcast {

/// Placement of a wind grid: an axis-aligned box that moves by whole cells.
class WindBox {
 public:
  WindBox(int cells, float cell) : cells_(cells), cell_(cell) {}

  Vec3 corner() const { return corner_.cast<float>(); }  ///< low corner, m from the origin
  /// Moves the box so that `middle` (m) is within a cell of the box's centre. Returns the shift in cells.
  Eigen::Vector3i centreAt(const Vec3& middle);
  /// Origin rebasing: moves the origin of positions by `way` (m). The box keeps its place in the world, which
  /// then need not be a whole number of cells from the origin.
  void moveOrigin(const Vec3& way) { corner_ -= way.cast<double>(); }

 private:
  int cells_;
  float cell_;
  /// Low corner, m. Double, so that whole cells and whole metres add up without rounding.
  Eigen::Vector3d corner_ = Eigen::Vector3d::Zero();
};

}  // namespace strandcast
