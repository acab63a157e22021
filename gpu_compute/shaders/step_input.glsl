// Input of a step: settings, poses of bones and roots, and bodies, as UploadRing (gpu_compute/mapped_rings.h) uploads them;
// offsets of strands, and grooming factors. Requires kernels/rotation.h.
// ACCELERATED: 0, 1: every vertex has an external acceleration. Undefined counts as 0, as for GROOMED.
// GROOMED: 0: no grooming factors.
//          1: factors of friction and damping time are constant along each strand.
//          2: they may differ along strands.

struct PlacedBody {  // units and frames: gpu_compute/step_input.h
  vec3 middle;
  float ball;
  vec3 a;
  float radius;
  vec3 b;
  float radius_b;
  vec3 a_motion;
  float friction;
  vec3 turn;
  uint kind;
  vec4 rotation;
  vec3 extent;
  uint data;
  uint extra;
  uint leader;
  float time;
  float bend_shift;
};
const float kMotionTolerance = 1e-4;            // m, bound on how differently bodies with one leader move points in a step
layout(std140, binding = 0) uniform Settings {  // gpu_compute/step_input.h
  vec4 gravity;
  vec4 wind;
  float keep;           // exp(-drag substep)
  float time2;          // s^2, displacement in a substep per acceleration: see DragStep
  float substep;        // s
  float per_substep;    // 1 / substep
  float strength_root;  // of the angular constraint, per iteration
  float strength_tip;
  float damping_time;  // s, of the rod
  float hair_radius;   // m
  float air_drag;      // 1/s, before a strand's grooming factor
  float goal_rate;     // 1/s
  uint substeps;
  uint iterations;
  uint body_count;
  uint strand_count;
  uint bone_count;
  uint neighbourhoods;  // number of near-body lists; 0: every strand may touch every body
}
settings;

// Fraction of the step that has passed at the end of a substep, 0 to 1.
float timeAfter(int substep) { return float(substep + 1) / float(settings.substeps); }

// 7 floats per pose, position then rotation x y z w: bones at the start of the step, bones at its end, then the rest poses
// of the strands' roots in the groom's frame.
layout(std430, binding = 6) readonly buffer Poses { float poses[]; };
// body_count bodies at the end of the first substep, then of the second, and so on.
layout(std430, binding = 7) readonly buffer Bodies { PlacedBody bodies[]; };
PlacedBody bodyAt(uint index, int substep) { return bodies[uint(substep) * settings.body_count + index]; }
// ShapeData::words of core/contact_primitive.h.
layout(std430, binding = 14) readonly buffer Shapes { uint shape_words[]; };
// Near-body lists: neighbourhoods + 1 offsets, then the lists; then the same for the leaders of these bodies, each leader
// once per list.
layout(std430, binding = 15) readonly buffer Near { uint near_bodies[]; };
// 3 floats per vertex. ACCELERATED: external accelerations, m/s^2, until the step stores the vertex's new position, m.
// Both share a buffer because a further one would exceed the storage buffers that every driver supports.
layout(std430, binding = 8) buffer Guides { float guides[]; };
void storeGuide(uint vertex, vec3 position) {
  guides[vertex * 3u] = position.x;
  guides[vertex * 3u + 1u] = position.y;
  guides[vertex * 3u + 2u] = position.z;
}

#if ACCELERATED
vec3 accelerationOf(uint vertex) { return vec3(guides[3u * vertex], guides[3u * vertex + 1u], guides[3u * vertex + 2u]); }
#endif

struct Pose {
  vec3 position;
  vec4 rotation;
};

Pose poseAt(uint index) {
  uint at = index * 7u;
  return Pose(vec3(poses[at], poses[at + 1u], poses[at + 2u]),
              vec4(poses[at + 3u], poses[at + 4u], poses[at + 5u], poses[at + 6u]));
}

// As Pose::apply() of core/geometry.h.
vec3 apply(Pose pose, vec3 point) { return rotate(pose.rotation, point) + pose.position; }

// Position of a vertex that a bone prescribes, at `time` (fraction of the step that has passed). `local`: its rest_local
// entry. w < 0: -1 - bone number; xyz: position in the groom's frame, m.
vec3 bonePoint(vec4 local, float time) {
  uint bone = uint(-local.w) - 1u;
  vec3 begin = apply(poseAt(bone), local.xyz), end = apply(poseAt(bone + settings.bone_count), local.xyz);
  return madd(end - begin, time, begin);
}

// strand_count + 1 offsets: the first vertex of each strand, then the number of vertices. Then per strand its
// neighbourhood, then per strand the bone that carries its root.
layout(std430, binding = 4) readonly buffer Offsets { uint offsets[]; };

#if GROOMED
// Grooming factors, which multiply the settings of all hair, and tethers (kernels/strand.h).
// One entry per vertex. At a strand's root: factors of friction (x) and of the damping time (y). At its other vertices:
// factors of air drag (x) and of the goal's rate (y), and the length of the tether (z, m). GROOMED 2: the second half of
// the buffer holds the factors of friction (x) and damping time (y) of each vertex and its joint.
layout(std430, binding = 13) readonly buffer Grooming { vec4 grooming[]; };

float airDragOf(uint vertex) { return settings.air_drag * grooming[vertex].x; }
// DragStep::keep and DragStep::time2 (core/backend.h) with the vertex's air drag.
float keepOf(uint vertex) { return exp(-airDragOf(vertex) * settings.substep); }
float time2Of(uint vertex) {
  const float x = airDragOf(vertex) * settings.substep;
  const float small = madd(-x, madd(-x, madd(-x, madd(-x, 1.0 / 120.0, 1.0 / 24.0), 1.0 / 6.0), 0.5), 1.0);
  return settings.substep * settings.substep * (x < 0.1 ? small : (1.0 - exp(-x)) / x);
}
#if GROOMED == 2
vec2 frictionAndDampingOf(uint vertex) { return grooming[uint(grooming.length()) / 2u + vertex].xy; }
#endif
float goalRateOf(uint vertex) { return settings.goal_rate * grooming[vertex].y; }

#endif

// Poses of the strands' roots, carried by their bones.
struct RootPoses {
  Pose begin, end;  // at the start and the end of the step
};

Pose carriedRoot(Pose rest, Pose bone) { return Pose(apply(bone, rest.position), multiply(bone.rotation, rest.rotation)); }
RootPoses rootPoses(uint strand) {
  const uint bones = settings.bone_count, bone = offsets[2u * settings.strand_count + 1u + strand];
  const Pose rest = poseAt(2u * bones + strand);
  return RootPoses(carriedRoot(rest, poseAt(bone)), carriedRoot(rest, poseAt(bone + bones)));
}
