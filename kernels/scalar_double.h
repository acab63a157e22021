#pragma once
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>

// Kernel text compiled for one double per lane.
namespace strandcast::kernels::f64 {
#define STRANDCAST_SCALAR double
// clang-format off
#include "kernels/lanes_scalar.inl"
#include "kernels/rotation.h"
#include "kernels/strand.h"
#include "kernels/contact.h"
#include "kernels/distance_field.h"
#include "kernels/rod.h"
#include "kernels/stiff_tensions.h"
#include "kernels/grid.h"
#include "kernels/hair.h"
#include "kernels/end_lanes.inl"
// clang-format on
}  // namespace strandcast::kernels::f64
