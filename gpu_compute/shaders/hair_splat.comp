#version 450
// variants: MEASURE=0 | MEASURE=1
// Splats mass and momentum of the samples to the hair grid.
// Reads: positions, velocities, edge masses, the last step's largest velocity.
// Writes: sums per node, in fixed point; positions on the grid and velocities of samples; this step's largest velocity.
// One workgroup per tile of samples, one invocation per sample.
// MEASURE: 0: splats.
//          1: only finds the largest velocity component, before the first splat.
#include "kernels/lanes_glsl.h"
#include "kernels/grid.h"
#include "gpu_compute/shaders/air_settings.glsl"
#include "gpu_compute/shaders/sample_tile.glsl"
#include "gpu_compute/shaders/hair_samples.glsl"
layout(std430, binding = 7) buffer Sums { int sums[]; };  // 4 per node, fixed point: momentum, mass
#if !MEASURE
#define NUMBERS 4u
#define SUMS sums
#include "gpu_compute/shaders/hair_spread.glsl"
#endif

shared uint fastest;

void main() {
  const float kMaxSampleSpeed = 1e4;  // m/s; faster samples are taken for errors and left out
  if (workgroupNumber() >= air.tiles) return;
  SampleTile tile = tiles[workgroupNumber()];
  if (gl_LocalInvocationIndex == 0u) fastest = 0u;
#if !MEASURE
  float most = fastestSplatted(), scale = momentumScale();
#endif
  barrier();
  uint me = gl_LocalInvocationIndex, count = tile.pieces * tile.strands;
  if (me < count) {
    uvec2 at = divided(me, tile.pieces);  // strand and piece
    Sample own = sampleOf(tile, roots[tile.first_strand + at.x], tile.first_piece + at.y);
    vec3 size = abs(own.motion);
    bool sane = size.x < kMaxSampleSpeed && size.y < kMaxSampleSpeed && size.z < kMaxSampleSpeed;
    if (sane) atomicMax(fastest, floatBitsToUint(max(size.x, max(size.y, size.z))));
#if !MEASURE
    spots[me] = vec4(sane ? transformed(air.hair_frame, own.place) : vec3(-1), own.mass);
    for (int c = 0; c < 3; ++c) values[c * TILE_SAMPLES + int(me)] = own.motion[c];
#endif
  }
  barrier();
#if MEASURE
  if (me == 0u) atomicMax(fastest_before, fastest);
#else
  // Permutes the samples from the order along strands to the order in which neighbours in space are adjacent.
  uint sample_ = workgroupNumber() * uint(TILE_SAMPLES) + me;
  vec4 found = vec4(-1);
  vec3 motion = vec3(0);
  if (me < count) {
    uint from = (order[sample_] & 0xFFFFu) * tile.pieces + (order[sample_] >> 16u);
    found = spots[from];
    for (int c = 0; c < 3; ++c) motion[c] = values[c * TILE_SAMPLES + int(from)];
    for (uint c = 0u; c < 3u; ++c) {
      places[c * plane() + sample_] = found[c];
      motions[c * plane() + sample_] = motion[c];
    }
  }
  barrier();
  if (isInGrid(found.xyz))
    put(me, placeAmong(found.xyz), found.w * vec4(clamp(motion, vec3(-most), vec3(most)) * scale, air.mass_scale));
  else
    discardSample(me);
  barrier();
  spread(count);
  if (me == 0u) atomicMax(fastest_now, fastest);
#endif
}
