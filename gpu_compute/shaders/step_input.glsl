// What a step is told: settings, root poses and bodies, in the slot of the upload ring that is bound for it.

struct Primitive {  // core/contact_primitive.h
  vec4 a_begin_radius;
  vec3 a_end;
  uint kind;
  vec4 b_begin_friction;
  vec4 b_end;
  vec4 angular_velocity;
};

layout(std140, binding = 0) uniform Settings {  // gpu_compute/gpu_layout.h
  vec4 gravity;
  vec4 wind;
  float keep;           // exp(-drag substep)
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
  uint primitive_count;
  uint strand_count;
} settings;
layout(std430, binding = 6) readonly buffer Roots { float roots[]; };  // 7 per strand: begin poses, then end poses
layout(std430, binding = 7) readonly buffer Primitives { Primitive primitives[]; };

struct Pose {
  vec3 position;
  vec4 rotation;
};

Pose rootPose(uint index) {
  uint at = index * 7u;
  return Pose(vec3(roots[at], roots[at + 1u], roots[at + 2u]),
              vec4(roots[at + 3u], roots[at + 4u], roots[at + 5u], roots[at + 6u]));
}
