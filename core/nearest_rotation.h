#pragma once
#include "core/geometry.h"

namespace strandcast {

/// Rotation nearest to a matrix of finite numbers.
Quat nearestRotation(const Eigen::Matrix3d& matrix);

}  // namespace strandcast
