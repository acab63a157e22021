// Bodies that cover a root deeper than they do at rest, so that the vertices near it cannot get out of them. Needs bodies.glsl.

struct Cover {
  uint bodies;  // those that do at the end of the substep: coverBit()
  float depth;  // m, in the deepest, beyond the root's clearance
  float most;   // m, at most that of any in the whole step
};
// Of a body by its number among those that the strand may touch; a float holds so many.
uint coverBit(uint number) { return 1u << min(number, 23u); }

// Of the root that a substep takes from `start` to `end`.
Cover coverOf(uint strand, vec3 start, vec3 end, float clear, float first_edge, int substep) {
  const uvec2 range = nearRange(strand);
  Cover cover = Cover(0u, 0.0, 0.0);
  for (uint i = range.x; i < range.y; ++i) {
    const PlacedBody body = bodyAt(nearBody(i), substep);
    // From substep to substep it goes as far once more, but for what is not even in the motion.
    const float way = length(end - carriedBy(start, body.a, body.a_motion, body.turn)) + body.bend_shift;
    const float ways = 1.1 * way * float(settings.substeps);
    if (length(end - body.middle) - body.ball > clear + ways) continue;
    vec3 normal;
    const float depth = clear - surfaceAt(body, end, pushedByNothing(), normal);
    cover.most = max(cover.most, depth + ways);
    if (!(wayOutOf(depth) > first_edge)) continue;
    cover.bodies |= coverBit(i - range.x);
    cover.depth = max(cover.depth, depth);
  }
  return cover;
}
// How far from a body a vertex is kept at this arc length from its root, m: by `clear`, or by what it can be.
float clearanceOf(Cover cover, uint number, float clear, float arc_length) {
  return (cover.bodies & coverBit(number)) != 0u ? clearanceInReach(clear, cover.depth, arc_length) : clear;
}
