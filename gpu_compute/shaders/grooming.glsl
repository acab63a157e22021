// Grooming factors, which multiply the settings of all hair, and tethers (kernels/strand.h). Requires step_input.glsl.
// GROOMED: 1: factors of friction and damping time are constant along each strand.
//          2: they may differ along strands.

// One entry per vertex. At a strand's root: factors of friction (x) and of the damping time (y). At its other vertices:
// factors of air drag (x) and of the goal's rate (y), and the length of the tether (z, m). GROOMED 2: the second half of
// the buffer holds the factors of friction (x) and damping time (y) of each vertex and its joint.
layout(std430, binding = 13) readonly buffer Grooming { vec4 grooming[]; };

float airDragOf(uint vertex) { return settings.air_drag * grooming[vertex].x; }
// DragStep::keep and DragStep::time2 (core/backend.h) with the vertex's air drag.
float keepOf(uint vertex) { return exp(-airDragOf(vertex) * settings.substep); }
float time2Of(uint vertex) {
  const float x = airDragOf(vertex) * settings.substep;
  const float small = madd(-x, madd(-x, madd(-x, madd(-x, 1.0 / 120.0, 1.0 / 24.0), 1.0 / 6.0), 0.5), 1.0);
  return settings.substep * settings.substep * (x < 0.1 ? small : (1.0 - exp(-x)) / x);
}
#if GROOMED == 2
vec2 frictionAndDampingOf(uint vertex) { return grooming[uint(grooming.length()) / 2u + vertex].xy; }
#endif
float goalRateOf(uint vertex) { return settings.goal_rate * grooming[vertex].y; }
