// Contact cache: per vertex, the point of its newest contact query and the contact planes of the two nearest bodies.
// The CPU's counterpart is core/near_bodies.inl.
// Requires kernels/contact.h, step_input.glsl and contact_plane.glsl.

// First, one entry per vertex. xyz: contact force, StrandState::contacts. |w|: the factor that velocityClamp() of
// kernels/rod.h left on its velocity in this substep. w > 0: exact lengths have displaced the vertex by more than
// contactSlack() since contact was resolved. Then the cache: five rows of one entry per vertex, see contactRow().
layout(std430, binding = 3) buffer Contacts { vec4 contacts[]; };
// Row: xyz: query point, m. w: -1e9 if the vertex has contact planes; else the separation bound, m: by how much all
// bodies are farther from the query point than the query reached.
const uint kQueryPoint = 0u;
// Two rows per plane. First: normal (0: no plane) and plane offset dot(normal, point of the plane), m. Second:
// ContactPlane::carried and friction.
const uint kFirstPlane = 1u, kPlaneRows = 2u, kMaxPlanes = 2u;
// Roots make no contact queries; their entries of the rows hold per-strand data:
// kQueryPoint: x: for a contact-free strand, how far any body may move in the step relative to body y, m; else kNear.
//   Between query_contacts.comp (SORTING 1) and contact_free_strands.comp, x is the strand's separation bound, m.
//   y: number of the first leader body that may touch the strand; -1: no body may, and x is relative to the world.
//   w: exitArcLength() the body that may cover the root deepest in the step, m; 0: no body covers it deeply enough to matter.
// kCover: Cover::bodies, Cover::depth, RootMotion::spin, RootMotion::jump.z.
// kRootPosition: position, jump.x. kRootTangent: tangent_old, jump.y. kRootRotation: rotation.
const float kNear = -1.0;
const uint kCover = 1u, kRootPosition = 2u, kRootTangent = 3u, kRootRotation = 4u;

// Row-major, so that invocations of neighbouring vertices read adjacent memory.
uint contactRow(uint vertex, uint row) { return vertex + (row + 1u) * offsets[settings.strand_count]; }
bool isContactFree(uint strand) { return contacts[contactRow(offsets[strand], kQueryPoint)].x >= 0.0; }
bool hasPlanes(vec4 queried) { return queried.w < -1e8; }
// The cached plane that starts at `row`, with the gap of a vertex at x.
ContactPlane planeOf(uint vertex, uint row, vec3 x) {
  vec4 plane = contacts[contactRow(vertex, row)], surface = contacts[contactRow(vertex, row + 1u)];
  return ContactPlane(dot(plane.xyz, x) - plane.w, plane.xyz, surface.xyz, surface.w);
}
// Distance from its query point that a vertex may travel without touching a body, m.
float separationBound(uint vertex, vec4 queried) {
  return hasPlanes(queried) ? planeOf(vertex, kFirstPlane, queried.xyz).gap : queried.w;
}
// Whether a vertex at x has left the region that its query covered. The query's reach grew by half of the vertex's
// relative travel, hence the factor 1.5.
bool isCacheStale(vec4 queried, vec3 x) {
  float off = length(x - queried.xyz);
  return off > queryReach() && 1.5 * off > queried.w;
}

// The deeper of the two cached planes, for a vertex at x that has planes; noContact() beyond contactReach().
ContactPlane deepestPlane(uint vertex, vec3 x) {
  const vec4 first = contacts[contactRow(vertex, kFirstPlane)], second = contacts[contactRow(vertex, kFirstPlane + kPlaneRows)];
  const float gap = dot(first.xyz, x) - first.w, other_gap = dot(second.xyz, x) - second.w;
  if (!(min(gap, other_gap) < contactReach())) return noContact(x, contactReach());
  const bool other = other_gap < gap;
  const vec4 surface = contacts[contactRow(vertex, (other ? kFirstPlane + kPlaneRows : kFirstPlane) + 1u)];
  return ContactPlane(other ? other_gap : gap, other ? second.xyz : first.xyz, surface.xyz, surface.w);
}
// Square of the farthest that nearby bodies carry a point from `start` in this substep, m^2, weighted by nearness().
// For a vertex at x that has planes.
float carried2Of(uint vertex, vec3 x, vec3 start) {
  float most = 0.0;
  for (uint row = kFirstPlane; row < kFirstPlane + kMaxPlanes * kPlaneRows; row += kPlaneRows) {
    const ContactPlane own = planeOf(vertex, row, x);
    const vec3 way = (own.carried - start) * nearness(own.gap);
    most = max(most, dot(way, way));
  }
  return most;
}
// Whether a vertex that ends the substep at x needs another contact query: its cache is stale, or a plane is near.
bool needsRequery(uint vertex, vec3 x) {
  vec4 queried = contacts[contactRow(vertex, kQueryPoint)];
  return isCacheStale(queried, x) || (hasPlanes(queried) && deepestPlane(vertex, x).gap < requeryMargin());
}
