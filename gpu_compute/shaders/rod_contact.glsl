// Contact of a strand of the rod in a substep, with what its vertices see of bodies (look.comp): its part of rod.comp.
#if ASTRAY
#include "gpu_compute/shaders/bodies.glsl"
#else
#include "gpu_compute/shaders/touch.glsl"
#endif
#include "gpu_compute/shaders/contact_sights.glsl"
#if ASTRAY
#include "gpu_compute/shaders/contact_look.glsl"
#endif

bool sees[PER_THREAD];       // whether vertices have planes
bool displaced[PER_THREAD];  // whether exact lengths have moved them from where contact had left them

uint vertexOf(int p) { return root_vertex + uint(min(rank * PER_THREAD + p, edges - 1)) + 1u; }

void loadContacts() {
  for (int p = 0; p < PER_THREAD; ++p) {
    pressing[p] = contacts[vertexOf(p)].xyz * (settings.substep * settings.substep);
    sees[p] = seesPlanes(contacts[sightAt(vertexOf(p), kLooked)]);
  }
}

void storeContacts() {
  for (int p = 0; p < PER_THREAD; ++p)
    if (isEdge(p))
      contacts[vertexOf(p)] = vec4(pressing[p] * (settings.per_substep * settings.per_substep), displaced[p] ? 1 : 0);
}

// Who has come too far from where it looked at bodies looks again: ASTRAY; else its strand is left to that program.
#if ASTRAY
// A loop that is not to be unrolled, because the text of every body's surface is in it; indexed as usual, arrays would go to
// memory.
void lookOn(int substep) {
  for (int p = 0; p < PER_THREAD; ++p) {
    vec3 start = x[0], way = shift[0];
    for (int q = 1; q < PER_THREAD; ++q)
      if (q == p) {
        start = x[q];
        way = shift[q];
      }
    vec3 place = start + way;
    uint vertex = vertexOf(p), sight = sightAt(vertex, kLooked);
    if (!isEdge(p) || !isAstray(contacts[sight], place)) continue;
    look(strand, vertex, place, start, clearance(velocities[vertex]), substep);
    bool now = seesPlanes(contacts[sight]);
    for (int q = 0; q < PER_THREAD; ++q)
      if (q == p) sees[q] = now;
  }
}
#else
void lookOn(int substep) {
  for (int p = 0; p < PER_THREAD; ++p)
    if (isEdge(p) && isAstray(contacts[sightAt(vertexOf(p), kLooked)], x[p] + shift[p])) astray = true;
}
#endif

// Contact of the vertices, which forces have moved by `moved` just now; the normals are kept for the length solve, which must
// not push them back in.
void collide(int substep, vec3 moved[PER_THREAD]) {
  lookOn(substep);
  for (int p = 0; p < PER_THREAD; ++p) {
    bool pressed = dot(pressing[p], pressing[p]) > 0.0;
    if (!(sees[p] || pressed) || !isEdge(p) || weight(p) == 0.0) continue;
    vec3 place = x[p] + shift[p];
    Touch touch = untouched(place, contactReach());
    if (sees[p]) touch = touchOf(vertexOf(p), place);
    meets = meets || pressed || touch.gap < contactReach();
    if (!(touch.gap < 0.0 || pressed)) continue;
#if GROOMED
    touch.friction *= strand_grooming.x;
#endif
    place = resolveContact(place, touch.carried, moved[p], touch.normal, touch.gap, touch.friction, weight(p), pressing[p]);
    shift[p] = place - x[p];
    if (touch.gap < 0.0 || dot(pressing[p], pressing[p]) > 0.0) {
      presses = true;
      normals[p] = touch.normal;
      softness[p] = 0.0;
    }
  }
}

// The vertices are where they stay, and were left by contact with the shifts `checked`: whether any of them may be in a body,
// keep_out.comp sees to it.
bool isLost(vec3 checked[PER_THREAD]) {
  bool any = false;
  for (int p = 0; p < PER_THREAD; ++p) {
    vec3 off = shift[p] - checked[p];
    displaced[p] = isEdge(p) && weight(p) > 0.0 && dot(off, off) > contactSlack() * contactSlack();
    any = any || (displaced[p] && looksBack(vertexOf(p), x[p] + shift[p]));
  }
  return any;
}
