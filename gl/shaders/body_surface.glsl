// How far points are from the surface of a body, by its kind: core/body_surface.inl has the same for the CPU. Needs
// kernels/rotation.h, kernels/contact.h, kernels/distance_field.h, for bends kernels/surface_bend.h, and shape_words[], the words of ShapeData
// (core/contact_primitive.h). TURNING: 1 with kinds that have a rotation, whose text is long; 2 with fields that bend too.

const uint kSphere = 0u, kCapsule = 1u, kPlane = 2u, kTaperedCapsule = 3u, kEllipsoid = 4u, kBox = 5u, kConvex = 6u;
const uint kBrickSide = 9u, kBrickWords = 365u, kOutsideBrick = 0xFFFFFFFFu, kInsideBrick = 0xFFFFFFFEu;

struct BodyShape {
  uint kind;
  vec3 a, b;  // m
  float radius, radius_b;
  vec4 rotation;
  vec3 extent;
  uint data, extra;  // of its shape in shape_words
#if TURNING > 1
  float time;  // the part of the step that has passed, 0 to 1
#endif
};

#if TURNING
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

// Number n of eight that stand about a point with these strides: samples of the brick whose words start at `at`, or
// distances at the corners of bricks.
float fieldNumber(bool stored, uint at, uint n) {
  if (!stored) return shapeNumber(at + n);
  uint word = shape_words[at + n / 2u];
  return float(bitfieldExtract(int(word), int(16u * (n & 1u)), 16));
}

#if TURNING > 1
// The MovingBend (core/surface_bend.h) whose words start at `at`.
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

// Of the field whose words start at `at`: core/body_surface.inl, fieldDistanceAt; core/distance_field.h has the layout.
float fieldDistanceAt(uint at, vec3 x, float clear, out vec3 normal) {
  float cell = shapeNumber(at + 3u), band = shapeNumber(at + 7u), quantum = shapeNumber(at + 8u);
  uvec3 bricks = uvec3(shape_words[at + 4u], shape_words[at + 5u], shape_words[at + 6u]);
  FieldPlace place = fieldPlace(x, shapeVector(at), cell, vec3(bricks));
  uint entry = shape_words[shape_words[at + 9u] + uint(place.brick)];
  normal = vec3(0);
  if (entry == kOutsideBrick) {  // at most the distance, by what is stored at the brick's nearest corner
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

// `clear`: m, as far as the point is to be kept from the surface.
float surfaceAt(BodyShape body, vec3 x, float clear, out vec3 normal) {
  float distance, along;
#if TURNING
  if (body.kind >= kEllipsoid) {
    vec3 local = rotateBack(body.rotation, x - body.a);
#if TURNING > 1
    vec3 bent = local;
    Bend bend;
    if (isBent(body.kind, body.extra)) {
      bend = bendAt(body.extra, body.time);
      local += bendShift(bend, local);
    }
#endif
    if (body.kind == kEllipsoid) distance = ellipsoidDistance(local, body.extent, normal);
    else if (body.kind == kBox) distance = boxDistance(local, body.extent, normal);
    else if (body.kind == kConvex) distance = convexDistance(body, local, normal);
    else distance = fieldDistanceAt(body.data, local, clear, normal);
#if TURNING > 1
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
