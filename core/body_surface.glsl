// Signed distance of a point to the surface of a body, by the kind of shape. The CPU's counterpart is
// core/body_surface.inl.
// Requires kernels/rotation.h, kernels/contact.h, kernels/distance_field.h, and shape_words[], the words of ShapeData
// (core/contact_primitive.h).
// SHAPE_KINDS: 0: spheres, capsules, tapered capsules and planes.
//              1: also the kinds with a rotation: ellipsoids, boxes, convex bodies and distance fields. Their code is long.
//              2: also fields that bend.

// PrimitiveKind of core/contact_primitive.h; greater kinds are fields. Layout of fields: core/distance_field.h.
const uint kSphere = 0u, kCapsule = 1u, kPlane = 2u, kTaperedCapsule = 3u, kEllipsoid = 4u, kBox = 5u, kConvex = 6u;
const uint kBrickSide = 9u, kBrickWords = 365u, kOutsideBrick = 0xFFFFFFFFu, kInsideBrick = 0xFFFFFFFEu;

struct BodyShape {
  uint kind;
  vec3 a, b;  // m
  float radius, radius_b;
  vec4 rotation;
  vec3 extent;
  // data: word of the shape in shape_words. extra: number of planes of a convex body; word of a field's bend, 0: none.
  uint data, extra;
#if SHAPE_KINDS > 1
  float time;  // fraction of the step that has passed, 0 to 1
#endif
};

#if SHAPE_KINDS
float shapeNumber(uint at) { return uintBitsToFloat(shape_words[at]); }
vec3 shapeVector(uint at) { return vec3(shapeNumber(at), shapeNumber(at + 1u), shapeNumber(at + 2u)); }

float convexDistance(BodyShape body, vec3 x, out vec3 normal) {
  float nearest = -1e9;
  normal = vec3(0, 1, 0);
  for (uint i = 0u; i < body.extra; ++i) {
    uint at = body.data + 4u * i;
    convexPlane(x, shapeVector(at), shapeNumber(at + 3u), nearest, normal);
  }
  return nearest;
}

// Value n of a brick's samples (`stored`; 16 bits each, words from `at` on), or of the distances at brick corners, m.
float fieldNumber(bool stored, uint at, uint n) {
  if (!stored) return shapeNumber(at + n);
  uint word = shape_words[at + n / 2u];
  return float(bitfieldExtract(int(word), int(16u * (n & 1u)), 16));
}

#if SHAPE_KINDS > 1
// The MovingBend (core/distance_field.h) whose words start at `at`.
vec3 bendTerm(uint at, float time, uint i) {
  vec3 begin = shapeVector(at + 3u * i);
  return begin + time * (shapeVector(at + 30u + 3u * i) - begin);
}
Bend bendAt(uint at, float time) {
  return Bend(bendTerm(at, time, 0u), bendTerm(at, time, 1u), bendTerm(at, time, 2u), bendTerm(at, time, 3u),
              bendTerm(at, time, 4u), bendTerm(at, time, 5u), bendTerm(at, time, 6u), bendTerm(at, time, 7u),
              bendTerm(at, time, 8u), bendTerm(at, time, 9u), shapeVector(at + 60u));
}
float stretchOfBend(uint at) { return shapeNumber(at + 63u); }
bool isBent(uint kind, uint extra) { return kind > kConvex && extra != 0u; }
#endif

// Signed distance, m, to the field whose words start at `at`. As fieldSurfaceAt() of core/body_surface.inl; the layout is
// in core/distance_field.h.
float fieldDistanceAt(uint at, vec3 x, float clear, out vec3 normal) {
  float cell = shapeNumber(at + 3u), band = shapeNumber(at + 7u), quantum = shapeNumber(at + 8u);
  uvec3 bricks = uvec3(shape_words[at + 4u], shape_words[at + 5u], shape_words[at + 6u]);
  FieldPlace place = fieldPlace(x, shapeVector(at), cell, vec3(bricks));
  uint entry = shape_words[shape_words[at + 9u] + uint(place.brick)];
  normal = vec3(0);
  if (entry == kOutsideBrick) {  // no samples: a lower bound, from the distance stored at the nearest brick corner
    vec3 nearest = floor(place.in_brick + 0.5);
    uvec3 step = uvec3(nearest);
    uint corner = uint(place.corner) + (step.z * (bricks.y + 1u) + step.y) * (bricks.x + 1u) + step.x;
    float way = length((place.in_brick - nearest) * (8.0 * cell) + place.outside);
    return max(max(clear, band), shapeNumber(shape_words[at + 11u] + corner) - way);
  }
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

// Signed distance, m, and unit normal at x. `clear`: clearance of the point, m; beyond it a field may return a lower bound.
float surfaceAt(BodyShape body, vec3 x, float clear, out vec3 normal) {
  float distance, along;
#if SHAPE_KINDS
  if (body.kind >= kEllipsoid) {
    vec3 local = rotateBack(body.rotation, x - body.a);
#if SHAPE_KINDS > 1
    vec3 bent = local;
    Bend bend;
    if (isBent(body.kind, body.extra)) {
      bend = bendAt(body.extra, body.time);
      local += bendShift(bend, local);
    }
#endif
    if (body.kind == kEllipsoid)
      distance = ellipsoidDistance(local, body.extent, normal);
    else if (body.kind == kBox)
      distance = boxDistance(local, body.extent, normal);
    else if (body.kind == kConvex)
      distance = convexDistance(body, local, normal);
    else
      distance = fieldDistanceAt(body.data, local, clear, normal);
#if SHAPE_KINDS > 1
    if (isBent(body.kind, body.extra)) {
      normal = bentGradient(bend, bent, normal);
      distance = bentDistance(distance, stretchOfBend(body.extra), normal);
    }
#endif
    normal = rotate(body.rotation, normal);
    return distance;
  }
#endif
  if (body.kind == kSphere) return sphereDistance(x, body.a, body.radius, normal);
  if (body.kind == kPlane) return planeDistance(x, body.a, body.b, normal);
  if (body.kind == kCapsule) return capsuleDistance(x, body.a, body.b, body.radius, normal, along);
  return taperedCapsuleDistance(x, body.a, body.b, body.radius, body.radius_b, normal, along);
}
