// Contact with the bodies of a step: core/near_bodies.inl, core/body_surface.inl and core/strand_sweep.inl have the same for the
// CPU. Needs step_input.glsl, kernels/contact.h and kernels/distance_field.h, and offsets[]. TURNING: with kinds that have a rotation.

// From and to: what nearBody() may be asked for, of the bodies that a strand may touch.
uvec2 nearRange(uint strand) {
  if (settings.neighbourhoods == 0u) return uvec2(0u, settings.body_count);
  uint neighbourhood = offsets[settings.strand_count + 1u + strand];
  return settings.neighbourhoods + 1u + uvec2(near_bodies[neighbourhood], near_bodies[neighbourhood + 1u]);
}
uint nearBody(uint i) { return settings.neighbourhoods == 0u ? i : near_bodies[i]; }

// The body with this number at the end of a substep.
PlacedBody bodyAt(uint index, int substep) { return bodies[uint(substep) * settings.body_count + index]; }

#if TURNING
float shapeNumber(uint at) { return uintBitsToFloat(shape_words[at]); }
vec3 shapeVector(uint at) { return vec3(shapeNumber(at), shapeNumber(at + 1u), shapeNumber(at + 2u)); }

float convexDistance(PlacedBody body, vec3 x, out vec3 normal) {
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
float fieldDistanceAt(PlacedBody body, vec3 x, float clear, out vec3 normal) {
  uint at = body.data;
  float cell = shapeNumber(at + 3u), band = shapeNumber(at + 7u), quantum = shapeNumber(at + 8u);
  uvec3 bricks = uvec3(shape_words[at + 4u], shape_words[at + 5u], shape_words[at + 6u]);
  FieldPlace place = fieldPlace(x, shapeVector(at), cell, vec3(bricks));
  uint entry = shape_words[shape_words[at + 9u] + uint(place.brick)];
  normal = vec3(0);
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
#endif

// `clear`: m, as far as the point is to be kept from the surface.
float surfaceAt(PlacedBody body, vec3 x, float clear, out vec3 normal) {
  float distance, along;
#if TURNING
  if (body.kind >= kEllipsoid) {
    vec3 local = rotate(vec4(-body.rotation.xyz, body.rotation.w), x - body.a);
    if (body.kind == kEllipsoid) distance = ellipsoidDistance(local, body.extent, normal);
    else if (body.kind == kBox) distance = boxDistance(local, body.extent, normal);
    else if (body.kind == kConvex) distance = convexDistance(body, local, normal);
    else distance = fieldDistanceAt(body, local, clear, normal);
    normal = rotate(body.rotation, normal);
    return distance;
  }
#endif
  if (body.kind == kSphere) return sphereDistance(x, body.a, body.radius, normal);
  if (body.kind == kPlane) return planeDistance(x, body.a, body.b, normal);
  if (body.kind == kCapsule) return capsuleDistance(x, body.a, body.b, body.radius, normal, along);
  return taperedCapsuleDistance(x, body.a, body.b, body.radius, body.radius_b, normal, along);
}

// The body within reach that is nearest to a vertex, or that its way has met.
struct Touch {
  float gap;      // m, to its surface, or to the plane through where the way met it
  vec3 normal;    // of the same
  vec3 carried;   // m, where the surface has taken the point at which the vertex was
  float friction;
};
Touch untouched(vec3 x) { return Touch(contactReach(), vec3(0), x, 0.0); }

// Looks whether this body is nearer to a vertex that goes from `start` to x in the substep; see core/strand_sweep.inl.
// `clear`: how far from the surface x must be, m.
void meet(PlacedBody body, vec3 x, vec3 start, float clear, inout Touch nearest) {
  const int kAdvances = 8;
  vec3 carried = carriedBy(start, body.a, body.a_motion, body.turn);
  vec3 way = x - carried;
  float way2 = dot(way, way);
  vec3 off = x - body.middle;
  if (!(dot(off, off) < body.ball * body.ball + way2)) return;
  // One loop for the distances at x, at its start and along its way: the text of surfaceAt() is long, and inlined.
  float gap = 0.0, part = 0.0, per_way = inverseSqrt(max(way2, 1e-30));
  vec3 normal = vec3(0), at_normal;
  for (int i = 0; i < kAdvances + 2; ++i) {
    float free = surfaceAt(body, i == 0 ? x : madd(way, part, carried), clear, at_normal) - clear;
    if (i == 0) {
      gap = free;
      normal = at_normal;
      if (!(gap < 0.0 || gap * gap < way2)) break;
      continue;
    }
    if (i == 1 && !(free > -contactReach() && dot(at_normal, normal) < 0.5)) break;
    if (i <= kAdvances) {
      part = min(madd(max(free, 0.0), per_way, part), 1.0);
    } else if (free * per_way < 0.1) {
      gap = free + dot(at_normal, way) * (1.0 - part);
      normal = at_normal;
    }
  }
  if (gap < nearest.gap) nearest = Touch(gap, normal, carried, body.friction);
}
