#version 450
// Runs one kernel on every item of an array, for kernel_conformance_test.
layout(local_size_x = 64) in;

#include "kernels/lanes_glsl.h"
#include "kernels/rotation.h"
#include "kernels/strand.h"
#include "kernels/contact.h"
#include "kernels/distance_field.h"
#include "kernels/grid.h"
#include "tests/conformance/shaders/kernel_cases.h"

layout(std430, binding = 0) readonly buffer Inputs { float inputs[]; };     // [16][count]
layout(std430, binding = 1) writeonly buffer Outputs { float outputs[]; };  // [9][count]
uniform int kernel;
uniform int count;

void main() {
  int item = int(gl_GlobalInvocationID.x);
  if (item >= count) return;
  KernelInput i;
  for (int c = 0; c < 16; ++c) i.v[c] = inputs[c * count + item];
  KernelOutput o = runKernel(kernel, i);
  for (int c = 0; c < 9; ++c) outputs[c * count + item] = o.v[c];
}
