#include "air/wind_box.h"

namespace strandcast {

Eigen::Vector3i WindBox::centreAt(const Vec3& middle) {
  const double cell = static_cast<double>(cell_);
  const Vec3 wanted = middle / cell_ - Vec3::Constant(0.5f * static_cast<float>(cells_));
  const Vec3 off = wanted - (corner_ / cell).cast<float>();
  if (off.cwiseAbs().maxCoeff() <= 1) return Eigen::Vector3i::Zero();
  const Eigen::Vector3i shift = off.array().round().matrix().cast<int>();
  corner_ += shift.cast<double>() * cell;
  return shift;
}

}  // namespace strandcast
