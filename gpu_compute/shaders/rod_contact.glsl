// Contact of a strand of the rod in a substep, with what its vertices see of bodies (look.comp): its part of rod.comp.
#if ASTRAY
#include "gpu_compute/shaders/bodies.glsl"
#else
#include "gpu_compute/shaders/touch.glsl"
#endif
#include "gpu_compute/shaders/contact_sights.glsl"
#if ASTRAY
#include "gpu_compute/shaders/root_cover.glsl"
#include "gpu_compute/shaders/contact_look.glsl"
#endif

// How the root moves, as roots.comp has found it.
RootMotion knownRoot(int substep) {
  const vec4 a = contacts[sightAt(root_vertex, kRootPosition)], b = contacts[sightAt(root_vertex, kRootTangent)];
  const vec4 found = contacts[sightAt(root_vertex, kCover)];
  RootMotion root;
  root.position = a.xyz;
  root.jump = vec3(a.w, b.w, found.w);
  root.tangent_old = b.xyz;
  root.rotation = contacts[sightAt(root_vertex, kRootRotation)];
  root.spin = found.z;
  root.time = timeAfter(substep);
  findSwing(root);
  return root;
}

bool sees[PER_THREAD];       // whether vertices have planes
bool displaced[PER_THREAD];  // whether exact lengths have moved them from where contact had left them

uint vertexOf(int p) { return root_vertex + uint(min(rank * PER_THREAD + p, edges - 1)) + 1u; }

void loadContacts() {
  for (int p = 0; p < PER_THREAD; ++p) {
    pressing[p] = contacts[vertexOf(p)].xyz * settings.time2;
    sees[p] = seesPlanes(contacts[sightAt(vertexOf(p), kLooked)]);
  }
}

void storeContacts() {
  for (int p = 0; p < PER_THREAD; ++p)
    if (isEdge(p))
      contacts[vertexOf(p)] = vec4(pressing[p] / settings.time2, displaced[p] ? speed_kept : -speed_kept);
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
    look(strand, vertex, place, start, substep);
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

// What the bodies are to the vertex of slot p at `place`; whether one is near or has pressed it.
bool nearBody(int p, vec3 place, out Touch touch) {
  touch = untouched(place, contactReach());
  const bool pressed = dot(pressing[p], pressing[p]) > 0.0;
  if (!(sees[p] || pressed) || !isEdge(p) || weight(p) == 0.0) return false;
  if (sees[p]) touch = touchOf(vertexOf(p), place);
#if GROOMED == 2
  touch.friction *= frictionAndDampingOf(vertexOf(p)).x;
#elif GROOMED
  touch.friction *= strand_grooming.x;
#endif
  const bool near = pressed || touch.gap < contactReach();
  meets = meets || near;
  near_body = max(near_body, nearness(touch.gap));
  return near;
}

// Contact of the vertices by themselves; the normals are kept for the length solve, which must not push them back in.
void collide(int substep) {
  lookOn(substep);
  for (int p = 0; p < PER_THREAD; ++p) {
    vec3 place = x[p] + shift[p];
    Touch touch;
    if (!nearBody(p, place, touch) || !(touch.gap < 0.0 || dot(pressing[p], pressing[p]) > 0.0)) continue;
    place = resolveContact(place, touch.carried, touch.normal, touch.gap, touch.friction, weight(p), pressing[p]);
    shift[p] = place - x[p];
    if (touch.gap < 0.0 || dot(pressing[p], pressing[p]) > 0.0) {
      normals[p] = touch.normal;
      softness[p] = 0.0;
    }
  }
}

// Contact through the bending matrix of strands whose vertices forces have just moved by `moved`: core/held_contact.inl, which names the
// same things. Whether bodies press the strand, or have.
bool pressThroughBending(int substep, vec3 moved[PER_THREAD]) {
  lookOn(substep);
  vec3 push[PER_THREAD], rubs[PER_THREAD], load[PER_THREAD], reaction[PER_THREAD], way[PER_THREAD];
  float follows[PER_THREAD], friction[PER_THREAD];
  bool held[PER_THREAD], touches = false;
  for (int p = 0; p < PER_THREAD; ++p) {
    push[p] = rubs[p] = load[p] = vec3(0);
    follows[p] = friction[p] = 0.0;
    held[p] = false;
    const vec3 place = x[p] + shift[p];
    Touch touch;
    if (!nearBody(p, place, touch)) continue;
    const bool touched = touch.gap < 0.0 || dot(pressing[p], pressing[p]) > 0.0;
    touches = touches || touched;
    held[p] = touched && touch.gap < contactReach();
    push[p] = heldPlace(place, touch.carried, moved[p], touch.normal, touch.gap, touch.friction, weight(p), pressing[p], follows[p], rubs[p]) - place;
    friction[p] = touch.friction;
    normals[p] = touch.normal;
    if (held[p]) continue;
    follows[p] = 0.0;
    if (touched) load[p] = -pressing[p];
  }
  touches = ofStrand(touches);
  if (!anyStrand(touches)) {
    for (int p = 0; p < PER_THREAD; ++p) normals[p] = vec3(0);
    return false;
  }
  for (int round = 0; round < REPEATS(kHoldRounds); ++round) {
    bool fixed_now[PER_THREAD];
    float fixed_bits = 0.0;
    for (int p = 0; p < PER_THREAD; ++p) {
      fixed_now[p] = held[p] || weight(p) == 0.0;
      if (p >= kLast - 1 && fixed_now[p]) fixed_bits += p == kLast ? 2.0 : 1.0;
    }
    send_d(fixed_bits);
    rendezvous();
    const float fixed_in = received_d(before(1));
    release();
    const bool in1 = fixed_in > 1.5, in2 = fixed_in == 1.0 || fixed_in == 3.0;
    float own[PER_THREAD], next[PER_THREAD - 1], further[PER_THREAD];
    for (int p = 0; p < PER_THREAD; ++p) {
      own[p] = select(fixed_now[p], 1.0, diagonal[p]);
      if (p < kLast) next[p] = select(fixed_now[p] || fixed_now[min(p + 1, kLast)], 0.0, first[p]);
      if (p < kLast - 1) further[p] = select(fixed_now[p] || fixed_now[min(p + 2, kLast)], 0.0, second[p]);
      way[p] = select(held[p], push[p], vec3(0));
      reaction[p] = load[p];
    }
    const vec3 coupled = vec3(select(fixed_now[0] || in2, 0.0, across.x), select(fixed_now[0] || in1, 0.0, across.y),
                              select(fixed_now[1] || in1, 0.0, across.z));
    residual(diagonal, first, second, across, way, reaction);
    for (int p = 0; p < PER_THREAD; ++p) way[p] = select(fixed_now[p], way[p], reaction[p]);
    solvePentadiagonal(own, next, further, coupled, way);
    reaction = load;
    residual(diagonal, first, second, across, way, reaction);
    bool changed = false;
    for (int p = 0; p < PER_THREAD; ++p) {
      reaction[p] = -reaction[p];
      const bool goes = held[p] && letsGo(pressing[p], reaction[p], normals[p]);
      const bool comes = !held[p] && dot(normals[p], normals[p]) > 0.0 && isPushed(push[p], way[p], normals[p]);
      if (goes || comes) {
        held[p] = comes;
        load[p] = goes ? -pressing[p] : vec3(0);
        changed = true;
      }
    }
    if (!anyStrand(ofStrand(changed))) break;
  }
  for (int p = 0; p < PER_THREAD; ++p) {
    if (touches) shift[p] += way[p];
    if (held[p] && touches) {
      pressing[p] = heldForce(pressing[p], reaction[p], follows[p], rubs[p], normals[p], friction[p]);
      softness[p] = 0.0;
    } else {
      pressing[p] += load[p];
      normals[p] = vec3(0);
    }
  }
  return touches;
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
