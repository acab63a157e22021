#pragma once
#include <Eigen/Geometry>

#include "io/usda_stage.h"

namespace strandcast {

/// World transform of a prim. An operation without a value, or without its property, is the identity. Source:
/// UsdGeomXformable and UsdGeomXformOp of OpenUSD.
struct UsdaPlacement {
  Eigen::Affine3d to_world = Eigen::Affine3d::Identity();
  std::vector<std::string> missing;  ///< operations that are named but have no value
};

/// Composes `above`, the transform of the parent, with the operations of `xformOpOrder`. `!resetXformStack!`
/// discards `above`. Throws UsdaFault for an operation that is unknown, has a wrong count of numbers or one
/// that is not finite, or is to be inverted and cannot be.
UsdaPlacement usdaPlacementOf(const UsdaPrim& prim, const Eigen::Affine3d& above);

}  // namespace strandcast
