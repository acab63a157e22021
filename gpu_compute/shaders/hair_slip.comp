#version 450
// Splats the directions of hair, weighted by its share of the drag, for air that slips along hair: HairGrid::slipNodes() of
// air/hair_grid.h in fixed point. Runs after hair_splat.comp, with the same masses.
// Reads: positions, edge masses, positions on the grid and velocities of samples.
// Writes: sums, two parts of 4 numbers per node: mass x t dot(t, velocity) and mass x t_x^2; then mass x t_y^2, t_y t_z,
// t_x t_z, t_x t_y, with the direction t.
// One workgroup per tile of samples, one invocation per sample.
#include "kernels/lanes_glsl.h"
#include "kernels/grid.h"
#include "gpu_compute/shaders/air_settings.glsl"
#include "gpu_compute/shaders/sample_tile.glsl"
#include "gpu_compute/shaders/hair_samples.glsl"
layout(std430, binding = 7) buffer Sums { int sums[]; };  // 4 per node and part, parts one after the other
#define NUMBERS 4u
#define SUMS sums
#include "gpu_compute/shaders/hair_spread.glsl"

void main() {
  if (workgroupNumber() >= air.tiles) return;
  SampleTile tile = tiles[workgroupNumber()];
  uint me = gl_LocalInvocationIndex, count = tile.pieces * tile.strands, sample_ = workgroupNumber() * uint(TILE_SAMPLES) + me;
  float most = fastestSplatted(), scale = momentumScale();
  if (me < count) {
    uvec2 of = divided(me, tile.pieces);  // strand and piece
    uint root = roots[tile.first_strand + of.x], piece = tile.first_piece + of.y;
    vec3 t = directionOfPiece(chordOf(tile, root, piece));
    spots[me] = vec4(t, sampleOf(tile, root, piece).mass);
  }
  barrier();
  // Permutes the samples from the order along strands to the order in which neighbours in space are adjacent.
  vec3 at = vec3(-1);
  vec4 parts[2] = vec4[2](vec4(0), vec4(0));
  if (me < count) {
    at = placeOf(sample_);
    vec4 found = spots[(order[sample_] & 0xFFFFu) * tile.pieces + (order[sample_] >> 16u)];
    vec3 t = found.xyz, motion = clamp(motionOf(sample_), vec3(-most), vec3(most));
    parts[0] = found.w * vec4(t * (dot(t, motion) * scale), t.x * t.x * air.mass_scale);
    parts[1] = found.w * air.mass_scale * vec4(t.y * t.y, t.y * t.z, t.x * t.z, t.x * t.y);
  }
  bool counts = isInGrid(at);
  for (int part = 0; part < 2; ++part) {
    barrier();
    if (counts) {
      put(me, placeAmong(at), parts[part]);
      first_nodes[me] += part * air.cells * air.cells * air.cells;
    } else {
      discardSample(me);
    }
    barrier();
    spread(count);
  }
}
