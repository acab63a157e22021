// Factors of what the settings have for all hair, and tethers (kernels/grooming.h). Needs step_input.glsl.

// At a strand's root: factors of friction and of the damping time. At its other vertices: factors of air drag and of the
// goal's rate, length of the tether (m).
layout(std430, binding = 13) readonly buffer Grooming { vec4 grooming[]; };

float keepOf(uint vertex) { return exp(-settings.air_drag * grooming[vertex].x * settings.substep); }
float goalRateOf(uint vertex) { return settings.goal_rate * grooming[vertex].y; }
