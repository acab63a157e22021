// Compiled once per instruction set: Highway's foreach_target includes this file again for each.
#include <bit>
#include <cmath>
#include <cstring>

#include "air/grid_passes.h"
#include "kernels/highway_targets.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "air/grid_passes_simd.cc"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace strandcast::air::HWY_NAMESPACE {

// The order matters.
// clang-format off
#include "kernels/lanes_highway.inl"
#include "kernels/end_lanes.inl"
#include "core/body_surface.inl"
#include "air/lanes_highway.inl"
#include "air/grid_passes.inl"
// clang-format on

}  // namespace strandcast::air::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace strandcast {
namespace air {

HWY_EXPORT(passes);

}  // namespace air

const GridPasses<float>& simdPasses() {
  static const GridPasses<float> table = [] {
    // HWY_TARGETS is what was compiled. Lower bits are better.
    const int64_t runnable = hwy::SupportedTargets() & HWY_TARGETS, best = runnable & -runnable;
    hwy::ChosenTarget chosen;  // of its own: the process-wide choice stays as it is
    chosen.Update(best);
    GridPasses<float> made = air::HWY_DISPATCH_TABLE(passes)[chosen.GetIndex()]();
    made.name = hwy::TargetName(best);
    return made;
  }();
  return table;
}

}  // namespace strandcast
#endif  // HWY_ONCE
