#version 450
// The next direction of the conjugate gradients and its image under the pressure's system.
#define FINE 1
#include "kernels/lanes_glsl.h"
#include "gpu_compute/shaders/pressure_level.glsl"
#include "gpu_compute/shaders/pressure_tile.glsl"
layout(std430, binding = 2) readonly buffer Results { float results[]; };  // of the V-cycle
layout(std430, binding = 3) readonly buffer Products { float partial_products[]; };
layout(std430, binding = 6) readonly buffer Steps { float steps[]; };
layout(std430, binding = 7) writeonly buffer NewSteps { float new_steps[]; };
layout(std430, binding = 9) writeonly buffer Images { float images[]; };
layout(std430, binding = 10) writeonly buffer NewProducts { float partial_images[]; };
layout(location = 2) uniform int odd;    // iterations so far are
layout(location = 3) uniform int first;  // there is no direction yet

shared float step_[NEAR * NEAR * NEAR];

void main() {
  if (solve.done != 0) return;
  int me = int(gl_LocalInvocationIndex);
  float product = 0.0;
  for (uint n = uint(me); n < tiles(); n += uint(INVOCATIONS)) product += partial_products[n];
  float now = sumOf(product), turn = first != 0 ? 0.0 : now / solve.products[1 - odd];
  if (me == 0 && tileNumber() == 0u) solve.products[odd] = now;
  for (int n = me; n < NEAR * NEAR * NEAR; n += INVOCATIONS) {
    ivec3 c = cellOfBlock(n, 1);
    float value = 0.0;
    if (isOnLevel(c)) {
      int at = levelAt(c);
      value = results[at];
      if (first == 0) value = madd(steps[at], turn, value);
      if (isOwn(c)) new_steps[at] = value;
    }
    step_[n] = value;
  }
  barrier();
  ivec3 own = ivec3(gl_GlobalInvocationID);
  float along_ = 0.0;
  if (isOnLevel(own)) {
    Stencil s = stencilOf(own);
    int at = placeInBlock(own, 1);
    float image = s.diagonal * step_[at] - NEIGHBOURS(step_, at, NEAR, NEAR * NEAR, s);
    images[levelAt(own)] = image;
    along_ = step_[at] * image;
  }
  float sum = sumOf(along_);
  if (me == 0) partial_images[tileNumber()] = sum;
}
