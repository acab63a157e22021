// Lengths between pins: core/pinned_lengths.inl. A part of rod.comp.

// The most tautness() of what is between two pins, as they are held at the end of the step; 1 where there is none. From every pin back to
// the one before it.
float mostTautness() {
  const Pose root = rootPoses(strand).end;
  float most = 1.0;
  for (int p = 0; p < PER_THREAD; ++p) {
    if (!isEdge(p) || weight(p) > 0.0) continue;
    const uint inner = root_vertex + uint(rank * PER_THREAD + p);
    uint pin = inner;
    float length_between = restLength(p);
    for (; pin > root_vertex && edge_rest[pin - 1u].w > 0.0; --pin) length_between += edge_rest[pin - 1u].x;
    if (pin == inner) continue;  // they are neighbours
    most = max(most, tautness(length(heldPoint(inner + 1u, root, 1.0) - heldPoint(pin, root, 1.0)), length_between));
  }
  return strandMax(most);
}

// What exact lengths have missed each pin by is shared by the edges before it, by their lengths. `along`: shifts; `lengths`: since the last
// pin, at a pin since the one before.
void shareMissing(inout vec3 along[PER_THREAD], vec3 missed[PER_THREAD], float lengths[PER_THREAD]) {
  vec4 next = vec4(0);  // of the first pin from this invocation on: what it has missed per length, and that there is one
  for (int p = kLast; p >= 0; --p)
    if (isEdge(p) && weight(p) == 0.0) next = vec4(missed[p] / max(lengths[p], 1e-9), 1);
#if THREADS > 1
  for (int doubling = 0; doubling < REPEATS(kDoublings); ++doubling) {
    const int distance = 1 << doubling;
    send_a(next);
    rendezvous();
    const vec4 other = received_a(after(distance));
    release();
    next = select(hasAfter(distance) && next.w == 0.0, other, next);
  }
  send_a(next);
  rendezvous();
  next = received_a(after(1));
  release();
  next = select(hasAfter(1), next, vec4(0));
#else
  next = vec4(0);
#endif
  for (int p = kLast; p >= 0; --p) {
    if (!isEdge(p)) continue;
    if (weight(p) == 0.0) next = vec4(missed[p] / max(lengths[p], 1e-9), 1);
    else along[p] += next.xyz * lengths[p];
  }
#if THREADS > 1
  send_a(vec4(along[kLast], 0));
  rendezvous();
  const vec3 last_before = received_a(before(1)).xyz;
  release();
  shift_in = select(hasBefore(1), last_before, shift_in);
#endif
}
