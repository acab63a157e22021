// Part of rod.comp: lengths between pins (PINNED). The CPU's counterpart is core/rod_sweep.inl.

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
