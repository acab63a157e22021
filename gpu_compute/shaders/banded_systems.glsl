// Symmetric banded systems along a strand: tridiagonal for lengths, pentadiagonal for bending. Requires
// strand_threads.glsl.

// Symmetric tridiagonal systems along a strand, one row per edge. Each invocation eliminates all of its rows but the last.
// The reduced system couples the last rows of neighbours only; parallel cyclic reduction (Hockney 1965) solves it.

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

// A symmetric pentadiagonal system along a strand, one row per edge, with right-hand sides for x, y and z. In 2 x 2 blocks
// it is block tridiagonal. An invocation with two blocks (PER_THREAD 4) eliminates the inner one; parallel cyclic
// reduction solves the system of the outer blocks.

// Storage: a symmetric 2 x 2 matrix is (00, 01, 11), a general one (00, 01, 10, 11).

// Inverse by pivots, not by the determinant: blocks of stiff strands are nearly singular, and the rounding of a determinant
// would spread to all entries. Blocks are positive definite; the lower bounds of the pivots guard against rounding.
vec3 inverseOf(vec3 s) {
  float first = 1.0 / max(s.x, 1e-30);
  float factor = s.y * first;
  float second = 1.0 / max(s.z - s.y * factor, max(1e-7 * s.z, 1e-30));
  return vec3(first + factor * factor * second, -factor * second, second);
}
vec4 symmetricTimes(vec3 s, vec4 m) {
  return vec4(s.x * m.x + s.y * m.z, s.x * m.y + s.y * m.w, s.y * m.x + s.z * m.z, s.y * m.y + s.z * m.w);
}
vec4 timesSymmetric(vec4 m, vec3 s) {
  return vec4(m.x * s.x + m.y * s.y, m.x * s.y + m.y * s.z, m.z * s.x + m.w * s.y, m.z * s.y + m.w * s.z);
}
vec4 product(vec4 a, vec4 b) {
  return vec4(a.x * b.x + a.y * b.z, a.x * b.y + a.y * b.w, a.z * b.x + a.w * b.z, a.z * b.y + a.w * b.w);
}
vec4 transposedTimes(vec4 a, vec4 b) {
  return vec4(a.x * b.x + a.z * b.z, a.x * b.y + a.z * b.w, a.y * b.x + a.w * b.z, a.y * b.y + a.w * b.w);
}
// Products that are known to be symmetric: transpose(a) b and a transpose(b).
vec3 symmetricTN(vec4 a, vec4 b) { return vec3(a.x * b.x + a.z * b.z, a.x * b.y + a.z * b.w, a.y * b.y + a.w * b.w); }
vec3 symmetricNT(vec4 a, vec4 b) { return vec3(a.x * b.x + a.y * b.y, a.x * b.z + a.y * b.w, a.z * b.z + a.w * b.w); }

#if THREADS > 1
// Parallel cyclic reduction of the outer blocks. d: diagonal block. c: coupling to the block before; its transpose couples
// that block to this one. f0, f1: right-hand sides of the two rows.
void reduceBlocks(inout vec3 d, vec4 c, inout vec3 f0, inout vec3 f1) {
  for (int doubling = 0; doubling < OPAQUE_COUNT(kReductionRounds); ++doubling) {
    int distance = 1 << doubling;
    send_a(vec4(inverseOf(d), c.x));
    send_b(vec4(f0, c.y));
    send_c(vec4(f1, c.z));
    send_d(c.w);
    exchangeBarrier();
    uint inner = before(distance), outer = after(distance);
    vec4 a = received_a(inner), b = received_b(inner), e = received_c(inner);
    float w = received_d(inner);
    vec4 from = timesSymmetric(c, a.xyz);
    d -= symmetricNT(from, c);
    f0 -= b.xyz * from.x + e.xyz * from.y;
    f1 -= b.xyz * from.z + e.xyz * from.w;
    c = -product(from, vec4(a.w, b.w, e.w, w));
    a = received_a(outer);
    b = received_b(outer);
    e = received_c(outer);
    w = received_d(outer);
    swapBank();
    vec4 up = select(hasAfter(distance), vec4(a.w, e.w, b.w, w), vec4(0));
    from = timesSymmetric(up, a.xyz);
    d -= symmetricNT(from, up);
    f0 -= b.xyz * from.x + e.xyz * from.y;
    f1 -= b.xyz * from.z + e.xyz * from.w;
  }
}
#endif

// Solves in place of f. first[p] couples rows p and p + 1; second[p] couples rows p and p + 2. across: couplings to the
// invocation before: row 0 to its last row but one (x), row 0 to its last row (y), row 1 to its last row (z).
void solvePentadiagonal(float diagonal[PER_THREAD], float first[PER_THREAD - 1], float second[PER_THREAD], vec3 across,
                        inout vec3 f[PER_THREAD]) {
  vec4 coupling = select(hasBefore(1), vec4(across.x, across.y, 0, across.z), vec4(0));
#if PER_THREAD == 2
  vec3 d = vec3(diagonal[0], first[0], diagonal[1]), f0 = f[0], f1 = f[1];
  reduceBlocks(d, coupling, f0, f1);
  vec3 inverse = inverseOf(d);
  f[0] = f0 * inverse.x + f1 * inverse.y;
  f[1] = f0 * inverse.y + f1 * inverse.z;
#else
  vec4 right = vec4(second[0], 0, first[1], second[1]);
  vec3 inverse = inverseOf(vec3(diagonal[0], first[0], diagonal[1]));
  vec4 to_before = symmetricTimes(inverse, coupling), to_outer = symmetricTimes(inverse, right);
  vec3 y0 = f[0] * inverse.x + f[1] * inverse.y, y1 = f[0] * inverse.y + f[1] * inverse.z;
  vec3 d = vec3(diagonal[2], first[2], diagonal[3]) - symmetricTN(right, to_outer);
  vec3 f0 = f[2] - (y0 * right.x + y1 * right.z), f1 = f[3] - y1 * right.w;
  vec3 before0 = vec3(0), before1 = vec3(0);
#if THREADS > 1
  vec3 folded = symmetricTN(coupling, to_before);
  send_a(vec4(y0 * coupling.x + y1 * coupling.z, folded.x));
  send_b(vec4(y0 * coupling.y + y1 * coupling.w, folded.y));
  send_d(folded.z);
  exchangeBarrier();
  vec4 a = received_a(after(1)), b = received_b(after(1));
  float w = received_d(after(1));
  swapBank();
  d -= select(hasAfter(1), vec3(a.w, b.w, w), vec3(0));
  f0 -= select(hasAfter(1), a.xyz, vec3(0));
  f1 -= select(hasAfter(1), b.xyz, vec3(0));
  reduceBlocks(d, -transposedTimes(right, to_before), f0, f1);
#endif
  inverse = inverseOf(d);
  f[2] = f0 * inverse.x + f1 * inverse.y;
  f[3] = f0 * inverse.y + f1 * inverse.z;
#if THREADS > 1
  send_a(vec4(f[2], 0));
  send_b(vec4(f[3], 0));
  exchangeBarrier();
  before0 = select(hasBefore(1), received_a(before(1)).xyz, vec3(0));
  before1 = select(hasBefore(1), received_b(before(1)).xyz, vec3(0));
  swapBank();
#endif
  f[0] = y0 - (before0 * to_before.x + before1 * to_before.y) - (f[2] * to_outer.x + f[3] * to_outer.y);
  f[1] = y1 - (before0 * to_before.z + before1 * to_before.w) - (f[2] * to_outer.z + f[3] * to_outer.w);
#endif
}

// Residual: subtracts the matrix times x from the right-hand sides f, in place.
void residual(float diagonal[PER_THREAD], float first[PER_THREAD - 1], float second[PER_THREAD], vec3 across, vec3 x[PER_THREAD],
              inout vec3 f[PER_THREAD]) {
  vec3 onto_before = x[0] * across.x;
  send_a(vec4(x[kLast - 1], onto_before.x));
  send_b(vec4(x[kLast], onto_before.y));
  send_c(vec4(x[0] * across.y + x[1] * across.z, onto_before.z));
  exchangeBarrier();
  vec3 before0 = received_a(before(1)).xyz, before1 = received_b(before(1)).xyz;
  vec3 onto0 = vec3(received_a(after(1)).w, received_b(after(1)).w, received_c(after(1)).w);
  vec3 onto1 = received_c(after(1)).xyz;
  swapBank();
  if (hasBefore(1)) {
    f[0] -= before0 * across.x + before1 * across.y;
    f[1] -= before1 * across.z;
  }
  if (hasAfter(1)) {
    f[kLast - 1] -= onto0;
    f[kLast] -= onto1;
  }
#if PER_THREAD == 2
  f[0] -= x[0] * diagonal[0] + x[1] * first[0];
  f[1] -= x[0] * first[0] + x[1] * diagonal[1];
#else
  f[0] -= x[0] * diagonal[0] + x[1] * first[0] + x[2] * second[0];
  f[1] -= x[0] * first[0] + x[1] * diagonal[1] + x[2] * first[1] + x[3] * second[1];
  f[2] -= x[0] * second[0] + x[1] * first[1] + x[2] * diagonal[2] + x[3] * first[2];
  f[3] -= x[1] * second[1] + x[2] * first[2] + x[3] * diagonal[3];
#endif
}
