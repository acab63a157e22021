#version 450
// variants: THREADS=4 WORKGROUP=32 GROOMED=0 ACCELERATED=1 SHAPE_KINDS=1 | THREADS=32 WORKGROUP=32 GROOMED=1 ACCELERATED=0 SHAPE_KINDS=1 | THREADS=128 WORKGROUP=128 GROOMED=0 ACCELERATED=0 SHAPE_KINDS=2 | THREADS=32 WORKGROUP=32 GROOMED=2 ACCELERATED=0 SHAPE_KINDS=1
// PBD solver (gauss_seidel): one step of the strands of a group, all substeps in one dispatch. The CPU's counterpart is
// core/gauss_seidel_sweep.inl.
// Reads: settings, bones, bodies, rest shape, external accelerations. Writes: positions, velocities, guides.
// One invocation per vertex, WORKGROUP / THREADS strands per workgroup. Edge i, from vertex i to i + 1, belongs to the
// invocation of vertex i.
// THREADS: invocations per strand, a power of 2 from 4 to 128; at least the strand's vertices.
// WORKGROUP: invocations per workgroup, max(32, THREADS).
// GROOMED: 0: no goal, no tethers, all grooming factors are 1.
//          1: some strands have them.
//          2: and the factor of friction differs along strands.
// ACCELERATED: 0, 1: every vertex has an external acceleration.
// SHAPE_KINDS: 1 or 2, see bodies.glsl.
layout(local_size_x = WORKGROUP) in;

#include "kernels/lanes_glsl.h"
#include "kernels/rotation.h"
#include "kernels/strand.h"
#include "kernels/contact.h"
#include "kernels/distance_field.h"
#include "gpu_compute/shaders/step_input.glsl"
#include "gpu_compute/shaders/bodies.glsl"

layout(std430, binding = 0) buffer Positions { vec4 positions[]; };            // xyz, m; w: tension of the rod, unused here
layout(std430, binding = 1) buffer Velocities { vec4 velocities[]; };          // xyz, m/s; w: distance from bodies at rest, m
layout(std430, binding = 2) readonly buffer RestLocal { vec4 rest_local[]; };  // xyz, m; w: inverse mass; see bonePoint()
layout(std430, binding = 3) readonly buffer RestEdge { vec4 rest_edge[]; };    // xyz: restEdges(), m; w: rest length, m
layout(std430, binding = 5) readonly buffer Order { uint order[]; };           // strand numbers, sorted by group
layout(location = 0) uniform uint first_strand;                                // of this group: index in order[]
layout(location = 1) uniform uint strands_in_group;

shared vec4 shared_position[WORKGROUP];  // w: inverse mass
shared vec4 shared_frame[2][WORKGROUP];  // two banks: a scan step needs one barrier

// Rotation that takes the rest edge k to its target direction: the product of the parallel transports over all edges
// before it and the root's rotation. An inclusive scan that keeps the order of the factors.
vec4 frameOfEdge(int k, uint me, vec3 x, vec4 root) {
  vec3 tangent = rotate(root, vec3(0, 0, 1)), before = tangent;
  vec3 previous = shared_position[k >= 1 ? me - 1u : me].xyz;
  vec3 one_more = shared_position[k >= 2 ? me - 2u : me].xyz;
  if (k >= 1) tangent = normalizeOrZero(x - previous);
  if (k >= 2) before = normalizeOrZero(previous - one_more);
  vec4 frame = k >= 1 ? transportFrame(before, tangent) : root;
  int bank = 0;
  for (int stride = 1; stride < THREADS; stride *= 2) {
    shared_frame[bank][me] = frame;
    barrier();
    vec4 other = shared_frame[bank][k >= stride ? me - uint(stride) : me];
    if (k >= stride) frame = multiply(frame, other);
    bank = 1 - bank;
  }
  return frame;
}

// Position of the vertex after contact with the deepest body. `clear`: clearance, m, which clearanceOf() reduces for bodies
// that cover the root.
vec3 resolveContacts(uint strand, vec3 x, vec3 start, float clear, Cover cover, float arc_length, float friction_scale,
                     int substep) {
  ContactPlane plane = noContact(x, contactReach());
  uvec2 range = nearRange(strand);
  for (uint i = range.x; i < range.y; ++i) {
    float own_clear = clearanceOf(cover, i - range.x, clear, arc_length);
    ContactPlane own = closestContact(bodyAt(nearBody(i), substep), x, start, own_clear, contactReach());
    if (own.gap < plane.gap) plane = own;
  }
  if (plane.gap >= 0.0) return x;
  vec3 force = vec3(0);
  return resolveContact(x, plane.carried, plane.normal, plane.gap, plane.friction * friction_scale, 1.0, force);
}

void main() {
  const uint strands_per_workgroup = uint(WORKGROUP / THREADS);
  uint me = gl_LocalInvocationID.x;
  int k = int(me) % THREADS;
  uint workgroup = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
  uint slot = workgroup * strands_per_workgroup + me / uint(THREADS);
  // Invocations past the last strand or the last vertex work on copies, because all must reach every barrier.
  bool exists = slot < strands_in_group;
  uint strand = order[first_strand + min(slot, strands_in_group - 1u)];
  uint first = offsets[strand];
  int vertices = int(offsets[strand + 1u] - first);
  bool stores = exists && k < vertices;
  uint vertex = first + uint(min(k, vertices - 1));
  bool has_edge = k + 1 < vertices;

  vec3 x = positions[vertex].xyz, v = velocities[vertex].xyz;
  float clear = clearance(velocities[vertex]), root_clear = clearance(velocities[first]), arc_length = 0.0;
  vec4 local = rest_local[vertex], edge = rest_edge[vertex];
  if (settings.body_count > 0u)
    for (uint inner = first; inner < vertex; ++inner) arc_length += rest_edge[inner].w;
  float inverse_mass = max(local.w, 0.0);
#if GROOMED
  float keep = keepOf(vertex), time2 = time2Of(vertex), goal_rate = goalRateOf(vertex), friction_scale = grooming[first].x;
#if GROOMED == 2
  friction_scale = frictionAndDampingOf(vertex).x;
#endif
#else
  const float keep = settings.keep, time2 = settings.time2, friction_scale = 1.0;
#endif
  const RootPoses root_poses = rootPoses(strand);
  const Pose root_begin = root_poses.begin, root_end = root_poses.end;
  float along = vertices > 2 ? float(k) / float(vertices - 2) : 0.0;
  float strength = settings.strength_root + along * (settings.strength_tip - settings.strength_root);

  vec3 root_before = root_begin.position;
  for (uint substep = 0u; substep < settings.substeps; ++substep) {
    float time = timeAfter(int(substep));
    vec3 root_position = madd(root_end.position - root_begin.position, time, root_begin.position);
    vec4 root = interpolateRotation(root_begin.rotation, root_end.rotation, time);
    Cover cover = coverOf(strand, root_before, root_position, root_clear, rest_edge[first].w, int(substep));
    root_before = root_position;
    vec3 start = x;
#if ACCELERATED
    vec3 gravity = settings.gravity.xyz + accelerationOf(vertex);
#else
    vec3 gravity = settings.gravity.xyz;
#endif
    vec3 free = predictPosition(x, v, gravity, settings.wind.xyz, keep, settings.substep, time2);
    vec3 held = local.w < 0.0 ? bonePoint(local, time) : rotate(root, local.xyz) + root_position;
#if GROOMED
    free = drawnToGoal(free, held, goal_rate, time2);
#endif
    x = inverse_mass < 0.5 ? held : free;
    shared_position[me] = vec4(x, inverse_mass);
    barrier();

    for (uint iteration = 0u; iteration < settings.iterations; ++iteration) {
      vec4 frame = frameOfEdge(k, me, x, root);  // its barriers separate these reads from the writes below
      vec3 target = rotate(frame, edge.xyz);
      for (int color = 0; color < 3; ++color) {
        if (has_edge && k % 3 == color) {
          vec4 a = shared_position[me], b = shared_position[me + 1u];
          vec4 before = vec4(a.xyz - rotate(root, vec3(0, 0, 1)), 0);  // the root frame is the edge before the first
          if (k > 0) before = shared_position[me - 1u];
          solveAngular(before.xyz, a.xyz, b.xyz, before.w, a.w, b.w, target, strength);
          if (k > 0) shared_position[me - 1u] = before;
          shared_position[me] = a;
          shared_position[me + 1u] = b;
        }
        barrier();
      }
      for (int color = 0; color < 2; ++color) {
        if (has_edge && (k & 1) == color) {
          vec4 a = shared_position[me], b = shared_position[me + 1u];
          solveDistance(a.xyz, b.xyz, a.w, b.w, edge.w);
          shared_position[me] = a;
          shared_position[me + 1u] = b;
        }
        barrier();
      }
      x = shared_position[me].xyz;
#if GROOMED
      if (inverse_mass > 0.5) x = tethered(x, shared_position[me - uint(k)].xyz, grooming[vertex].z);
#endif
      if (inverse_mass > 0.5) x = resolveContacts(strand, x, start, clear, cover, arc_length, friction_scale, int(substep));
      shared_position[me] = vec4(x, inverse_mass);
      barrier();
    }
    v = (x - start) * settings.per_substep;
  }

  if (stores) {
    positions[vertex].xyz = x;
    velocities[vertex].xyz = v;
    storeGuide(vertex, x);
  }
}
