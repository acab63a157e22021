// A symmetric tridiagonal system along a strand, a row per edge. Every invocation eliminates its rows but the last; what is
// left couples only the last rows of neighbours and is solved by parallel cyclic reduction (Hockney 1965) in its symmetric
// form. Needs strand_threads.glsl.

// Solves in place of `value`, the right-hand sides; `lower[p]` couples row p to the row before it, 0 in the strand's first.
// Pivots are held above `pivot`, one per row; in the reduction, where the pivots of a chain fall with its length, above a
// thousandth of that. Returns the solution in the row before row 0, or 0 where there is none.
float solveTridiagonal(float diagonal[PER_THREAD], float lower[PER_THREAD], float pivot[PER_THREAD],
                       inout float value[PER_THREAD]) {
  float to_before[PER_THREAD], to_after[PER_THREAD];
  float coupling = lower[0], diagonal_before = 0.0, value_before = 0.0;
  for (int p = 0; p < kLast; ++p) {
    float inverse = 1.0 / max(diagonal[p], pivot[p]);
    to_before[p] = coupling * inverse;
    to_after[p] = lower[p + 1] * inverse;
    value[p] *= inverse;
    diagonal_before -= coupling * to_before[p];
    value_before -= coupling * value[p];
    diagonal[p + 1] -= lower[p + 1] * to_after[p];
    value[p + 1] -= lower[p + 1] * value[p];
    coupling = -lower[p + 1] * to_before[p];
  }
  float d = diagonal[kLast], solved = value[kLast], solved_before = 0.0;
#if THREADS == 1
  solved /= max(d, pivot[kLast]);
#else
  const float least = 1e-3 * pivot[kLast];
  exchange_a[me].xy = vec2(diagonal_before, value_before);
  barrier();
  vec2 folded = exchange_a[after(1)].xy;
  barrier();
  if (hasAfter(1)) {
    d += folded.x;
    solved += folded.y;
  }
  for (int doubling = 0; doubling < kDoublings; ++doubling) {
    int distance = 1 << doubling;
    exchange_a[me].xyz = vec3(coupling, 1.0 / max(d, least), solved);
    barrier();
    vec3 inner = exchange_a[before(distance)].xyz, outer = exchange_a[after(distance)].xyz;
    barrier();
    float up = hasAfter(distance) ? outer.x : 0.0;
    float from_inner = coupling * inner.y, from_outer = up * outer.y;
    d -= from_inner * coupling + from_outer * up;
    solved -= from_inner * inner.z + from_outer * outer.z;
    coupling = -from_inner * inner.x;
  }
  solved /= max(d, least);
  exchange_d[me] = solved;
  barrier();
  solved_before = exchange_d[before(1)];
  barrier();
  if (!hasBefore(1)) solved_before = 0.0;
#endif
  value[kLast] = solved;
  for (int p = kLast - 1; p >= 0; --p) value[p] -= to_before[p] * solved_before + to_after[p] * value[p + 1];
  return solved_before;
}
