#version 450
// Values of the functions of kernels/fibre.h and kernels/fibre_table.h, for FibreShaderProbe.
layout(local_size_x = 64) in;

layout(std430, binding = 0) readonly buffer Table { float fibre_table[]; };
layout(std430, binding = 1) readonly buffer Inputs { float inputs[]; };     // [9][count]
layout(std430, binding = 2) writeonly buffer Outputs { float outputs[]; };  // [3][count]
#define FIBRE_TABLE_PARAMETER
#define FIBRE_TABLE
#define FIBRE_TEXEL(i) fibre_table[int(i)]
#include "kernels/lanes_glsl.h"
#include "kernels/fibre.h"
#include "kernels/fibre_table.h"

uniform int count;
uniform int kind;  // FibreFunction
uniform float variance, scale, index, rows, columns;
uniform vec3 tilt_sin, tilt_cos, shift, width;

// Of one channel, f cos(theta_i) of the near field.
float nearField(FibreShape shape, FibreRay ray, FibreLobes densities, float sigma) {
  return fibreSum(fibreShares(ray.fresnel, exp(-sigma * ray.passage)), densities);
}

void main() {
  int item = int(gl_GlobalInvocationID.x);
  if (item >= count) return;
  float v[9];
  for (int k = 0; k < 9; ++k) v[k] = inputs[k * count + item];
  FibreShape shape = FibreShape(variance, scale, index, tilt_sin, tilt_cos);
  FibreTableSize size = FibreTableSize(rows, columns, 0.0);
  MarschnerLobes lobes = MarschnerLobes(shift, width);
  vec3 sigma = vec3(v[6], v[7], v[8]);
  vec3 value = vec3(0);
  if (kind == 0) {
    value = vec3(logBesselI0(v[0]), fibreLog(v[0]), fibreAsin(v[1]));
  } else if (kind == 1) {
    FibreRay ray = fibreRay(v[0], v[1], v[5], index);
    FibreLobes densities = fibreDensities(shape, ray, v[0], v[1], v[2], v[3], v[4]);
    value = vec3(nearField(shape, ray, densities, sigma.x), nearField(shape, ray, densities, sigma.y),
                 nearField(shape, ray, densities, sigma.z));
  } else if (kind == 2) {
    value = chiangFarField(size, shape, v[0], v[1], v[2], v[3], v[4], sigma);
  } else if (kind == 3) {
    value = marschnerFarField(size, lobes, v[0], v[1], v[2], v[3], v[4], sigma);
  } else {
    value = marschnerEllipticFarField(size, lobes, v[0], v[1], v[2], v[3], v[4], v[5], sigma);
  }
  for (int k = 0; k < 3; ++k) outputs[k * count + item] = value[k];
}
