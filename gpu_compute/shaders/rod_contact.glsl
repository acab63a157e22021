// Contact of a strand of the rod with the bodies of a step: its part of rod.comp.

uvec2 near_range;           // what nearBody() may be asked for
float weights[PER_THREAD];  // of vertices
#if !VIOLENT
float room[PER_THREAD];     // m, from where contact has left a vertex to the nearest body; 0 where it presses
#endif

// What contact does not look at is in shared memory meanwhile: what does not fit into registers goes to memory too, but to where
// the more workgroups a multiprocessor runs at once, the less stays in its cache.
shared vec4 parked_frames[PER_THREAD][WORKGROUP];
shared vec4 parked_joints[PER_THREAD][WORKGROUP];
void park() {
  for (int p = 0; p < PER_THREAD; ++p) {
    parked_frames[p][me] = frame[p];
    parked_joints[p][me] = vec4(rest_strain[p], bends[p]);
  }
}
void unpark() {
  for (int p = 0; p < PER_THREAD; ++p) {
    frame[p] = parked_frames[p][me];
    rest_strain[p] = parked_joints[p][me].xyz;
    bends[p] = parked_joints[p][me].w;
  }
}

void loadContacts() {
  near_range = nearRange(strand);
  for (int p = 0; p < PER_THREAD; ++p) weights[p] = isEdge(p) ? weight(p) : 0.0;
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
#if PER_THREAD == 2
vec3 slot(vec3 of[PER_THREAD], int p) { return p == 0 ? of[0] : of[1]; }
float slot(float of[PER_THREAD], int p) { return p == 0 ? of[0] : of[1]; }
#else
vec3 slot(vec3 of[PER_THREAD], int p) { return p < 2 ? (p == 0 ? of[0] : of[1]) : p == 2 ? of[2] : of[3]; }
float slot(float of[PER_THREAD], int p) { return p < 2 ? (p == 0 ? of[0] : of[1]) : p == 2 ? of[2] : of[3]; }
#endif

// The body that is nearest to the vertex of slot p at `place`.
Touch nearestTouch(int p, vec3 place, int substep) {
  Touch touch = untouched(place);
  vec3 begin = slot(x, p);
  float clear = clearance(p);
  for (uint i = near_range.x; i < near_range.y; ++i) meet(bodyAt(nearBody(i), substep), place, begin, clear, touch);
#if GROOMED
  touch.friction *= strand_grooming.x;
#endif
  return touch;
}

// Contact of the vertices, which forces have moved by `moved` just now; the normals are kept for the length solve, which must
// not push them back in.
void collide(int substep, vec3 moved[PER_THREAD]) {
  if (near_range.x == near_range.y) {
    for (int p = 0; p < PER_THREAD; ++p) pressing[p] = vec3(0);
    return;
  }
  for (int p = 0; p < PER_THREAD; ++p) {
    vec3 place = slot(x_new, p), force = slot(pressing, p);
    float free_weight = slot(weights, p);
    Touch touch = nearestTouch(p, place, substep);
    bool touches = (touch.gap < 0.0 || dot(force, force) > 0.0) && free_weight != 0.0;
    vec3 normal = slot(normals, p);
    float soft = slot(softness, p);
    if (touches) {
      place = resolveContact(place, touch.carried, slot(moved, p), touch.normal, touch.gap, touch.friction, free_weight, force);
      if (touch.gap < 0.0 || dot(force, force) > 0.0) {
        normal = touch.normal;
        soft = 0.0;
      }
    }
    for (int q = 0; q < PER_THREAD; ++q) {
      if (q != p) continue;
      x_new[q] = place;
      pressing[q] = force;
      normals[q] = normal;
      softness[q] = soft;
#if !VIOLENT
      room[q] = touches ? 0.0 : touch.gap;
#endif
    }
  }
}

#if !VIOLENT
// Whether making lengths exact may have pressed the vertex of slot p into a body, from `checked` to `placed`: its normal may
// turn by as much as 14 degrees on the way.
bool maySink(int p, vec3 checked, vec3 placed) {
  vec3 way = placed - checked;
  float off = length(way);
  float depth = room[p] > 0.0 ? off - room[p] : 0.25 * off - dot(way, normals[p]);
  return off > contactSlack() && depth > contactSlack() && weights[p] > 0.0;
}
#else
shared vec3 last_placed[WORKGROUP];

// The places of the slots' vertices, held to the side of the bodies that they were on: where one is too deep, its strand is
// placed anew from the root, one vertex after another. `checked`: where contact left them, `direction`: of their edges.
// Returns the place of the vertex before slot 0.
vec3 keepOut(RootMotion root, int substep, vec3 checked[PER_THREAD], vec3 direction[PER_THREAD], vec3 start,
             inout vec3 placed[PER_THREAD]) {
  float lengths[PER_THREAD];
  for (int p = 0; p < PER_THREAD; ++p) lengths[p] = restLength(p);
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
      if (at >= 0 && (free || rank * PER_THREAD + p >= edges)) place = madd(slot(direction, p), edge_length, inner);
      for (int round = 0; round < 3 && free; ++round) {
        vec3 off = place - slot(checked, p);
        if (dot(off, off) <= contactSlack() * contactSlack()) break;
        Touch touch = nearestTouch(p, place, substep);
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
#endif
