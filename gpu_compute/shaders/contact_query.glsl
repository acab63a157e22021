// Contact query of a vertex: the two nearest contact planes among the bodies that its strand may touch.
// Requires bodies.glsl, contact_cache.glsl, velocities[] and edge_rest[].

struct ContactSet {
  vec4 queried;  // the kQueryPoint row of contact_cache.glsl
  ContactPlane first, second;
};

// The bodies that cover the strand's root, from which vertices near the root cannot get out. From roots.comp.
struct RootHold {
  Cover cover;
  float arc_length;  // m, from the root to the vertex; < 0: no body holds this vertex inside in this step
};
RootHold rootHoldOf(uint strand, uint vertex) {
  const uint root = offsets[strand];
  RootHold hold = RootHold(Cover(0u, 0.0, 0.0), -1.0);
  const float way_out = contacts[contactRow(root, kQueryPoint)].w;
  if (!(way_out > 0.0)) return hold;
  float arc_length = 0.0;
  for (uint edge = root; edge < vertex && arc_length < way_out; ++edge) arc_length += edge_rest[edge].x;
  if (!(arc_length < way_out)) return hold;
  const vec4 found = contacts[contactRow(root, kCover)];
  return RootHold(Cover(uint(found.x), found.y, 0.0), arc_length);
}

// The query at x, of a vertex that started the substep at `start`.
ContactSet contactsFrom(uint strand, uint vertex, vec3 x, vec3 start, int substep) {
  const float clear = clearance(velocities[vertex]);
  const RootHold hold = rootHoldOf(strand, vertex);
  uvec2 range = nearRange(strand);
  ContactSet found;
  found.first = found.second = noContact(x, 0.0);
  found.first.gap = found.second.gap = 1e9;
  float room = 1e8;  // m, separation bound: least gap less the query's reach
  for (uint i = range.x; i < range.y; ++i) {
    PlacedBody body = bodyAt(nearBody(i), substep);
    float way = length(x - carriedOf(body, start));
    float reach = madd(way, 0.5, queryReach());
    ContactPlane own = closestContact(body, x, start, clearanceOf(hold.cover, i - range.x, clear, hold.arc_length), reach);
    room = min(room, own.gap - reach);
    if (own.gap >= reach) continue;
    if (own.gap < found.first.gap) {
      found.second = found.first;
      found.first = own;
    } else if (own.gap < found.second.gap) {
      found.second = own;
    }
  }
  const float between = pinch(found.first.gap, found.first.normal, found.second.gap, found.second.normal);
  found.first.gap += between;
  found.second.gap += between;
  if (hold.arc_length >= 0.0) room = min(room, -1.0);  // query again in each substep: the root may come out
  found.queried = vec4(x, found.first.gap < 1e8 ? -1e9 : room);
  return found;
}

// Stores a plane found by a query at x.
void storePlane(uint vertex, uint row, ContactPlane plane, vec3 x) {
  contacts[contactRow(vertex, row)] = vec4(plane.normal, dot(plane.normal, x) - plane.gap);
  contacts[contactRow(vertex, row + 1u)] = vec4(plane.carried, plane.friction);
}

void storeContacts(uint vertex, ContactSet found) {
  contacts[contactRow(vertex, kQueryPoint)] = found.queried;
  if (hasPlanes(found.queried)) {
    storePlane(vertex, kFirstPlane, found.first, found.queried.xyz);
    storePlane(vertex, kFirstPlane + kPlaneRows, found.second, found.queried.xyz);
  }
}

void queryContacts(uint strand, uint vertex, vec3 x, vec3 start, int substep) {
  storeContacts(vertex, contactsFrom(strand, vertex, x, start, substep));
}
