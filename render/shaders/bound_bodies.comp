#version 450 core
// variants: none | REST=1
// One invocation computes, for one bound hair, how far it follows one guide instead of three to stay out of bodies; see
// hair_bodies.h. REST: how far its vertices are from bodies, all at rest.
layout(local_size_x = 64) in;
#define BOUND_ACCESS
#include "render/shaders/bound_curve.glsl"
#include "render/shaders/bodies.glsl"
uniform uint first_hair;  // of the list; REST: of the bound hairs
uniform uint hair_count;

void setClosing(uint vertex, float closing) {
  uint pair = 2u * vertex_count + vertex / 2u;
  if ((vertex & 1u) == 0u)
    bound_vertices[pair].y = closing;
  else
    bound_vertices[pair].w = closing;
}

#ifdef REST
void main() {
  if (gl_GlobalInvocationID.x >= hair_count) return;
  BoundHair bound = bound_hairs[first_hair + gl_GlobalInvocationID.x];
  for (uint vertex = bound.first; vertex < bound.first + bound.count; ++vertex) {
    vec3 normal;
    float distance = bodyDistance(bound_vertices[2u * vertex].xyz, normal);
    uint pair = 2u * vertex_count + vertex / 2u;
    if ((vertex & 1u) == 0u)
      bound_vertices[pair].x = distance;
    else
      bound_vertices[pair].z = distance;
    setClosing(vertex, 0.0);
  }
}
#else
void main() {
  if (gl_GlobalInvocationID.x >= hair_count) return;
  Hair hair = hairs[hair_list[first_hair + gl_GlobalInvocationID.x]];
  BoundHair bound = bound_hairs[hair.bound - 1u];
  uint end = bound.first + bound.count;
  for (uint vertex = bound.first; vertex < end; ++vertex) {
    vec3 normal;
    float distance = bodyDistance(boundPoint(hair, bound.arc_length, vertex, 0.0).position, normal);
    float rest = bodyNumbers(vertex).x;
    setClosing(vertex, distance >= min(rest, growth.clearance) ? kClear : closingAsked(min(rest, 0.0) - distance));
  }
  // Propagates each vertex's closing to all vertices after it and, within the zone, to those before it.
  float most = 0.0;
  for (uint vertex = bound.first; vertex < end; ++vertex) {
    float along = bound_vertices[2u * vertex].w;
    float own = bodyNumbers(vertex).y;
    most = max(most, own);
    float closing = most;
    for (uint other = vertex + 1u; other < end; ++other) {
      float ahead = bound_vertices[2u * other].w - along;
      if (ahead >= growth.zone) break;
      closing = max(closing, closingBefore(max(bodyNumbers(other).y, 0.0), ahead, growth.zone));
    }
    setClosing(vertex, closing > 0.0 ? closing : own);
  }
}
#endif
