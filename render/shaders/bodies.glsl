// Distances to bodies at the end of a step: MovingPrimitive and ShapeData of core/contact_primitive.h, the formulas of
// kernels/contact.h and kernels/distance_field.h. Needs growth.bodies and kernels/rotation.h.
#include "kernels/contact.h"
#include "kernels/distance_field.h"
struct Body {
  vec4 a_begin_radius;
  vec3 a;
  uint kind;
  vec4 b_begin_friction;
  vec3 b;
  float radius_b;
  vec3 angular_velocity;
  uint data;
  vec4 rotation_begin;
  vec4 rotation;
  vec3 extent;
  uint planes;
};
layout(std430, binding = 6) readonly buffer Bodies { Body body_list[]; };
layout(std430, binding = 7) readonly buffer BodyWords { uint body_words[]; };

// PrimitiveKind, and core/distance_field.h.
const uint kSphere = 0u, kCapsule = 1u, kPlane = 2u, kTaperedCapsule = 3u, kEllipsoid = 4u, kBox = 5u, kConvex = 6u;
const uint kBrickSide = 9u, kBrickWords = 365u, kOutsideBrick = 0xFFFFFFFFu, kInsideBrick = 0xFFFFFFFEu;

float bodyNumber(uint at) { return uintBitsToFloat(body_words[at]); }
vec3 bodyVector(uint at) { return vec3(bodyNumber(at), bodyNumber(at + 1u), bodyNumber(at + 2u)); }

float fieldNumber(bool stored, uint at, uint n) {
  if (!stored) return bodyNumber(at + n);
  return float(bitfieldExtract(int(body_words[at + n / 2u]), int(16u * (n & 1u)), 16));
}

float fieldDistanceAt(uint at, vec3 x, float clear, out vec3 normal) {
  float cell = bodyNumber(at + 3u), band = bodyNumber(at + 7u), quantum = bodyNumber(at + 8u);
  uvec3 bricks = uvec3(body_words[at + 4u], body_words[at + 5u], body_words[at + 6u]);
  FieldPlace place = fieldPlace(x, bodyVector(at), cell, vec3(bricks));
  uint entry = body_words[body_words[at + 9u] + uint(place.brick)];
  normal = vec3(0);
  if (entry == kOutsideBrick) return max(clear, band);
  bool stored = entry < kInsideBrick;
  uint from = stored ? body_words[at + 10u] + entry * kBrickWords : body_words[at + 11u];
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

float convexDistance(Body body, vec3 x, out vec3 normal) {
  float nearest = -1e9;
  normal = vec3(0, 1, 0);
  for (uint i = 0u; i < body.planes; ++i)
    convexPlane(x, bodyVector(body.data + 4u * i), bodyNumber(body.data + 4u * i + 3u), nearest, normal);
  return nearest;
}

float surfaceDistance(Body body, vec3 x, out vec3 normal) {
  float distance, along;
  if (body.kind >= kEllipsoid) {
    vec3 local = rotate(vec4(-body.rotation.xyz, body.rotation.w), x - body.a);
    if (body.kind == kEllipsoid) distance = ellipsoidDistance(local, body.extent, normal);
    else if (body.kind == kBox) distance = boxDistance(local, body.extent, normal);
    else if (body.kind == kConvex) distance = convexDistance(body, local, normal);
    else distance = fieldDistanceAt(body.data, local, growth.clearance, normal);
    normal = rotate(body.rotation, normal);
    return distance;
  }
  float radius = body.a_begin_radius.w;
  if (body.kind == kSphere) return sphereDistance(x, body.a, radius, normal);
  if (body.kind == kPlane) return planeDistance(x, body.a, body.b, normal);
  if (body.kind == kCapsule) return capsuleDistance(x, body.a, body.b, radius, normal, along);
  return taperedCapsuleDistance(x, body.a, body.b, radius, body.radius_b, normal, along);
}

// To the nearest body, negative inside; its normal.
float bodyDistance(vec3 x, out vec3 normal) {
  float nearest = 1e9;
  normal = vec3(0, 1, 0);
  for (uint i = 0u; i < growth.bodies; ++i) {
    vec3 out_of;
    float distance = surfaceDistance(body_list[i], x, out_of);
    if (distance < nearest) {
      nearest = distance;
      normal = out_of;
    }
  }
  return nearest;
}
