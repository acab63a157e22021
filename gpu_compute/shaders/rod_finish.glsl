// Part of rod.comp: the end of a substep. Exact lengths, also between pins, velocities, and the velocity clamp of strands
// that overshoot.

#if PINNED
// Lengths between pins (PINNED). The CPU's counterpart is core/rod_sweep.inl.

// Greatest tautness() of the strand's stretches between two pins, with the pins at the end of the step; 1 if there is none.
// Each pin is paired with the pin before it.
float maxTautness() {
  const Pose root = rootPoses(strand).end;
  float most = 1.0;
  for (int p = 0; p < PER_THREAD; ++p) {
    if (!isEdge(p) || weight(p) > 0.0) continue;
    const uint inner = root_vertex + uint(rank * PER_THREAD + p);
    uint pin = inner;
    float length_between = restLength(p);
    for (; pin > root_vertex && edge_rest[pin - 1u].w > 0.0; --pin) length_between += edge_rest[pin - 1u].x;
    if (pin == inner) continue;  // adjacent pins
    most = max(most, tautness(length(heldPoint(inner + 1u, root, 1.0) - heldPoint(pin, root, 1.0)), length_between));
  }
  return strandMax(most);
}

// Distributes the distance by which exact lengths miss each pin over the edges before it, by their lengths. `along`:
// displacements, m. `missed`: of pins, m. `lengths`: arc length since the last pin, m; at a pin, since the pin before it.
void shareMissing(inout vec3 along[PER_THREAD], vec3 missed[PER_THREAD], float lengths[PER_THREAD]) {
  vec4 next = vec4(0);  // of the first pin from this invocation on: missed distance per length; w: 1 if there is one
  for (int p = kLast; p >= 0; --p)
    if (isEdge(p) && weight(p) == 0.0) next = vec4(missed[p] / max(lengths[p], 1e-9), 1);
#if THREADS > 1
  for (int doubling = 0; doubling < OPAQUE_COUNT(kReductionRounds); ++doubling) {
    const int distance = 1 << doubling;
    send_a(next);
    exchangeBarrier();
    const vec4 other = received_a(after(distance));
    swapBank();
    next = select(hasAfter(distance) && next.w == 0.0, other, next);
  }
  send_a(next);
  exchangeBarrier();
  next = received_a(after(1));
  swapBank();
  next = select(hasAfter(1), next, vec4(0));
#else
  next = vec4(0);
#endif
  for (int p = kLast; p >= 0; --p) {
    if (!isEdge(p)) continue;
    if (weight(p) == 0.0)
      next = vec4(missed[p] / max(lengths[p], 1e-9), 1);
    else
      along[p] += next.xyz * lengths[p];
  }
#if THREADS > 1
  send_a(vec4(along[kLast], 0));
  exchangeBarrier();
  const vec3 last_before = received_a(before(1)).xyz;
  swapBank();
  shift_in = select(hasBefore(1), last_before, shift_in);
#endif
}

#endif

#if DENSE_METRIC && (BODIES || PINNED)
// Greatest speed, m/s, before the substep's new velocities: of the strand's vertices, its root, its pins and the bodies
// beside it. Among bodies the old velocities are read again, because keeping them would add register pressure.
// `checked`: see finish().
float fastestOfStrand(vec3 checked[PER_THREAD]) {
  const vec3 root = rank == 0 ? shift_in : vec3(0);
  float way2 = dot(root, root), speed2 = 0.0;
  for (int p = 0; p < PER_THREAD; ++p) {
    if (!isEdge(p)) continue;
#if BODIES
    const vec3 old = velocities[vertexOf(p)].xyz;
#else
    const vec3 old = v[p];
#endif
    speed2 = max(speed2, dot(old, old));
    if (weight(p) == 0.0) way2 = max(way2, dot(checked[p], checked[p]));
#if BODIES
    else if (has_planes[p])
      way2 = max(way2, carried2Of(vertexOf(p), x[p] + checked[p], x[p]));
#endif
  }
  return sqrt(strandMax(max(speed2, way2 * settings.per_substep * settings.per_substep)));
}
// Velocity clamp, on the substep's new velocities. `fastest`: fastestOfStrand(), m/s; `overshot`: overshoot().
void clampVelocities(float fastest, float overshot) {
  float speed2 = 0.0;
  for (int p = 0; p < PER_THREAD; ++p)
    if (isEdge(p)) speed2 = max(speed2, dot(v[p], v[p]));
  const float kept = velocityClamp(sqrt(strandMax(speed2)), fastest, overshot, between_pins);
#if BODIES
  velocity_factor = kept;
#endif
  for (int p = 0; p < PER_THREAD; ++p)
    if (weight(p) > 0.0) v[p] *= kept;
  if (hasBefore(1) && weight_in > 0.0) v_in *= kept;  // the same as in the invocation before
}
#endif

// Exact lengths along the solved edge directions, from the root or the last pinned vertex outwards, by a scan. Then
// velocities and positions.
#if BODIES
// `checked`: displacements as contact left them, m.
void finish(vec3 checked[PER_THREAD]) {
#else
void finish() {
#endif
#if DENSE_METRIC && BODIES
  float overshot = overshoot(most, 1.0), fastest = 0.0;
  const bool any_overshot = anyInWorkgroup(overshot > 0.0);
  if (any_overshot) {
    overshot = overshoot(most, select(between_pins, 1.0, strandMax(body_nearness)));
    fastest = fastestOfStrand(checked);
  }
#elif DENSE_METRIC && PINNED
  const float overshot = overshoot(most, select(between_pins, 1.0, 0.0));
  const bool any_overshot = anyInWorkgroup(overshot > 0.0);
  const float fastest = any_overshot ? fastestOfStrand(shift) : 0.0;
#endif
  vec3 along[PER_THREAD];  // displacements, less that of the vertex before slot 0 unless that is the root
  bool anchored[PER_THREAD];
  vec3 sum = select(hasBefore(1), vec3(0), shift_in);
  bool fixed_here = false;
#if PINNED
  // `missed`: of pins, m: by how much exact lengths from the pin before miss them; without that pin's displacement if it is
  // in an earlier invocation. `lengths`: of all slots, arc length since the last pin, m.
  vec3 missed[PER_THREAD];
  float lengths[PER_THREAD], run = 0.0;
  bool follows_pin[PER_THREAD];  // whether a pin is in an earlier slot of this invocation
#endif
  for (int p = 0; p < PER_THREAD; ++p) {
    sum += select(isEdge(p), edgeShift(p) + missingLength(newEdge(p), tangent[p], restLength(p)), vec3(0));
#if PINNED
    run += restLength(p);
    lengths[p] = run;
    follows_pin[p] = fixed_here;
    missed[p] = shift[p] - sum;
    if (weight(p) == 0.0) {
      sum = shift[p];
      run = 0.0;
      fixed_here = true;
    }
#endif
    along[p] = sum;
    anchored[p] = fixed_here;
  }
#if THREADS > 1
  for (int doubling = 0; doubling < OPAQUE_COUNT(kReductionRounds); ++doubling) {
    int distance = 1 << doubling;
    send_a(vec4(sum, fixed_here ? 1 : 0));
#if PINNED
    send_d(run);
#endif
    exchangeBarrier();
    vec4 other = received_a(before(distance));
#if PINNED
    const float other_run = received_d(before(distance));
#endif
    swapBank();
    const bool follows = hasBefore(distance) && !fixed_here;
    sum += select(follows, other.xyz, vec3(0));
#if PINNED
    run += select(follows, other_run, 0.0);
    fixed_here = fixed_here || (follows && other.w > 0.5);
#endif
  }
  // Takes the displacement of the vertex before slot 0 from the invocation before, bit for bit: both add it to the same
  // position.
#if PINNED
  send_a(vec4(sum, run));
#else
  send_a(vec4(sum, 0));
#endif
  exchangeBarrier();
  const vec4 last_before = received_a(before(1));
  swapBank();
  shift_in = select(hasBefore(1), last_before.xyz, shift_in);
  for (int p = 0; p < kLast; ++p) along[p] += select(hasBefore(1) && !anchored[p], last_before.xyz, vec3(0));
#if PINNED
  for (int p = 0; p < PER_THREAD; ++p) {
    const bool follows = hasBefore(1) && !follows_pin[p];
    missed[p] -= select(follows, last_before.xyz, vec3(0));
    lengths[p] += select(follows, last_before.w, 0.0);
  }
#endif
#endif
  along[kLast] = sum;
#if PINNED
  shareMissing(along, missed, lengths);
#endif
  shift = along;
#if BODIES
  lost = mayPenetrate(checked);
#endif
  v_in = shift_in * settings.per_substep;
  x_in += shift_in;
  for (int p = 0; p < PER_THREAD; ++p) {
    v[p] = shift[p] * settings.per_substep;
    x[p] += shift[p];
  }
#if DENSE_METRIC && (BODIES || PINNED)
  if (any_overshot) clampVelocities(fastest, overshot);
#endif
}
