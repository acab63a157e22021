// Contact with the bodies of a step, and the bodies that cover roots. The CPU's counterparts are core/near_bodies.inl and
// core/strand_sweep.inl. Requires step_input.glsl and what core/body_surface.glsl requires.
// SHAPE_KINDS: 0: spheres, capsules, tapered capsules and planes.
//              1: also ellipsoids, boxes, convex bodies and distance fields.
//              2: also fields that bend.
#include "core/body_surface.glsl"

// Range [x, y) of arguments of nearBody() for the bodies that a strand may touch.
uvec2 nearRange(uint strand) {
  if (settings.neighbourhoods == 0u) return uvec2(0u, settings.body_count);
  uint neighbourhood = offsets[settings.strand_count + 1u + strand];
  return settings.neighbourhoods + 1u + uvec2(near_bodies[neighbourhood], near_bodies[neighbourhood + 1u]);
}
// The same for the leaders of these bodies. Without near-body lists: the range of all bodies, leaders or not.
uvec2 leaderRange(uint strand) {
  if (settings.neighbourhoods == 0u) return uvec2(0u, settings.body_count);
  uint starts = settings.neighbourhoods + 1u + near_bodies[settings.neighbourhoods];
  uint at = starts + offsets[settings.strand_count + 1u + strand];
  return starts + settings.neighbourhoods + 1u + uvec2(near_bodies[at], near_bodies[at + 1u]);
}
uint nearBody(uint i) { return settings.neighbourhoods == 0u ? i : near_bodies[i]; }

// Clearance of a vertex, m. `velocity`: its entry of velocities[]; w: its distance from bodies at rest, m.
float clearance(vec4 velocity) { return min(settings.hair_radius, velocity.w); }

float surfaceAt(PlacedBody body, vec3 x, float clear, out vec3 normal) {
  BodyShape shape =
      BodyShape(body.kind, body.a, body.b, body.radius, body.radius_b, body.rotation, body.extent, body.data, body.extra
#if SHAPE_KINDS > 1
                ,
                body.time
#endif
      );
  return surfaceAt(shape, x, clear, normal);
}

#include "gpu_compute/shaders/contact_plane.glsl"

// Position, at the end of the substep, of a point that the body carries.
vec3 carriedOf(PlacedBody body, vec3 point) {
  vec3 rigidly = carriedBy(point, body.a, body.a_motion, body.turn);
#if SHAPE_KINDS > 1
  if (isBent(body.kind, body.extra)) {
    vec3 local = rotateBack(body.rotation, rigidly - body.a);
    vec3 bent =
        carriedByBend(bendAt(body.extra, body.time - 1.0 / float(settings.substeps)), bendAt(body.extra, body.time), local);
    return rigidly + rotate(body.rotation, bent - local);
  }
#endif
  return rigidly;
}

// Contact plane of the body and a vertex that goes from `start` to x in the substep; see core/strand_sweep.inl.
// A body farther than `reach` (m) plus the travel gives noContact() with a lower bound of the gap. `clear`: clearance, m.
ContactPlane closestContact(PlacedBody body, vec3 x, vec3 start, float clear, float reach) {
  const int kAdvances = 8;
  vec3 carried = carriedOf(body, start);
  vec3 way = x - carried;
  float way2 = dot(way, way);
  vec3 off = x - body.middle;
  float ball = body.ball + reach;
  if (!(dot(off, off) < madd(ball, ball, way2))) return noContact(x, max(length(off) - body.ball, reach));
  // One loop evaluates the distance at x (i = 0), at the carried start (i = 1) and along the way, because surfaceAt() is
  // long and the compiler inlines each call.
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
  return ContactPlane(gap, normal, carried, body.friction);
}

// Bodies that cover a root deeper than its clearance allows, so that vertices near the root cannot get out of them.
struct Cover {
  uint bodies;  // mask of the covering bodies at the end of the substep: coverBit()
  float depth;  // m, depth of the root in the deepest of them, beyond its clearance
  float most;   // m, upper bound of the depth in any body in the whole step
};
// Bit of a body by its number among those that the strand may touch. Numbers from 23 on share one bit: the mask is
// stored in a float, whose mantissa has 24 bits.
uint coverBit(uint number) { return 1u << min(number, 23u); }

// Cover of a root that moves from `start` to `end` in the substep, m. `clear`: its clearance, m. `first_edge`: length of
// the strand's first edge, m; a way out shorter than that does not matter.
Cover coverOf(uint strand, vec3 start, vec3 end, float clear, float first_edge, int substep) {
  const uvec2 range = nearRange(strand);
  Cover cover = Cover(0u, 0.0, 0.0);
  for (uint i = range.x; i < range.y; ++i) {
    const PlacedBody body = bodyAt(nearBody(i), substep);
    // Every substep of the step moves the root as far relative to the body; 1.1 allows for uneven motion.
    const float way = length(end - carriedBy(start, body.a, body.a_motion, body.turn)) + body.bend_shift;
    const float ways = 1.1 * way * float(settings.substeps);
    if (length(end - body.middle) - body.ball > clear + ways) continue;
    vec3 normal;
    const float depth = clear - surfaceAt(body, end, noClearance(), normal);
    cover.most = max(cover.most, depth + ways);
    if (!(exitArcLength(depth) > first_edge)) continue;
    cover.bodies |= coverBit(i - range.x);
    cover.depth = max(cover.depth, depth);
  }
  return cover;
}
// Clearance of a vertex at this arc length from its root, m: `clear`, or less from a body that covers the root.
float clearanceOf(Cover cover, uint number, float clear, float arc_length) {
  return (cover.bodies & coverBit(number)) != 0u ? clearanceInReach(clear, cover.depth, arc_length) : clear;
}
