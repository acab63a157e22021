#version 450
// variants: MEASURE=0 | MEASURE=1
// Crowding of samples (pressure of hair that is denser than at rest, see crowding() of kernels/grid.h), splatted as
// mass x crowding to the nodes.
// Reads: densities, positions of samples on the grid, masses and rest densities of samples.
// Writes: sums per node, in fixed point; the held crowding of samples.
// One workgroup per tile of samples, one invocation per sample.
// MEASURE: 0: computes and splats.
//          1: only stores the present density as the rest density of each sample.
#include "kernels/lanes_glsl.h"
#include "kernels/grid.h"
#include "gpu_compute/shaders/air_settings.glsl"
#include "gpu_compute/shaders/sample_tile.glsl"
#include "gpu_compute/shaders/hair_samples.glsl"
layout(std430, binding = 0) buffer Resting { vec2 resting[]; };  // per sample: mass, kg; density at rest, kg/m^3
layout(std430, binding = 1) buffer Held { float held[]; };       // per sample: heldCrowding()
layout(std430, binding = 8) buffer CrowdSums { int crowd_sums[]; };
layout(std430, binding = 11) readonly buffer Densities { float densities[]; };
#define NUMBERS 1u
#define SUMS crowd_sums
#include "gpu_compute/shaders/hair_spread.glsl"

void main() {
  if (workgroupNumber() >= air.tiles) return;
  SampleTile tile = tiles[workgroupNumber()];
  uint me = gl_LocalInvocationIndex, count = tile.pieces * tile.strands;
  uint sample_ = workgroupNumber() * uint(TILE_SAMPLES) + me;
  vec3 at = me < count ? placeOf(sample_) : vec3(-1);
  GridPlace corner = placeAmong(at);
  float found = 0.0;
  if (isInGrid(at)) {
    int first = nodeAt(ivec3(corner.low)), y = air.cells, z = y * y;
    float density =
        interpolated(densities[first], densities[first + 1], densities[first + y], densities[first + y + 1], densities[first + z],
                     densities[first + z + 1], densities[first + z + y], densities[first + z + y + 1], corner.part);
#if MEASURE
    resting[sample_].y = density;
#else
    vec2 own = resting[sample_];
    float rest = own.y * air.rest_scale;
    float most = largestCrowding(rest, own.x * air.alone) * air.stiffness * kMaxHeldCrowding;
    float now_held = heldCrowding(held[sample_], density, rest, air.stiffness, air.gain, most);
    held[sample_] = now_held;
    found = own.x * (crowding(density, rest, air.stiffness) + now_held) * air.crowd_scale;
#endif
  }
#if !MEASURE
  if (found > 0.0)
    put(me, corner, vec4(found, 0, 0, 0));
  else
    discardSample(me);
  barrier();
  spread(count);
#endif
}
