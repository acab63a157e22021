#pragma once
#include <cstdint>
#include <functional>
#include <vector>

#include "core/strand_model.h"

namespace strandcast {

/// Which strands makeSagFree() has stiffened, because human hair cannot hold every shape that a groom gives
/// it.
struct SagFreeReport {
  std::vector<uint32_t> stiffened;  ///< strand indices, ascending
  float largest_factor = 1;         ///< on the stiffness of any joint
  uint32_t stiffest = 0;            ///< strand with that factor; the first one if none is stiffened
  std::vector<uint32_t> unstable;   ///< strands that no factor up to kMaxStiffening makes stable, ascending
};

/// Changes the rest strains so that the groomed shape is the shape at rest under `gravity` (m/s^2, in the
/// groom's frame).
///
/// A strand with a free tip is statically determinate: the moment at a joint is that of the weight beyond it,
///   M_j = sum over edges e >= j of l_e t_e x W_e,   W_e = gravity x mass beyond edge e,
/// and the rest strain that balances it follows in closed form. A pinned vertex is taken to carry the stretch
/// up to the next pinned vertex outwards, or to the tip.
///
/// A joint is stiffened if its rest strain would change by more than kLargestChange. A strand is stiffened as
/// a whole if its shape is not stable under kWeightHeld times its weight. Stable means that the second
/// variation of its energy, a block tridiagonal matrix, is positive definite.
///
/// Throws Error if a component of gravity exceeds kStrongestGravity. `progress` is called in the calling
/// thread with the completed fraction, 0 to 1. If it returns false, the function ends early, and the model
/// must not be used.
SagFreeReport makeSagFree(StrandModel& model, const Vec3& gravity,
                          const std::function<bool(double part)>& progress = {});

constexpr double kLargestChange = 1.0;  ///< of a rest strain, 2 tan(angle / 2): 53 degrees
constexpr double kWeightHeld = 2;       ///< multiple of its weight under which a groomed shape must be stable
constexpr double kMaxStiffening = 1e4;  ///< greatest factor on a strand's stiffness

}  // namespace strandcast
