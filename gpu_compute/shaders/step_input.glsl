// What a step is told: settings, poses of roots and bones, and bodies, in the slot of the upload ring that is bound for it.
// Needs kernels/rotation.h.

struct PlacedBody {  // gpu_compute/placed_bodies.h
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
const float kAlike = 1e-4;  // m, by which bodies with one leader may move strands differently in a step
layout(std140, binding = 0) uniform Settings {  // gpu_compute/gpu_layout.h
  vec4 gravity;
  vec4 wind;
  float keep;           // exp(-drag substep)
  float time2;          // s^2, of an acceleration how far it takes a vertex in a substep: see DragStep
  float substep;        // s
  float per_substep;    // 1 / substep
  float strength_root;  // of the angular constraint, per iteration
  float strength_tip;
  float damping_time;   // s, of the rod
  float hair_radius;
  float air_drag;       // 1/s, where it differs between strands
  float goal_rate;      // 1/s
  uint substeps;
  uint iterations;
  uint body_count;
  uint strand_count;
  uint bone_count;
  uint neighbourhoods;  // with lists of near bodies; 0 = every strand may touch every body
} settings;

// The part of the step that has passed at the end of a substep.
float timeAfter(int substep) { return float(substep + 1) / float(settings.substeps); }

// 7 per pose: of bones at the beginning of the step, then at its end; of the strands' roots at rest, in the groom's frame.
layout(std430, binding = 6) readonly buffer Poses { float poses[]; };
// body_count at the end of the first substep, then of the next, and so on.
layout(std430, binding = 7) readonly buffer Bodies { PlacedBody bodies[]; };
PlacedBody bodyAt(uint index, int substep) { return bodies[uint(substep) * settings.body_count + index]; }
layout(std430, binding = 14) readonly buffer Shapes { uint shape_words[]; };
// Where the list of each neighbourhood starts (one more than there are), then the lists; then the same of the leaders of these
// bodies, each once.
layout(std430, binding = 15) readonly buffer Near { uint near_bodies[]; };
// 3 per vertex. What the step gives: positions. ACCELERATED: what is told until then, accelerations in m/s^2; a buffer of
// their own would be one more than every driver takes.
layout(std430, binding = 8) buffer Guides { float guides[]; };
void storeGuide(uint vertex, vec3 position) {
  guides[vertex * 3u] = position.x;
  guides[vertex * 3u + 1u] = position.y;
  guides[vertex * 3u + 2u] = position.z;
}

#if ACCELERATED
vec3 accelerationOf(uint vertex) {
  return vec3(guides[3u * vertex], guides[3u * vertex + 1u], guides[3u * vertex + 2u]);
}
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

// Where its bone holds a vertex at `time`, the part of the step that has passed; of a rest_local entry with w < 0:
// minus 1 minus the bone's number, and the position in the groom's frame.
vec3 bonePoint(vec4 local, float time) {
  uint bone = uint(-local.w) - 1u;
  vec3 begin = apply(poseAt(bone), local.xyz), end = apply(poseAt(bone + settings.bone_count), local.xyz);
  return madd(end - begin, time, begin);
}
