// A vertex looks at the bodies that its strand may touch. Needs bodies.glsl, root_cover.glsl, contact_sights.glsl,
// velocities[] and edge_rest[].

struct Sight {
  vec4 looked;  // as contact_sights.glsl has it
  Touch first, second;
};

// What keeps a vertex in a body, by what roots.comp has found.
struct Hold {
  Cover cover;
  float arc_length;  // m, from the root to the vertex; less than 0: in this step nothing covers the root so deeply that it mattered
};
Hold holdOf(uint strand, uint vertex) {
  const uint root = offsets[strand];
  Hold hold = Hold(Cover(0u, 0.0, 0.0), -1.0);
  const float way_out = contacts[sightAt(root, kLooked)].w;
  if (!(way_out > 0.0)) return hold;
  float arc_length = 0.0;
  for (uint edge = root; edge < vertex && arc_length < way_out; ++edge) arc_length += edge_rest[edge].x;
  if (!(arc_length < way_out)) return hold;
  const vec4 found = contacts[sightAt(root, kCover)];
  return Hold(Cover(uint(found.x), found.y, 0.0), arc_length);
}

// From x, in a substep that started at `start`.
Sight sightFrom(uint strand, uint vertex, vec3 x, vec3 start, int substep) {
  const float clear = clearance(velocities[vertex]);
  const Hold hold = holdOf(strand, vertex);
  uvec2 range = nearRange(strand);
  Sight sight;
  sight.first = sight.second = untouched(x, 0.0);
  sight.first.gap = sight.second.gap = 1e9;
  float room = 1e8;  // less what is in reach
  for (uint i = range.x; i < range.y; ++i) {
    PlacedBody body = bodyAt(nearBody(i), substep);
    float way = length(x - carriedOf(body, start));
    float reach = madd(way, 0.5, lookReach());
    Touch own = meet(body, x, start, clearanceOf(hold.cover, i - range.x, clear, hold.arc_length), reach);
    room = min(room, own.gap - reach);
    if (own.gap >= reach) continue;
    if (own.gap < sight.first.gap) {
      sight.second = sight.first;
      sight.first = own;
    } else if (own.gap < sight.second.gap) {
      sight.second = own;
    }
  }
  const float between = pinch(sight.first.gap, sight.first.normal, sight.second.gap, sight.second.normal);
  sight.first.gap += between;
  sight.second.gap += between;
  if (hold.arc_length >= 0.0) room = min(room, -1.0);  // the root may come out
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
