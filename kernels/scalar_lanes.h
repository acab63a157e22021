#pragma once
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>

// Lane vocabulary over one float and over one double, with the rotations that other kernels need.
// clang-format off
namespace strandcast::kernels::f32 {
#define STRANDCAST_SCALAR float
#include "kernels/lanes_scalar.inl"
#include "kernels/rotation.h"
#include "kernels/end_lanes.inl"
}  // namespace strandcast::kernels::f32
namespace strandcast::kernels::f64 {
#define STRANDCAST_SCALAR double
#include "kernels/lanes_scalar.inl"
#include "kernels/rotation.h"
#include "kernels/end_lanes.inl"
}  // namespace strandcast::kernels::f64
// clang-format on
