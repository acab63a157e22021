// A vertex looks at the bodies that its strand may touch. Needs bodies.glsl, root_cover.glsl, contact_sights.glsl,
// velocities[] and edge_rest[].

struct Sight {
  vec4 looked;  // as contact_sights.glsl has it
  Touch first, second;
};

// What keeps a vertex in bodies that cover its root, by what covered_roots.comp has found.
struct Hold {
  uint bodies;       // that do: coverBit(); none where the vertex is far from the root
  float depth;       // m, of the root in the deepest
  float arc_length;  // m, from the root to the vertex
};
Hold holdOf(uint strand, uint vertex, int substep) {
  const uint root = offsets[strand];
  const vec4 found = contacts[sightAt(root, kCover)];
  Hold hold = Hold(uint(found.x), 0.0, 0.0);
  if (hold.bodies == 0u) return hold;
  hold.depth = depthOf(RootCover(hold.bodies, found.y, found.z), substep);
  const float way_out = wayOutOf(hold.depth);
  for (uint edge = root; edge < vertex && hold.arc_length < way_out; ++edge) hold.arc_length += edge_rest[edge].x;
  if (!(hold.arc_length < way_out)) hold.bodies = 0u;
  return hold;
}

// From x, in a substep that started at `start`.
Sight sightFrom(uint strand, uint vertex, vec3 x, vec3 start, int substep) {
  const float clear = clearance(velocities[vertex]);
  const Hold hold = holdOf(strand, vertex, substep);
  uvec2 range = nearRange(strand);
  Sight sight;
  sight.first = sight.second = untouched(x, 0.0);
  sight.first.gap = sight.second.gap = 1e9;
  float room = 1e8;  // less what is in reach
  for (uint i = range.x; i < range.y; ++i) {
    PlacedBody body = bodyAt(nearBody(i), substep);
    float way = length(x - carriedOf(body, start));
    float reach = madd(way, 0.5, lookReach());
    Touch own = meet(body, x, start, clearanceOf(hold.bodies, i - range.x, clear, hold.depth, hold.arc_length), reach);
    room = min(room, own.gap - reach);
    if (own.gap >= reach) continue;
    if (own.gap < sight.first.gap) {
      sight.second = sight.first;
      sight.first = own;
    } else if (own.gap < sight.second.gap) {
      sight.second = own;
    }
  }
  if (hold.bodies != 0u) room = min(room, -1.0);  // the root may come out
  sight.looked = vec4(x, sight.first.gap < 1e8 ? -1e9 : room);
  return sight;
}

// A plane that was seen from x.
void keepPlane(uint vertex, uint row, Touch plane, vec3 x) {
  contacts[sightAt(vertex, row)] = vec4(plane.normal, dot(plane.normal, x) - plane.gap);
  contacts[sightAt(vertex, row + 1u)] = vec4(plane.carried, plane.friction);
}

void keepSight(uint vertex, Sight sight) {
  contacts[sightAt(vertex, kLooked)] = sight.looked;
  if (seesPlanes(sight.looked)) {
    keepPlane(vertex, kFirstPlane, sight.first, sight.looked.xyz);
    keepPlane(vertex, kFirstPlane + kPlaneRows, sight.second, sight.looked.xyz);
  }
}

void look(uint strand, uint vertex, vec3 x, vec3 start, int substep) {
  keepSight(vertex, sightFrom(strand, vertex, x, start, substep));
}
