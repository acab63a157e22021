#pragma once
#include "kernels/scalar_lanes.h"

// What pictures share, over scalar lanes.
// clang-format off
namespace strandcast::kernels::f32 {
#include "kernels/lanes_macros.inl"
#include "kernels/picture.h"
#include "kernels/end_lanes.inl"
}  // namespace strandcast::kernels::f32
// clang-format on
