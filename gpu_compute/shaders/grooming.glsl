// Factors of what the settings have for all hair, and the goal pull's (kernels/grooming.h). Needs step_input.glsl.

// At a strand's root: of friction, of the damping time. At its other vertices: of air drag, of the goal's rate.
layout(std430, binding = 13) readonly buffer Grooming { vec2 grooming[]; };

float keepOf(uint vertex) { return exp(-settings.air_drag * grooming[vertex].x * settings.substep); }
float goalRateOf(uint vertex) { return settings.goal_rate * grooming[vertex].y; }
