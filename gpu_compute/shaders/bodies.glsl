// Contact with the bodies of a step: core/strand_sweep.inl has the same for the CPU. Needs step_input.glsl and
// kernels/contact.h.

// A body at the end of a substep.
struct SubstepBody {
  uint kind;
  vec3 a, b;      // m
  vec3 a_motion;  // m, over the substep
  vec3 turn;      // radians, over the substep, about a
  float radius, friction;
};

// `time`: the part of the step that has passed then, 0 to 1.
SubstepBody bodyAt(uint index, float time) {
  Primitive p = primitives[index];
  vec3 a_step = p.a_end - p.a_begin_radius.xyz, b_step = p.b_end.xyz - p.b_begin_friction.xyz;
  return SubstepBody(p.kind, madd(a_step, time, p.a_begin_radius.xyz), madd(b_step, time, p.b_begin_friction.xyz),
                     a_step * (1.0 / float(settings.substeps)), p.angular_velocity.xyz * settings.substep,
                     p.a_begin_radius.w, p.b_begin_friction.w);
}

// Distance of hair at x from the body, m.
float gapTo(SubstepBody body, vec3 x, out vec3 normal) {
  float distance, along;
  if (body.kind == 0u) distance = sphereDistance(x, body.a, body.radius, normal);
  else if (body.kind == 1u) distance = capsuleDistance(x, body.a, body.b, body.radius, normal, along);
  else distance = planeDistance(x, body.a, body.b, normal);
  return distance - settings.hair_radius;
}

// The body that is nearest to a vertex, or that its way has met.
struct Touch {
  float gap;      // m, to its surface, or to the plane through where the way met it
  vec3 normal;    // of the same
  vec3 carried;   // m, where the surface has taken the point at which the vertex was
  float friction;
};
Touch untouched(vec3 x) { return Touch(1e9, vec3(0), x, 0.0); }

// Looks whether this body is nearer to a vertex that goes from `start` to x in the substep; see core/strand_sweep.inl.
void meet(SubstepBody body, vec3 x, vec3 start, inout Touch nearest) {
  const int kAdvances = 4;
  vec3 carried = carriedBy(start, body.a, body.a_motion, body.turn);
  vec3 way = x - carried;
  float way2 = dot(way, way);
  vec3 normal, at_normal;
  float gap = gapTo(body, x, normal);
  if (gap < 0.0 || gap * gap < way2) {
    float free = gapTo(body, carried, at_normal);
    if (dot(at_normal, normal) < 0.5) {
      float per_way = inverseSqrt(max(way2, 1e-30)), part = 0.0;
      vec3 at = carried;
      for (int i = 0; i < kAdvances; ++i) {
        part = min(madd(max(free, 0.0), per_way, part), 1.0);
        at = madd(way, part, carried);
        free = gapTo(body, at, at_normal);
      }
      gap = free + dot(at_normal, x - at);
      normal = at_normal;
    }
  }
  if (gap < nearest.gap) nearest = Touch(gap, normal, carried, body.friction);
}
