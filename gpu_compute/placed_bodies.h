#pragma once
#include <cstdint>

#include "core/backend.h"

namespace strandcast::gpu {

/// A body at the end of a substep, of shaders/bodies.glsl, std430: what core/body_surface.inl works out for
/// the CPU.
struct alignas(16) PlacedBody {
  float middle[3];
  float ball;  ///< m, of a ball about the middle that holds the body and what it presses; beyond everything
               ///< for planes
  float a[3];
  float radius;
  float b[3];
  float radius_b;
  float a_motion[3];  ///< m, over the substep
  float friction;
  float turn[3];  ///< radians, over the substep, about a
  uint32_t kind;
  float rotation[4];  ///< x y z w
  float extent[3];
  uint32_t data;
  uint32_t extra;
  uint32_t leader;   ///< of placeBodies(): the first body that moves like it throughout the step
  float time;        ///< the part of the step that has passed, 0 to 1
  float bend_shift;  ///< of placeBodies(): m, at most what its bend moves it by in the substep
};
static_assert(sizeof(PlacedBody) == 128);

/// `time`: the part of the step that has passed, 0 to 1. Motion and turn are those of `part` of the step,
/// which takes `seconds`.
PlacedBody placedBody(const MovingPrimitive& primitive, double time, double part, double seconds,
                      float hair_radius);

/// Writes every body of the step at the end of its first substep, then of the next, and so on.
void placeBodies(const StepInput& input, PlacedBody* out);

}  // namespace strandcast::gpu
