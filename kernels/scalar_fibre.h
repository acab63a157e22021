#pragma once
#include "kernels/scalar_lanes.h"

// Light scattered by hair fibres over scalar lanes.
// clang-format off
#define FIBRE_TABLE_PARAMETER const float* fibre_table,
#define FIBRE_TABLE fibre_table,
#define FIBRE_TEXEL(i) static_cast<real>(fibre_table[static_cast<int>(i)])
namespace strandcast::kernels::f32 {
#include "kernels/lanes_macros.inl"
#include "kernels/fibre.h"
#include "kernels/fibre_table.h"
#include "kernels/dual_scattering.h"
#include "kernels/end_lanes.inl"
}  // namespace strandcast::kernels::f32
namespace strandcast::kernels::f64 {
#include "kernels/lanes_macros.inl"
#include "kernels/fibre.h"
#include "kernels/fibre_table.h"
#include "kernels/dual_scattering.h"
#include "kernels/end_lanes.inl"
}  // namespace strandcast::kernels::f64
#undef FIBRE_TABLE_PARAMETER
#undef FIBRE_TABLE
#undef FIBRE_TEXEL
// clang-format on
