#pragma once
#include "kernels/scalar_lanes.h"

// Light scattered by hair fibres over scalar lanes.
// clang-format off
namespace strandcast::kernels::f32 {
#include "kernels/lanes_macros.inl"
#include "kernels/fibre.h"
#include "kernels/end_lanes.inl"
}  // namespace strandcast::kernels::f32
namespace strandcast::kernels::f64 {
#include "kernels/lanes_macros.inl"
#include "kernels/fibre.h"
#include "kernels/end_lanes.inl"
}  // namespace strandcast::kernels::f64
// clang-format on
