#version 450
// variants: TURNING=0 | TURNING=1
// Strands that exact lengths have placed in a body in this substep, or that have come too far from where they looked at
// bodies: every vertex, from the root on, is held to the side of the bodies it was on. RodStep::keptOut in
// core/rod_sweep.inl. An invocation does a strand, one vertex after another. TURNING: see bodies.glsl.
#define WORKGROUP 32
layout(local_size_x = WORKGROUP) in;

#include "kernels/lanes_glsl.h"
#include "kernels/rotation.h"
#include "kernels/contact.h"
#include "kernels/distance_field.h"
#include "gpu_compute/shaders/step_input.glsl"
#include "gpu_compute/shaders/strand_offsets.glsl"
#include "gpu_compute/shaders/bodies.glsl"
#include "gpu_compute/shaders/contact_sights.glsl"
#include "gpu_compute/shaders/contact_look.glsl"
layout(std430, binding = 0) buffer Positions { vec4 positions[]; };            // xyz, m
layout(std430, binding = 1) buffer Velocities { vec4 velocities[]; };          // xyz, m/s; w: rest distance from bodies, m
layout(std430, binding = 5) readonly buffer Work { uint work[]; };             // see rod_strand.glsl
layout(std430, binding = 11) readonly buffer Edges { vec4 edge_rest[]; };      // length, twist; mass, weight of its end
layout(location = 2) uniform uint lost_dispatch;
layout(location = 3) uniform uint lost_list;
layout(location = 4) uniform int substep;

// `inner`: where its edge starts.
vec3 turnedOutOfBodies(uint vertex, vec3 x, vec3 inner, float edge_length) {
  for (int round = 0; round < 3; ++round) {
    Touch touch = touchOf(vertex, x);
    if (touch.gap >= -contactSlack()) break;
    x = round < 2 ? turnedTowards(x, inner, touch.normal, touch.gap, edge_length)
                  : turnedOut(x, inner, touch.normal, lastTurn(touch.gap), edge_length);
  }
  return x;
}

void keepOut(uint strand) {
  vec3 inner = positions[offsets[strand]].xyz, moved = vec3(0);
  for (uint vertex = offsets[strand] + 1u; vertex < offsets[strand + 1u]; ++vertex) {
    vec4 edge = edge_rest[vertex - 1u], velocity = velocities[vertex];
    vec3 reached = positions[vertex].xyz, x = reached;
    if (edge.w > 0.0) {
      x += moved;
      bool displaced = contacts[vertex].w > 0.5 || dot(moved, moved) > 0.0;
      if (displaced && looksBack(vertex, x)) {
        vec3 start = madd(velocity.xyz, -settings.substep, reached);
        look(strand, vertex, x, start, clearance(velocity), substep);
        if (seesPlanes(contacts[sightOf(vertex) + kLooked])) x = turnedOutOfBodies(vertex, x, inner, edge.x);
      }
    }
    moved = x - reached;
    inner = x;
    if (dot(moved, moved) == 0.0) continue;
    positions[vertex].xyz = x;
    velocities[vertex].xyz = madd(moved, settings.per_substep, velocity.xyz);
    if (substep + 1 == int(settings.substeps)) storeGuide(vertex, x);
  }
}

void main() {
  const uint count = work[lost_dispatch + 3u];
  for (uint at = gl_GlobalInvocationID.x; at < count; at += gl_NumWorkGroups.x * uint(WORKGROUP))
    keepOut(work[lost_list + at]);
}
