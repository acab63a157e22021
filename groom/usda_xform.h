#pragma once
#include <Eigen/Geometry>

#include "groom/usda_stage.h"

namespace strandcast {

/// Where a prim stands. An operation without a value, or without its property, is the identity.
/// Source: UsdGeomXformable and UsdGeomXformOp of OpenUSD.
struct UsdaPlacement {
  Eigen::Affine3d to_world = Eigen::Affine3d::Identity();
  std::vector<std::string> missing;  ///< operations that are named and have no value
};

/// The operations of `xformOpOrder` in the place of the prim above; `!resetXformStack!` leaves that place.
/// Throws UsdaFault for an operation that is not known, has a wrong count of numbers or one that is not
/// finite, or cannot be inverted where it is to be.
UsdaPlacement usdaPlacementOf(const UsdaPrim& prim, const Eigen::Affine3d& above);

}  // namespace strandcast
