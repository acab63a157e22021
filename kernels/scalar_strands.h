#pragma once
#include "kernels/scalar_lanes.h"

// The kernels of a step of strands over scalar lanes.
// clang-format off
namespace strandcast::kernels::f32 {
#include "kernels/lanes_macros.inl"
#include "kernels/strand.h"
#include "kernels/contact.h"
#include "kernels/distance_field.h"
#include "kernels/rod.h"
#include "kernels/stiff_tensions.h"
#include "kernels/end_lanes.inl"
}  // namespace strandcast::kernels::f32
namespace strandcast::kernels::f64 {
#include "kernels/lanes_macros.inl"
#include "kernels/strand.h"
#include "kernels/contact.h"
#include "kernels/distance_field.h"
#include "kernels/rod.h"
#include "kernels/stiff_tensions.h"
#include "kernels/end_lanes.inl"
}  // namespace strandcast::kernels::f64
// clang-format on
