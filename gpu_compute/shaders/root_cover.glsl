// Bodies that cover a root deeper than its clearance allows, so that vertices near the root cannot get out of them.
// Requires bodies.glsl.

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
