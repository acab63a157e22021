// Factors of what the settings have for all hair, and tethers (kernels/grooming.h). Needs step_input.glsl.

// At a strand's root: factors of friction and of the damping time. At its other vertices: factors of air drag and of the
// goal's rate, length of the tether (m). Where factors of friction and of the damping time differ along strands (GROOMED is 2), those of every
// vertex, and of the joint there, are behind all that.
layout(std430, binding = 13) readonly buffer Grooming { vec4 grooming[]; };

float airDragOf(uint vertex) { return settings.air_drag * grooming[vertex].x; }
// As DragStep has them.
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
