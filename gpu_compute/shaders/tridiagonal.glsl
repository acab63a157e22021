// Symmetric tridiagonal systems along a strand, a row per edge. Every invocation eliminates its rows but the last; what is
// left couples only the last rows of neighbours and is solved by parallel cyclic reduction (Hockney 1965).
// Needs strand_threads.glsl.

// Of either: the rows before the last, whose solution is `solved`, from what couples them to it and to the invocation before.
// Returns the solution in the row before row 0, or 0 where there is none.
float substituted(float solved, float to_before[PER_THREAD], float to_after[PER_THREAD], inout float value[PER_THREAD]) {
  float solved_before = 0.0;
#if THREADS > 1
  send_d(solved);
  rendezvous();
  solved_before = select(hasBefore(1), received_d(before(1)), 0.0);
  release();
#endif
  value[kLast] = solved;
  for (int p = kLast - 1; p >= 0; --p) value[p] -= to_before[p] * solved_before + to_after[p] * value[p + 1];
  return solved_before;
}

// Solves in place of `value`, the right-hand sides. `lower[p]` couples row p to the row before it, 0 in the strand's first.
// The diagonal of a chain cancels down to a small part of itself, and digits with it; where they are wanted: solveTridiagonal().
// Returns the solution in the row before row 0, or 0 where there is none.
float solveChain(float diagonal[PER_THREAD], float lower[PER_THREAD], inout float value[PER_THREAD]) {
  const float least = 1e-30;
  float to_before[PER_THREAD], to_after[PER_THREAD];
  float coupling = lower[0], own = diagonal[0];
  float own_before = 0.0, value_before = 0.0;  // what elimination adds to the row before row 0
  for (int p = 0; p < kLast; ++p) {
    float inverse = 1.0 / max(own, least);
    to_before[p] = coupling * inverse;
    to_after[p] = lower[p + 1] * inverse;
    value[p] *= inverse;
    own_before -= coupling * to_before[p];
    value_before -= coupling * value[p];
    own = diagonal[p + 1] - lower[p + 1] * to_after[p];
    value[p + 1] -= lower[p + 1] * value[p];
    coupling = -lower[p + 1] * to_before[p];
  }
  float solved = value[kLast];
#if THREADS > 1
  send_a(vec4(own_before, value_before, coupling, 0));
  rendezvous();
  vec3 folded = select(hasAfter(1), received_a(after(1)).xyz, vec3(0));
  release();
  own += folded.x;
  solved += folded.y;
  float up = folded.z;  // what couples this row to the one after
  for (int doubling = 0; doubling < REPEATS(kDoublings); ++doubling) {
    int distance = 1 << doubling;
    send_a(vec4(coupling, up, 1.0 / max(own, least), solved));
    rendezvous();
    vec4 inner = received_a(before(distance)), outer = received_a(after(distance));
    release();
    float from_inner = coupling * inner.z, from_outer = up * outer.z;
    own -= from_inner * coupling + from_outer * up;
    solved -= from_inner * inner.w + from_outer * outer.w;
    coupling = -from_inner * inner.x;
    up = -from_outer * outer.y;
  }
#endif
  return substituted(solved / max(own, least), to_before, to_after, value);
}

// Of solveTridiagonal(): in place of the diagonal each row keeps its slack, the diagonal less the absolute couplings, to which
// elimination only adds (as in Grassmann, Taksar and Heyman 1985).

// Makes of the diagonal what solveTridiagonal wants.
void diagonalToSlack(inout float diagonal[PER_THREAD], float lower[PER_THREAD]) {
  for (int p = 0; p < PER_THREAD; ++p) diagonal[p] -= abs(lower[p]) + (p < kLast ? abs(lower[min(p + 1, kLast)]) : 0.0);
}

// As solveChain(). `slacks`: as above, the last still with the coupling to the row after it.
// Pivots are held above `pivot`, one per row; in the reduction, where the pivots of a chain fall with its length, above a
// tenth of that.
float solveTridiagonal(float slacks[PER_THREAD], float lower[PER_THREAD], float pivot[PER_THREAD],
                       inout float value[PER_THREAD]) {
  float to_before[PER_THREAD], to_after[PER_THREAD];
  float coupling = lower[0], slack = slacks[0];
  float slack_before = 0.0, value_before = 0.0;  // what elimination adds to the row before row 0
  for (int p = 0; p < kLast; ++p) {
    float inverse = 1.0 / max(slack + abs(coupling) + abs(lower[p + 1]), pivot[p]);
    to_before[p] = coupling * inverse;
    to_after[p] = lower[p + 1] * inverse;
    value[p] *= inverse;
    slack_before += abs(to_before[p]) * slack;
    value_before -= coupling * value[p];
    slack = abs(to_after[p]) * slack + slacks[p + 1];
    value[p + 1] -= lower[p + 1] * value[p];
    coupling = -lower[p + 1] * to_before[p];
  }
  float solved = value[kLast];
#if THREADS == 1
  solved /= max(slack + abs(coupling), pivot[kLast]);
#else
  const float least = 0.1 * pivot[kLast];
  send_a(vec4(slack_before - abs(lower[0]), value_before, coupling, 0));
  rendezvous();
  vec3 folded = select(hasAfter(1), received_a(after(1)).xyz, vec3(0));
  release();
  slack += folded.x;
  solved += folded.y;
  float up = folded.z;  // what couples this row to the one after
  for (int doubling = 0; doubling < REPEATS(kDoublings); ++doubling) {
    int distance = 1 << doubling;
    float inverse = 1.0 / max(slack + abs(coupling) + abs(up), least);
    send_a(vec4(coupling, up, inverse, solved));
    send_d(slack * inverse);
    rendezvous();
    vec4 inner = received_a(before(distance)), outer = received_a(after(distance));
    float inner_slack = received_d(before(distance)), outer_slack = received_d(after(distance));
    release();
    float from_inner = coupling * inner.z, from_outer = up * outer.z;
    slack += abs(coupling) * inner_slack + abs(up) * outer_slack;
    solved -= from_inner * inner.w + from_outer * outer.w;
    coupling = -from_inner * inner.x;
    up = -from_outer * outer.y;
  }
  solved /= max(slack, least);
#endif
  return substituted(solved, to_before, to_after, value);
}
