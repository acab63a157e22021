// Part of rod.comp: contact of a strand in a substep, with the cached contact planes of query_contacts.comp (BODIES).
#if STALE_CACHE
#include "gpu_compute/shaders/bodies.glsl"
#else
#include "gpu_compute/shaders/contact_plane.glsl"
#endif
#include "gpu_compute/shaders/contact_cache.glsl"
#if STALE_CACHE
#include "gpu_compute/shaders/contact_query.glsl"
#endif

// The root motion that roots.comp stored.
RootMotion knownRoot(int substep) {
  const vec4 a = contacts[contactRow(root_vertex, kRootPosition)], b = contacts[contactRow(root_vertex, kRootTangent)];
  const vec4 found = contacts[contactRow(root_vertex, kCover)];
  RootMotion root;
  root.position = a.xyz;
  root.jump = vec3(a.w, b.w, found.w);
  root.tangent_old = b.xyz;
  root.rotation = contacts[contactRow(root_vertex, kRootRotation)];
  root.spin = found.z;
  root.time = timeAfter(substep);
  computeSwing(root);
  return root;
}

bool has_planes[PER_THREAD];  // whether vertices have cached contact planes
bool displaced[PER_THREAD];   // whether exact lengths displaced vertices by more than contactSlack() after contact

uint vertexOf(int p) { return root_vertex + uint(min(rank * PER_THREAD + p, edges - 1)) + 1u; }

void loadContacts() {
  for (int p = 0; p < PER_THREAD; ++p) {
    pressing[p] = contacts[vertexOf(p)].xyz * settings.time2;
    has_planes[p] = hasPlanes(contacts[contactRow(vertexOf(p), kQueryPoint)]);
  }
}

void storeContacts() {
  for (int p = 0; p < PER_THREAD; ++p)
    if (isEdge(p)) contacts[vertexOf(p)] = vec4(pressing[p] / settings.time2, displaced[p] ? velocity_factor : -velocity_factor);
}

// Vertices with a stale contact cache query contacts again (STALE_CACHE), or have their strand listed for the variant that
// does.
#if STALE_CACHE
// The loop must not be unrolled, because it contains the code of every body's surface. The inner loops over q replace
// dynamic indexing, which would move the arrays from registers to memory.
void requeryIfMoved(int substep) {
  for (int p = 0; p < PER_THREAD; ++p) {
    vec3 start = x[0], way = shift[0];
    for (int q = 1; q < PER_THREAD; ++q)
      if (q == p) {
        start = x[q];
        way = shift[q];
      }
    vec3 place = start + way;
    uint vertex = vertexOf(p), found = contactRow(vertex, kQueryPoint);
    if (!isEdge(p) || !isCacheStale(contacts[found], place)) continue;
    queryContacts(strand, vertex, place, start, substep);
    bool now = hasPlanes(contacts[found]);
    for (int q = 0; q < PER_THREAD; ++q)
      if (q == p) has_planes[q] = now;
  }
}
#else
void requeryIfMoved(int substep) {
  for (int p = 0; p < PER_THREAD; ++p)
    if (isEdge(p) && isCacheStale(contacts[contactRow(vertexOf(p), kQueryPoint)], x[p] + shift[p])) stale_cache = true;
}
#endif

// The contact plane of the vertex of slot p at `place`. Returns whether a body is near or pressed the vertex before.
bool nearBody(int p, vec3 place, out ContactPlane plane) {
  plane = noContact(place, contactReach());
  const bool pressed = dot(pressing[p], pressing[p]) > 0.0;
  if (!(has_planes[p] || pressed) || !isEdge(p) || weight(p) == 0.0) return false;
  if (has_planes[p]) plane = deepestPlane(vertexOf(p), place);
#if GROOMED == 2
  plane.friction *= frictionAndDampingOf(vertexOf(p)).x;
#elif GROOMED
  plane.friction *= strand_grooming.x;
#endif
  const bool near = pressed || plane.gap < contactReach();
  near_contact = near_contact || near;
  body_nearness = max(body_nearness, nearness(plane.gap));
  return near;
}

// Contact of each vertex alone, before the second length pass. Keeps the normals, so that the length solve does not push
// vertices back into bodies.
void collide(int substep) {
  requeryIfMoved(substep);
  for (int p = 0; p < PER_THREAD; ++p) {
    vec3 place = x[p] + shift[p];
    ContactPlane plane;
    if (!nearBody(p, place, plane) || !(plane.gap < 0.0 || dot(pressing[p], pressing[p]) > 0.0)) continue;
    place = resolveContact(place, plane.carried, plane.normal, plane.gap, plane.friction, weight(p), pressing[p]);
    shift[p] = place - x[p];
    if (plane.gap < 0.0 || dot(pressing[p], pressing[p]) > 0.0) {
      normals[p] = plane.normal;
      softness[p] = 0.0;
    }
  }
}

// Contact through the bending matrix, by active sets: core/rod_contact.inl, with the same names. `moved`: displacements by
// forces, m. Returns whether bodies press the strand or pressed it when the substep began.
bool pressThroughBending(int substep, vec3 moved[PER_THREAD]) {
  requeryIfMoved(substep);
  vec3 push[PER_THREAD], kept_friction[PER_THREAD], load[PER_THREAD], reaction[PER_THREAD], way[PER_THREAD];
  float follows[PER_THREAD], friction[PER_THREAD];
  bool held[PER_THREAD], touches = false;
  for (int p = 0; p < PER_THREAD; ++p) {
    push[p] = kept_friction[p] = load[p] = vec3(0);
    follows[p] = friction[p] = 0.0;
    held[p] = false;
    const vec3 place = x[p] + shift[p];
    ContactPlane plane;
    if (!nearBody(p, place, plane)) continue;
    const bool touched = plane.gap < 0.0 || dot(pressing[p], pressing[p]) > 0.0;
    touches = touches || touched;
    held[p] = touched && plane.gap < contactReach();
    push[p] = positionOnSurface(place, plane.carried, moved[p], plane.normal, plane.gap, plane.friction, weight(p), pressing[p],
                                follows[p], kept_friction[p]) -
              place;
    friction[p] = plane.friction;
    normals[p] = plane.normal;
    if (held[p]) continue;
    follows[p] = 0.0;
    if (touched) load[p] = -pressing[p];
  }
  touches = anyInStrand(touches);
  if (!anyInWorkgroup(touches)) {
    for (int p = 0; p < PER_THREAD; ++p) normals[p] = vec3(0);
    return false;
  }
  for (int round = 0; round < OPAQUE_COUNT(kActiveSetIterations); ++round) {
    bool fixed_now[PER_THREAD];
    float fixed_bits = 0.0;
    for (int p = 0; p < PER_THREAD; ++p) {
      fixed_now[p] = held[p] || weight(p) == 0.0;
      if (p >= kLast - 1 && fixed_now[p]) fixed_bits += p == kLast ? 2.0 : 1.0;
    }
    send_d(fixed_bits);
    exchangeBarrier();
    const float fixed_in = received_d(before(1));
    swapBank();
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
      const bool goes = held[p] && isReleased(pressing[p], reaction[p], normals[p]);
      const bool comes = !held[p] && dot(normals[p], normals[p]) > 0.0 && becomesHeld(push[p], way[p], normals[p]);
      if (goes || comes) {
        held[p] = comes;
        load[p] = goes ? -pressing[p] : vec3(0);
        changed = true;
      }
    }
    if (!anyInWorkgroup(anyInStrand(changed))) break;
  }
  for (int p = 0; p < PER_THREAD; ++p) {
    if (touches) shift[p] += way[p];
    if (held[p] && touches) {
      pressing[p] = heldForce(pressing[p], reaction[p], follows[p], kept_friction[p], normals[p], friction[p]);
      softness[p] = 0.0;
    } else {
      pressing[p] += load[p];
      normals[p] = vec3(0);
    }
  }
  return touches;
}

// Whether exact lengths may have put a vertex of this invocation into a body. resolve_penetration.comp then corrects the
// strand. `checked`: displacements as contact left them, m.
bool mayPenetrate(vec3 checked[PER_THREAD]) {
  bool any = false;
  for (int p = 0; p < PER_THREAD; ++p) {
    vec3 off = shift[p] - checked[p];
    displaced[p] = isEdge(p) && weight(p) > 0.0 && dot(off, off) > contactSlack() * contactSlack();
    any = any || (displaced[p] && needsRequery(vertexOf(p), x[p] + shift[p]));
  }
  return any;
}
