// Compiled once per instruction set: Highway's foreach_target includes this file again for each.
#include "simd/simd_kernels.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "core/backend.h"
#include "core/strand_block.h"
#include "kernels/highway_targets.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simd/simd_kernels.cc"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace strandcast::simd::HWY_NAMESPACE {

// In this order: the lane vocabulary comes first, and end_lanes.inl undefines it.
// clang-format off
#include "kernels/lanes_highway.inl"
#include "kernels/rotation.h"
#include "kernels/strand.h"
#include "kernels/contact.h"
#include "kernels/distance_field.h"
#include "kernels/rod.h"
#include "kernels/stiff_tensions.h"
#include "core/block_step.inl"
#include "kernels/end_lanes.inl"
// clang-format on

SimdKernel kernel() { return {static_cast<int>(hn::Lanes(Tag())), &stepBlock}; }

}  // namespace strandcast::simd::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace strandcast::simd {

HWY_EXPORT(kernel);

std::vector<SimdTarget> runnableTargets() {
  std::vector<SimdTarget> out;
  // HWY_TARGETS: the compiled targets. Lower bits are better.
  for (int64_t left = hwy::SupportedTargets() & HWY_TARGETS; left != 0; left &= left - 1) {
    const int64_t target = left & -left;
    hwy::ChosenTarget chosen;  // a local one: the process-wide choice stays unchanged
    chosen.Update(target);
    out.push_back({hwy::TargetName(target), HWY_DISPATCH_TABLE(kernel)[chosen.GetIndex()]()});
  }
  return out;
}

}  // namespace strandcast::simd
#endif  // HWY_ONCE
