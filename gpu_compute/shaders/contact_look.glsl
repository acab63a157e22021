// A vertex looks at the bodies that its strand may touch. Needs bodies.glsl and contact_sights.glsl.

// From x, in a substep that started at `start`. `clear`: how far from every body it must be, m.
void look(uint strand, uint vertex, vec3 x, vec3 start, float clear, int substep) {
  uvec2 range = nearRange(strand);
  Touch first, second;
  first = second = untouched(x, 0.0);
  first.gap = second.gap = 1e9;
  float room = 1e8;  // less what is in reach
  for (uint i = range.x; i < range.y; ++i) {
    PlacedBody body = bodyAt(nearBody(i), substep);
    float way = length(x - carriedBy(start, body.a, body.a_motion, body.turn));
    float reach = madd(way, 0.5, lookReach());
    Touch own = meet(body, x, start, clear, reach);
    room = min(room, own.gap - reach);
    if (own.gap >= reach) continue;
    if (own.gap < first.gap) {
      second = first;
      first = own;
    } else if (own.gap < second.gap) {
      second = own;
    }
  }
  bool sees = first.gap < 1e8;
  uint at = sightOf(vertex);
  contacts[at + kLooked] = vec4(x, sees ? -1e9 : room);
  if (!sees) return;
  contacts[at + kFirstPlane] = vec4(first.normal, dot(first.normal, x) - first.gap);
  contacts[at + kFirstPlane + 1u] = vec4(first.carried, first.friction);
  contacts[at + kFirstPlane + kPlaneRows] = vec4(second.normal, dot(second.normal, x) - second.gap);
  contacts[at + kFirstPlane + kPlaneRows + 1u] = vec4(second.carried, second.friction);
}
