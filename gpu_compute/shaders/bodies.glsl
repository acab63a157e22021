// Contact with the bodies of a step. Needs step_input.glsl and kernels/contact.h.

// A body at the end of a substep.
struct SubstepBody {
  uint kind;
  vec3 a, b;                // m
  vec3 a_motion, b_motion;  // m, over the substep
  vec3 spin;                // rad/s
  float radius, friction;
};

// `time`: the part of the step that has passed then, 0 to 1.
SubstepBody bodyAt(uint index, float time) {
  Primitive p = primitives[index];
  vec3 a_step = p.a_end - p.a_begin_radius.xyz, b_step = p.b_end.xyz - p.b_begin_friction.xyz;
  float part = 1.0 / float(settings.substeps);
  return SubstepBody(p.kind, madd(a_step, time, p.a_begin_radius.xyz), madd(b_step, time, p.b_begin_friction.xyz),
                     a_step * part, b_step * part, p.angular_velocity.xyz, p.a_begin_radius.w, p.b_begin_friction.w);
}

// Pushes x out of the body and takes back slip; where it does, `normal` is the body's there. start: x before the substep.
void pushOut(SubstepBody body, vec3 start, inout vec3 x, inout vec3 normal) {
  vec3 out_normal, axis_point = body.a, axis_motion = body.a_motion;
  float distance;
  if (body.kind == 0u) {
    distance = sphereDistance(x, body.a, body.radius, out_normal);
  } else if (body.kind == 1u) {
    float along;
    distance = capsuleDistance(x, body.a, body.b, body.radius, out_normal, along);
    axis_point = madd(body.b - body.a, along, body.a);
    axis_motion = madd(body.b_motion - body.a_motion, along, body.a_motion);
  } else {
    distance = planeDistance(x, body.a, body.b, out_normal);
  }
  distance -= settings.hair_radius;
  if (distance < 0.0) {
    vec3 motion = surfaceMotion(x, axis_point, axis_motion, body.spin, settings.substep);
    x = resolveContact(x, start, motion, out_normal, distance, body.friction);
    normal = out_normal;
  }
}
