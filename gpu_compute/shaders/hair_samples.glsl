// Which samples count, and how their velocities are splatted.
// Bits of the largest component of the velocity of a sample: of the last step, then of this one as it is found.
layout(std430, binding = 6) buffer Fastest { uint fastest_before, fastest_now; };
// Velocities beyond this are cut in what is splatted: their sums must fit whole numbers.
float fastestSplatted() { return max(2.0 * uintBitsToFloat(fastest_before), 1.0); }
float momentumScale() { return kWhole / (air.mass * fastestSplatted()); }

// Samples at the grid's border, and what is not finite, are left out: what is spread from them must stay in the grid.
bool isInGrid(vec3 at) {
  return all(greaterThanEqual(at, vec3(2))) && all(lessThanEqual(at, vec3(air.cells - 3)));
}
