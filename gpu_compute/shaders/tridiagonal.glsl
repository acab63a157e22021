// Symmetric tridiagonal systems along a strand, one row per edge. Each invocation eliminates all of its rows but the last.
// The reduced system couples the last rows of neighbours only; parallel cyclic reduction (Hockney 1965) solves it.
// Requires strand_threads.glsl.

// Back substitution of both solvers, in place of `value`. `solved`: the solution of the last row. `to_before`,
// `to_after`: what couples each row to the last row of the invocation before and to the row after it.
// Returns the solution of the row before row 0, or 0 where there is none.
float substituted(float solved, float to_before[PER_THREAD], float to_after[PER_THREAD], inout float value[PER_THREAD]) {
  float solved_before = 0.0;
#if THREADS > 1
  send_d(solved);
  exchangeBarrier();
  solved_before = select(hasBefore(1), received_d(before(1)), 0.0);
  swapBank();
#endif
  value[kLast] = solved;
  for (int p = kLast - 1; p >= 0; --p) value[p] -= to_before[p] * solved_before + to_after[p] * value[p + 1];
  return solved_before;
}

// Solves in place of `value`, the right-hand sides. `lower[p]` couples row p to the row before it; 0 in the strand's first
// row. The pivots of a chain cancel to a small part of the diagonal and lose digits; solveTridiagonal() keeps them.
// Returns the solution of the row before row 0, or 0 where there is none.
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
  exchangeBarrier();
  vec3 folded = select(hasAfter(1), received_a(after(1)).xyz, vec3(0));
  swapBank();
  own += folded.x;
  solved += folded.y;
  float up = folded.z;  // what couples this row to the one after
  for (int doubling = 0; doubling < OPAQUE_COUNT(kReductionRounds); ++doubling) {
    int distance = 1 << doubling;
    send_a(vec4(coupling, up, 1.0 / max(own, least), solved));
    exchangeBarrier();
    vec4 inner = received_a(before(distance)), outer = received_a(after(distance));
    swapBank();
    float from_inner = coupling * inner.z, from_outer = up * outer.z;
    own -= from_inner * coupling + from_outer * up;
    solved -= from_inner * inner.w + from_outer * outer.w;
    coupling = -from_inner * inner.x;
    up = -from_outer * outer.y;
  }
#endif
  return substituted(solved / max(own, least), to_before, to_after, value);
}

// solveTridiagonal() stores, in place of the diagonal, the slack of each row: the diagonal less the absolute couplings.
// Elimination only adds to slacks, so nothing cancels (as in Grassmann, Taksar and Heyman 1985).

// Converts the diagonal to slacks, in place. The coupling of the last row to the row after it is not yet subtracted.
void diagonalToSlack(inout float diagonal[PER_THREAD], float lower[PER_THREAD]) {
  for (int p = 0; p < PER_THREAD; ++p) diagonal[p] -= abs(lower[p]) + (p < kLast ? abs(lower[min(p + 1, kLast)]) : 0.0);
}

// Like solveChain(), with the `slacks` of diagonalToSlack(). Pivots are clamped to at least `pivot`, one per row; in the
// reduction, where the pivots of a chain fall with its length, to at least a tenth of it.
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
  exchangeBarrier();
  vec3 folded = select(hasAfter(1), received_a(after(1)).xyz, vec3(0));
  swapBank();
  slack += folded.x;
  solved += folded.y;
  float up = folded.z;  // what couples this row to the one after
  for (int doubling = 0; doubling < OPAQUE_COUNT(kReductionRounds); ++doubling) {
    int distance = 1 << doubling;
    float inverse = 1.0 / max(slack + abs(coupling) + abs(up), least);
    send_a(vec4(coupling, up, inverse, solved));
    send_d(slack * inverse);
    exchangeBarrier();
    vec4 inner = received_a(before(distance)), outer = received_a(after(distance));
    float inner_slack = received_d(before(distance)), outer_slack = received_d(after(distance));
    swapBank();
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
