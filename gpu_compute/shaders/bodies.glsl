// Contact with the bodies of a step. Needs step_input.glsl, kernels/contact.h and kernels/distance_field.h, and offsets[].

// From and to: what nearBody() may be asked for, of the bodies that a strand may touch.
uvec2 nearRange(uint strand) {
  if (settings.neighbourhoods == 0u) return uvec2(0u, settings.primitive_count);
  uint neighbourhood = offsets[settings.strand_count + 1u + strand];
  return settings.neighbourhoods + 1u + uvec2(near_bodies[neighbourhood], near_bodies[neighbourhood + 1u]);
}
uint nearBody(uint i) { return settings.neighbourhoods == 0u ? i : near_bodies[i]; }

// A body at the end of a substep.
struct SubstepBody {
  uint kind;
  vec3 a, b;                // m
  vec3 a_motion, b_motion;  // m, over the substep
  vec3 spin;                // rad/s
  float radius, radius_b, friction;
  vec4 rotation;            // of kinds that have one
  vec3 extent;
  uint data, planes;        // of its shape in shape_words
};

// `time`: the part of the step that has passed then, 0 to 1.
SubstepBody bodyAt(uint index, float time) {
  Primitive p = primitives[index];
  vec3 a_step = p.a_end - p.a_begin_radius.xyz, b_step = p.b_end_radius.xyz - p.b_begin_friction.xyz;
  float part = 1.0 / float(settings.substeps);
  vec4 rotation = p.kind < kEllipsoid ? vec4(0, 0, 0, 1) : interpolateRotation(p.rotation_begin, p.rotation_end, time);
  return SubstepBody(p.kind, madd(a_step, time, p.a_begin_radius.xyz), madd(b_step, time, p.b_begin_friction.xyz),
                     a_step * part, b_step * part, p.angular_velocity, p.a_begin_radius.w, p.b_end_radius.w,
                     p.b_begin_friction.w, rotation, p.extent, p.data, p.planes);
}

float shapeNumber(uint at) { return uintBitsToFloat(shape_words[at]); }
vec3 shapeVector(uint at) { return vec3(shapeNumber(at), shapeNumber(at + 1u), shapeNumber(at + 2u)); }

float convexDistance(SubstepBody body, vec3 x, out vec3 normal) {
  float nearest = -1e9;
  normal = vec3(0, 1, 0);
  for (uint i = 0u; i < body.planes; ++i) {
    uint at = body.data + 4u * i;
    convexPlane(x, shapeVector(at), shapeNumber(at + 3u), nearest, normal);
  }
  return nearest;
}

// Number n of eight that stand about a point with these strides: samples of the brick whose words start at `at`, or
// distances at the corners of bricks.
float fieldNumber(bool stored, uint at, uint n) {
  if (!stored) return shapeNumber(at + n);
  uint word = shape_words[at + n / 2u];
  return float(bitfieldExtract(int(word), int(16u * (n & 1u)), 16));
}

// core/body_surface.inl, fieldDistanceAt; core/distance_field.h has the layout.
float fieldDistanceAt(SubstepBody body, vec3 x, float clear, out vec3 normal) {
  uint at = body.data;
  float cell = shapeNumber(at + 3u), band = shapeNumber(at + 7u), quantum = shapeNumber(at + 8u);
  uvec3 bricks = uvec3(shape_words[at + 4u], shape_words[at + 5u], shape_words[at + 6u]);
  FieldPlace place = fieldPlace(x, shapeVector(at), cell, vec3(bricks));
  uint entry = shape_words[shape_words[at + 9u] + uint(place.brick)];
  normal = vec3(0, 1, 0);
  if (entry == kOutsideBrick) return max(clear, band);
  bool stored = entry < kInsideBrick;
  uint from = stored ? shape_words[at + 10u] + entry * kBrickWords : shape_words[at + 11u];
  uint n = uint(stored ? place.first_sample : place.corner);
  uint row = stored ? kBrickSide : bricks.x + 1u, slice = stored ? kBrickSide * kBrickSide : row * (bricks.y + 1u);
  FieldCorners about;
  about.v000 = fieldNumber(stored, from, n);
  about.v100 = fieldNumber(stored, from, n + 1u);
  about.v010 = fieldNumber(stored, from, n + row);
  about.v110 = fieldNumber(stored, from, n + row + 1u);
  about.v001 = fieldNumber(stored, from, n + slice);
  about.v101 = fieldNumber(stored, from, n + slice + 1u);
  about.v011 = fieldNumber(stored, from, n + slice + row);
  about.v111 = fieldNumber(stored, from, n + slice + row + 1u);
  about.side = stored ? 0.0 : -1.0;
  return fieldDistance(place, about, cell, band, quantum, clear, normal);
}

// Pushes x out of the body and takes back slip; where it does, `normal` is the body's there. start: x before the substep;
// clear: how far from the surface x must be, m.
void pushOut(SubstepBody body, vec3 start, float clear, inout vec3 x, inout vec3 normal) {
  vec3 out_normal, axis_point = body.a, axis_motion = body.a_motion;
  float distance;
  if (body.kind >= kEllipsoid) {
    vec3 off = x - body.a;
    float ball = body.radius + settings.hair_radius;
    if (!(dot(off, off) < ball * ball)) return;
    vec3 local = rotate(vec4(-body.rotation.xyz, body.rotation.w), off);
    if (body.kind == kEllipsoid) distance = ellipsoidDistance(local, body.extent, out_normal);
    else if (body.kind == kBox) distance = boxDistance(local, body.extent, out_normal);
    else if (body.kind == kConvex) distance = convexDistance(body, local, out_normal);
    else distance = fieldDistanceAt(body, local, clear, out_normal);
    out_normal = rotate(body.rotation, out_normal);
  } else if (body.kind == kSphere) {
    distance = sphereDistance(x, body.a, body.radius, out_normal);
  } else if (body.kind == kPlane) {
    distance = planeDistance(x, body.a, body.b, out_normal);
  } else {
    float along;
    if (body.kind == kCapsule) distance = capsuleDistance(x, body.a, body.b, body.radius, out_normal, along);
    else distance = taperedCapsuleDistance(x, body.a, body.b, body.radius, body.radius_b, out_normal, along);
    axis_point = madd(body.b - body.a, along, body.a);
    axis_motion = madd(body.b_motion - body.a_motion, along, body.a_motion);
  }
  distance -= clear;
  if (distance < 0.0) {
    vec3 motion = surfaceMotion(x, axis_point, axis_motion, body.spin, settings.substep);
    x = resolveContact(x, start, motion, out_normal, distance, body.friction);
    normal = out_normal;
  }
}
