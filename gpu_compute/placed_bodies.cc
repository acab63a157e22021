#include "gpu_compute/placed_bodies.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "kernels/scalar_float.h"

namespace strandcast {
namespace kernels::f32 {
#include "core/body_surface.inl"
}  // namespace kernels::f32

namespace gpu {
namespace {

constexpr float kEverywhere = 1e18f;  // m; its square is a float too

template <class To, class From, size_t n>
void put(To (&to)[n], const From (&from)[n]) {
  std::copy(from, from + n, to);
}

}  // namespace

PlacedBody placedBody(const MovingPrimitive& primitive, double time, double part, double seconds,
                      float hair_radius) {
  const kernels::f32::SubstepBody at =
      kernels::f32::bodyAt(primitive, nullptr, time, part, seconds, hair_radius, 1.0f);
  PlacedBody body{};
  put(body.middle, at.middle);
  body.ball = at.kind == PrimitiveKind::kPlane ? kEverywhere : at.ball;
  put(body.a, at.a);
  body.radius = at.radius;
  put(body.b, at.b);
  body.radius_b = at.radius_b;
  put(body.a_motion, at.a_motion);
  body.friction = at.friction;
  put(body.turn, at.turn);
  body.kind = primitive.kind;
  if (at.kind >= PrimitiveKind::kEllipsoid) put(body.rotation, at.rotation);
  put(body.extent, at.extent);
  body.data = at.data;
  body.planes = at.planes;
  return body;
}

void placeBodies(const StepInput& input, PlacedBody* out) {
  const Parameters& p = *input.parameters;
  const double part = 1.0 / p.substeps, seconds = static_cast<double>(p.time_step) / p.substeps;
  for (int substep = 1; substep <= p.substeps; ++substep)
    for (const MovingPrimitive& primitive : input.primitives)
      *out++ = placedBody(primitive, substep * part, part, seconds, p.hair_radius);
}

}  // namespace gpu
}  // namespace strandcast
