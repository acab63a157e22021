// How near bodies may have come to a strand that is done without them (clear_strands.comp): its part of rod.comp.
#include "gpu_compute/shaders/touch.glsl"
#include "gpu_compute/shaders/contact_sights.glsl"

float ways[PER_THREAD];  // m, of vertices in the substeps yet, as bodies that move together see them
float longest;           // m, the longest of one in a substep
float beyond;            // m: see kLooked of roots
int first_body;

void loadBodies() {
  const vec2 own = contacts[sightAt(root_vertex, kLooked)].xy;
  beyond = own.x;
  first_body = int(own.y);
  longest = 0.0;
  for (int p = 0; p < PER_THREAD; ++p) ways[p] = 0.0;
}

// How bodies that move together do in a substep.
struct BodyMotion {
  vec3 a, way, turn;
};
BodyMotion bodyMotion(int substep) {
  if (first_body < 0) return BodyMotion(vec3(0), vec3(0), vec3(0));
  const PlacedBody body = bodyAt(uint(first_body), substep);
  return BodyMotion(body.a, body.a_motion, body.turn);
}
vec3 carriedBy(BodyMotion motion, vec3 point) { return carriedBy(point, motion.a, motion.way, motion.turn); }

// After the substep.
void addWays(int substep) {
  const BodyMotion motion = bodyMotion(substep);
  for (int p = 0; p < PER_THREAD; ++p) {
    const float way = length(x[p] - carriedBy(motion, x[p] - shift[p]));
    ways[p] += way;
    longest = max(longest, way);
  }
}

uint vertexOf(int p) { return root_vertex + uint(min(rank * PER_THREAD + p, edges - 1)) + 1u; }

// After the step. Whether one may have come in reach, which in a substep grows by half of the way. `looked`: else what vertices have seen.
bool comesNear(out vec4 looked[PER_THREAD]) {
  const BodyMotion motion = bodyMotion(0);
  bool comes = false;
  for (int p = 0; p < PER_THREAD; ++p) {
    const vec4 before = contacts[sightAt(vertexOf(p), kLooked)];
    const vec3 start = positions[vertexOf(p)].xyz;
    const float room = roomOf(vertexOf(p), before) - length(before.xyz - carriedBy(motion, start)) - ways[p] - beyond;
    comes = comes || (isEdge(p) && !(room > 0.5 * longest && ways[p] < rest.arc_length));
    looked[p] = seesPlanes(before) ? before : vec4(x[p], room);
  }
  return comes;
}

void storeSights(vec4 looked[PER_THREAD]) {
  for (int p = 0; p < PER_THREAD; ++p)
    if (isEdge(p)) contacts[sightAt(vertexOf(p), kLooked)] = looked[p];
}
