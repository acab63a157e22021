// Scales and bounds of the samples that are splatted to the hair grid. Requires air_settings.glsl.
// Largest velocity component of a sample, m/s, as bits of a float: of the last step, and of this one so far.
layout(std430, binding = 6) buffer Fastest { uint fastest_before, fastest_now; };
// Splatted velocities are clamped to this, m/s: their sums in fixed point must fit 32 bits.
float fastestSplatted() { return max(2.0 * uintBitsToFloat(fastest_before), 1.0); }
// Momentum to fixed point, s/(kg m).
float momentumScale() { return kWhole / (air.mass * fastestSplatted()); }

// Whether a sample is splatted: finite, and far enough from the border that its nodes and their blur lie in the grid.
bool isInGrid(vec3 at) { return all(greaterThanEqual(at, vec3(2))) && all(lessThanEqual(at, vec3(air.cells - 3))); }
