// Bodies that cover a root deeper than they do at rest, so that the vertices near it cannot get out of them. Needs bodies.glsl.

struct RootCover {
  uint bodies;        // that may do so in the step: coverBit()
  float first, last;  // m, the depth in the deepest, beyond the root's clearance, at the end of the first and the last substep
};
// Of a body by its number among those that the strand may touch; a float holds so many.
uint coverBit(uint number) { return 1u << min(number, 23u); }

// `begin`, `first`, `last`: where the root is before the step and after these substeps.
RootCover coverOf(uint strand, vec3 begin, vec3 first, vec3 last, float clear, float first_edge) {
  const uvec2 range = nearRange(strand);
  RootCover cover = RootCover(0u, 0.0, 0.0);
  for (uint i = range.x; i < range.y; ++i) {
    float ways = 0.0;  // at most what the body comes nearer by in the step
    for (int end = 0; end < 2; ++end) {
      const PlacedBody body = bodyAt(nearBody(i), end == 0 ? 0 : int(settings.substeps) - 1);
      const vec3 root = end == 0 ? first : last;
      // From substep to substep it goes as far once more, but for what is not even in the motion.
      if (end == 0)
        ways = 1.1 * float(settings.substeps) * (length(first - carriedBy(begin, body.a, body.a_motion, body.turn)) + body.bend_shift);
      if (length(root - body.middle) - body.ball > clear + ways) break;
      vec3 normal;
      const float depth = clear - surfaceAt(body, root, pushedByNothing(), normal);
      if (!(wayOutOf(depth + ways) > first_edge)) break;
      cover.bodies |= coverBit(i - range.x);
      if (end == 0) cover.first = max(cover.first, depth);
      else cover.last = max(cover.last, depth);
    }
  }
  return cover;
}

// Its depth in a substep.
float depthOf(RootCover cover, int substep) {
  return mix(cover.first, cover.last, float(substep) / float(max(settings.substeps, 2u) - 1u));
}
// How far from a body a vertex is kept at this arc length from its root, m: by `clear`, or by what it can be. `depth`: of the root.
float clearanceOf(uint bodies, uint number, float clear, float depth, float arc_length) {
  return (bodies & coverBit(number)) != 0u ? clearanceInReach(clear, depth, arc_length) : clear;
}
