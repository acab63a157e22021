// Part of rod.comp: for a contact-free strand (CONTACT_FREE), checks after the step that no body came within reach.
#include "gpu_compute/shaders/contact_plane.glsl"
#include "gpu_compute/shaders/contact_cache.glsl"

float ways[PER_THREAD];  // m, travel of vertices so far in the step, as seen from body first_body
float longest;           // m, longest relative travel of a vertex in one substep
float beyond;            // m, bound on the motion of other bodies relative to first_body: x of the root's kQueryPoint row
int first_body;          // -1: no body may touch the strand; travel is relative to the world

void loadBodies() {
  const vec2 own = contacts[contactRow(root_vertex, kQueryPoint)].xy;
  beyond = own.x;
  first_body = int(own.y);
  longest = 0.0;
  for (int p = 0; p < PER_THREAD; ++p) ways[p] = 0.0;
}

// Rigid motion of a body in a substep.
struct BodyMotion {
  vec3 a, way, turn;
};
BodyMotion bodyMotion(int substep) {
  if (first_body < 0) return BodyMotion(vec3(0), vec3(0), vec3(0));
  const PlacedBody body = bodyAt(uint(first_body), substep);
  return BodyMotion(body.a, body.a_motion, body.turn);
}
vec3 carriedBy(BodyMotion motion, vec3 point) { return carriedBy(point, motion.a, motion.way, motion.turn); }

// Accumulates the relative travel of the substep just solved.
void addTravel(int substep) {
  const BodyMotion motion = bodyMotion(substep);
  for (int p = 0; p < PER_THREAD; ++p) {
    const float way = length(x[p] - carriedBy(motion, x[p] - shift[p]));
    ways[p] += way;
    longest = max(longest, way);
  }
}

uint vertexOf(int p) { return root_vertex + uint(min(rank * PER_THREAD + p, edges - 1)) + 1u; }

// After the step: whether a body may have come within the reach of a query, which grows by half of the travel in a substep.
// `queried`: the vertices' new kQueryPoint rows, valid if no body did.
bool mayTouchBody(out vec4 queried[PER_THREAD]) {
  const BodyMotion motion = bodyMotion(0);
  bool comes = false;
  for (int p = 0; p < PER_THREAD; ++p) {
    const vec4 before = contacts[contactRow(vertexOf(p), kQueryPoint)];
    const vec3 start = positions[vertexOf(p)].xyz;
    const float room = separationBound(vertexOf(p), before) - length(before.xyz - carriedBy(motion, start)) - ways[p] - beyond;
    comes = comes || (isEdge(p) && !(room > 0.5 * longest && ways[p] < rest.arc_length));
    queried[p] = hasPlanes(before) ? before : vec4(x[p], room);
  }
  return comes;
}

void storeQueryPoints(vec4 queried[PER_THREAD]) {
  for (int p = 0; p < PER_THREAD; ++p)
    if (isEdge(p)) contacts[contactRow(vertexOf(p), kQueryPoint)] = queried[p];
}
