// Contact of a strand of the rod with the bodies of a step: its part of rod.comp.

void loadContacts() {
  for (int p = 0; p < PER_THREAD; ++p)
    pressing[p] = contacts[root_vertex + uint(min(rank * PER_THREAD + p, edges - 1)) + 1u].xyz *
                  (settings.substep * settings.substep);
}

void storeContacts() {
  for (int p = 0; p < PER_THREAD; ++p)
    if (isEdge(p))
      contacts[root_vertex + uint(rank * PER_THREAD + p) + 1u] =
          vec4(pressing[p] * (settings.per_substep * settings.per_substep), 0);
}

// Entry p of what is in registers, for loops over slots that are not to be unrolled, because the text of every body's surface
// is in them. Indexed as usual, such arrays would go to memory.
vec3 slot(vec3 of[PER_THREAD], int p) { return p < 2 ? (p == 0 ? of[0] : of[1]) : p == 2 ? of[2] : of[3]; }
float slot(float of[PER_THREAD], int p) { return p < 2 ? (p == 0 ? of[0] : of[1]) : p == 2 ? of[2] : of[3]; }

// The body that is nearest to the vertex of slot p at `place`.
Touch nearestTouch(int p, vec3 place, float time) {
  uvec2 range = nearRange(strand);
  Touch touch = untouched(place);
  vec3 begin = slot(x, p);
  float clear = clearance(p);
  for (uint i = range.x; i < range.y; ++i) {
    SubstepBody body = bodyAt(nearBody(i), time);
#if GROOMED
    body.friction *= strand_grooming.x;
#endif
    meet(body, place, begin, clear, touch);
  }
  return touch;
}

// Contact of the vertices, which forces have moved by `moved` just now; the normals are kept for the length solve, which must
// not push them back in.
void collide(float time, vec3 moved[PER_THREAD]) {
  Touch touch[PER_THREAD];
  for (int p = 0; p < PER_THREAD; ++p) {
    Touch found = nearestTouch(p, slot(x_new, p), time);
    for (int q = 0; q < PER_THREAD; ++q)
      if (q == p) touch[q] = found;
  }
  for (int p = 0; p < PER_THREAD; ++p) {
    bool touches = touch[p].gap < 0.0 || dot(pressing[p], pressing[p]) > 0.0;
    if (!touches || weight(p) == 0.0) continue;
    x_new[p] = resolveContact(x_new[p], touch[p].carried, moved[p], touch[p].normal, touch[p].gap, touch[p].friction,
                              weight(p), pressing[p]);
    if (touch[p].gap < 0.0 || dot(pressing[p], pressing[p]) > 0.0) {
      normals[p] = touch[p].normal;
      softness[p] = 0.0;
    }
  }
}

shared vec3 last_placed[WORKGROUP];

// The places of the slots' vertices, held to the side of the bodies that they were on: where one is too deep, its strand is
// placed anew from the root, one vertex after another. `checked`: where contact left them, `direction`: of their edges.
// Returns the place of the vertex before slot 0.
vec3 keepOut(RootMotion root, float time, vec3 checked[PER_THREAD], vec3 direction[PER_THREAD], vec3 start,
             inout vec3 placed[PER_THREAD]) {
  float lengths[PER_THREAD], weights[PER_THREAD];
  for (int p = 0; p < PER_THREAD; ++p) {
    lengths[p] = restLength(p);
    weights[p] = isEdge(p) ? weight(p) : -1.0;  // padding goes with the tip
  }
  forgetNoted();
  barrier();
  for (int at = -1; at < THREADS; ++at) {  // first all look, then one invocation after another places
    vec3 inner = root.position;
    if (at >= 0) {
      last_placed[me] = placed[kLast];
      barrier();
      if (any_noted == 0u) return start;  // the same for the whole workgroup
      if (hasBefore(1)) inner = last_placed[before(1)];
      barrier();
      if (rank != at || !isNoted()) continue;
      start = inner;
    }
    for (int p = 0; p < PER_THREAD; ++p) {
      vec3 place = slot(placed, p);
      float edge_length = slot(lengths, p);
      bool free = slot(weights, p) > 0.0;
      if (at >= 0 && slot(weights, p) != 0.0) place = madd(slot(direction, p), edge_length, inner);
      for (int round = 0; round < 3 && free; ++round) {
        vec3 off = place - slot(checked, p);
        if (dot(off, off) <= contactSlack() * contactSlack()) break;
        Touch touch = nearestTouch(p, place, time);
        if (touch.gap >= -contactSlack()) break;
        if (at < 0) {
          noteStrand();
          break;
        }
        bool last = round == 2 && touch.gap > -deepestTurn();
        place = last ? turnedOut(place, inner, touch.normal, touch.gap, edge_length)
                     : turnedTowards(place, inner, touch.normal, touch.gap, edge_length);
      }
      for (int q = 0; q < PER_THREAD; ++q)
        if (q == p) placed[q] = place;
      inner = place;
    }
  }
  return start;
}
