// Distances to bodies at the end of a step: MovingPrimitive and ShapeData of core/contact_primitive.h. Needs
// growth.bodies and kernels/rotation.h.
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
  uint extra;
};
layout(std430, binding = 6) readonly buffer Bodies { Body body_list[]; };
layout(std430, binding = 7) readonly buffer BodyWords { uint shape_words[]; };

#define SHAPE_KINDS 2
#include "core/body_surface.glsl"

// Signed distance to the nearest body, m, negative inside, and its surface normal.
float bodyDistance(vec3 x, out vec3 normal) {
  float nearest = 1e9;
  normal = vec3(0, 1, 0);
  for (uint i = 0u; i < growth.bodies; ++i) {
    vec3 out_of;
    Body body = body_list[i];
    BodyShape shape = BodyShape(body.kind, body.a, body.b, body.a_begin_radius.w, body.radius_b, body.rotation, body.extent,
                                body.data, body.extra, 1.0);
    float distance = surfaceAt(shape, x, growth.clearance, out_of);
    if (distance < nearest) {
      nearest = distance;
      normal = out_of;
    }
  }
  return nearest;
}
