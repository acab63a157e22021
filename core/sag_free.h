#pragma once
#include <cstdint>
#include <functional>
#include <vector>

#include "core/strand_model.h"

namespace strandcast {

/// What makeSagFree had to stiffen, because human hair cannot hold every shape that a groom gives it.
struct SagFreeReport {
  std::vector<uint32_t> stiffened;  ///< strands, ascending
  float largest_factor = 1;         ///< on the stiffness of any joint
  uint32_t stiffest = 0;            ///< the strand that has it; the first where none is stiffened
  std::vector<uint32_t> unstable;   ///< strands that no factor up to kMostStiffening makes stable, ascending
};

/// Changes the rest strains so that the groomed shape is the shape at rest under `gravity` (m/s^2, in the
/// groom's frame).
///
/// A strand with a free tip is statically determinate: the moment at a joint is that of the weight beyond it,
///   M_j = sum over edges e >= j of l_e t_e x W_e,   W_e = gravity x mass beyond edge e,
/// and the rest strain that answers it follows in closed form. A pinned vertex is taken to carry what hangs
/// between it and the next vertex outwards that is pinned, or the tip. A joint is stiffened where its rest
/// strain would change by more than kLargestChange, and a strand as a whole where its shape would not be
/// stable under kWeightHeld times its weight (the second variation of its energy, a block tridiagonal matrix,
/// is not positive). Throws Error where a component of gravity is beyond kStrongestGravity.
/// `progress` is called in the calling thread with the part that is done, 0 to 1; where it gives false, it
/// ends early, and the model is of no use.
SagFreeReport makeSagFree(StrandModel& model, const Vec3& gravity,
                          const std::function<bool(double part)>& progress = {});

constexpr double kLargestChange = 1.0;   ///< of a rest strain, 2 tan(angle / 2): 53 degrees
constexpr double kWeightHeld = 2;        ///< times the weight, that a groomed shape is stable under
constexpr double kMostStiffening = 1e4;  ///< of a strand

}  // namespace strandcast
