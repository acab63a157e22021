// Compiled once per instruction set: Highway's foreach_target includes this file again for each.
#include <bit>
#include <cmath>
#include <cstring>

#include "air/grid_passes.h"
#include "air/hair_layout.h"
#include "kernels/highway_targets.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "air/grid_passes_simd.cc"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace strandcast::air::HWY_NAMESPACE {

// The order of includes matters: later text uses the lane vocabulary of earlier text.
// clang-format off
#include "kernels/lanes_highway.inl"
#include "kernels/rotation.h"
#include "kernels/contact.h"
#include "kernels/distance_field.h"
#include "kernels/grid.h"
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
    // HWY_TARGETS: compiled targets as bits; a lower bit is a better target.
    const int64_t runnable = hwy::SupportedTargets() & HWY_TARGETS, best = runnable & -runnable;
    hwy::ChosenTarget chosen;  // a local one: the process-wide choice is not changed
    chosen.Update(best);
    GridPasses<float> made = air::HWY_DISPATCH_TABLE(passes)[chosen.GetIndex()]();
    made.name = hwy::TargetName(best);
    return made;
  }();
  return table;
}

}  // namespace strandcast
#endif  // HWY_ONCE
