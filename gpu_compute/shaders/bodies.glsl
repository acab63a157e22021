// Contact with the bodies of a step: core/near_bodies.inl and core/strand_sweep.inl have the same for the CPU. Needs
// step_input.glsl, offsets[] and what gl/shaders/body_surface.glsl needs.
#if TURNING > 1
#include "kernels/surface_bend.h"
#endif
#include "gl/shaders/body_surface.glsl"

// From and to: what nearBody() may be asked for, of the bodies that a strand may touch.
uvec2 nearRange(uint strand) {
  if (settings.neighbourhoods == 0u) return uvec2(0u, settings.body_count);
  uint neighbourhood = offsets[settings.strand_count + 1u + strand];
  return settings.neighbourhoods + 1u + uvec2(near_bodies[neighbourhood], near_bodies[neighbourhood + 1u]);
}
// The same of their leaders; without lists of all bodies.
uvec2 leaderRange(uint strand) {
  if (settings.neighbourhoods == 0u) return uvec2(0u, settings.body_count);
  uint starts = settings.neighbourhoods + 1u + near_bodies[settings.neighbourhoods];
  uint at = starts + offsets[settings.strand_count + 1u + strand];
  return starts + settings.neighbourhoods + 1u + uvec2(near_bodies[at], near_bodies[at + 1u]);
}
uint nearBody(uint i) { return settings.neighbourhoods == 0u ? i : near_bodies[i]; }

// How far from every body a vertex must be, m; `velocity`: its entry, in w its rest distance.
float clearance(vec4 velocity) { return min(settings.hair_radius, velocity.w); }

float surfaceAt(PlacedBody body, vec3 x, float clear, out vec3 normal) {
  BodyShape shape = BodyShape(body.kind, body.a, body.b, body.radius, body.radius_b, body.rotation, body.extent, body.data,
                              body.extra
#if TURNING > 1
                              , body.time
#endif
  );
  return surfaceAt(shape, x, clear, normal);
}

#include "gpu_compute/shaders/touch.glsl"

// Where a body takes a point of it in a substep.
vec3 carriedOf(PlacedBody body, vec3 point) {
  vec3 rigidly = carriedBy(point, body.a, body.a_motion, body.turn);
#if TURNING > 1
  if (isBent(body.kind, body.extra)) {
    vec3 local = rotateBack(body.rotation, rigidly - body.a);
    vec3 bent = carriedByBend(bendAt(body.extra, body.time - 1.0 / float(settings.substeps)), bendAt(body.extra, body.time), local);
    return rigidly + rotate(body.rotation, bent - local);
  }
#endif
  return rigidly;
}

// What this body is to a vertex that goes from `start` to x in the substep; where it is farther than `reach` (m, plus the way),
// untouched() with at most the gap; see core/strand_sweep.inl. `clear`: how far from the surface x must be, m.
Touch meet(PlacedBody body, vec3 x, vec3 start, float clear, float reach) {
  const int kAdvances = 8;
  vec3 carried = carriedOf(body, start);
  vec3 way = x - carried;
  float way2 = dot(way, way);
  vec3 off = x - body.middle;
  float ball = body.ball + reach;
  if (!(dot(off, off) < madd(ball, ball, way2))) return untouched(x, max(length(off) - body.ball, reach));
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
      float beyond = free + dot(at_normal, way) * (1.0 - part);
      if (beyond < gap) normal = at_normal;
      gap = min(gap, beyond);
    }
  }
  return Touch(gap, normal, carried, body.friction);
}
