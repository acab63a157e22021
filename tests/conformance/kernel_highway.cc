// Instantiates the kernels for every Highway target.
#include <bit>

#include "kernels/highway_targets.h"
#include "tests/conformance/kernel_conformance.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tests/conformance/kernel_highway.cc"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace strandcast::HWY_NAMESPACE {

// Each text requires the ones before it.
// clang-format off
#include "kernels/lanes_highway.inl"
#include "kernels/rotation.h"
#include "kernels/strand.h"
#include "kernels/contact.h"
#include "kernels/distance_field.h"
#include "kernels/grid.h"
#include "tests/conformance/shaders/kernel_cases.h"
#include "kernels/end_lanes.inl"
// clang-format on

void runAll(int kernel, const float* in, float* out, size_t count) {
  for (size_t item = 0; item < count; item += hn::Lanes(Tag())) {
    KernelInput i;
    for (int c = 0; c < kKernelInputs; ++c) i.v[c] = load(in + c * count + item);
    const KernelOutput o = runKernel(kernel, i);
    for (int c = 0; c < kKernelOutputs; ++c) store(o.v[c], out + c * count + item);
  }
}

}  // namespace strandcast::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace strandcast {

HWY_EXPORT(runAll);

std::vector<KernelInstantiation> highwayInstantiations() {
  std::vector<KernelInstantiation> out;
  for (int64_t left = hwy::SupportedTargets() & HWY_TARGETS; left != 0; left &= left - 1) {
    hwy::ChosenTarget chosen;
    chosen.Update(left & -left);
    out.push_back({hwy::TargetName(left & -left), HWY_DISPATCH_TABLE(runAll)[chosen.GetIndex()]});
  }
  return out;
}

}  // namespace strandcast
#endif  // HWY_ONCE
