#include <bit>
#include <cstring>

#include "air/grid_passes.h"
#include "air/hair_layout.h"
#include "kernels/scalar_grid.h"
#include "kernels/scalar_strands.h"

namespace strandcast {
// The order of includes matters: later text uses the lane vocabulary of earlier text.
// clang-format off
namespace kernels::f32 {
#include "core/body_surface.inl"
#include "air/lanes_scalar.inl"
#include "air/grid_passes.inl"
}  // namespace kernels::f32
namespace kernels::f64 {
#include "core/body_surface.inl"
#include "air/lanes_scalar.inl"
#include "air/grid_passes.inl"
}  // namespace kernels::f64
// clang-format on

template <>
const GridPasses<float>& scalarPasses<float>() {
  static const GridPasses<float> table = [] {
    GridPasses<float> made = kernels::f32::passes();
    made.name = "scalar";
    return made;
  }();
  return table;
}
template <>
const GridPasses<double>& scalarPasses<double>() {
  static const GridPasses<double> table = [] {
    GridPasses<double> made = kernels::f64::passes();
    made.name = "double, scalar";
    return made;
  }();
  return table;
}

}  // namespace strandcast
