// The length system of strands in which a pull would go beyond its bound: as on the CPU the bound then also acts on the
// rest of the strand, one edge after another. Seldom needed, by strands that a body or a pinned vertex holds taut, so it is
// as plain as it can be. Needs rod_strand.glsl and kernels/rod.h.

shared uint beyond_bound[WORKGROUP];  // at the first invocation of each strand
shared uint any_beyond_bound;

float weightOf(int e) {
#if UNIFORM
  return e < 0 ? 0.0 : e == edges - 1 ? 2.0 : 1.0;
#else
  return e < 0 ? 0.0 : edgeRest(root_vertex + uint(min(e, edges - 1))).w;
#endif
}
float lengthOf(int e) {
#if UNIFORM
  return e < edges ? rest.edge_length : 0.0;
#else
  return e < edges ? edge_rest[root_vertex + uint(e)].x : 0.0;
#endif
}

// Before the first barrier of a solve.
void forgetBeyondBound() {
  if (rank == 0) beyond_bound[me] = 0u;
  if (me == 0u) any_beyond_bound = 0u;
}
// Before a later one.
void noteBeyondBound() { beyond_bound[me - uint(rank)] = any_beyond_bound = 1u; }

// Solves for the strands noted: eliminates from the root on and substitutes back. Of the others only the barriers are
// wanted. Returns the pull of the edge before slot 0.
float solveBounded(float diagonal[PER_THREAD], float lower[PER_THREAD], float excess[PER_THREAD],
                   inout float pull[PER_THREAD], float pull_in) {
  exchange_a[me] = vec4(diagonal[0], diagonal[1], diagonal[2], diagonal[3]);
  exchange_b[me] = vec4(lower[0], lower[1], lower[2], lower[3]);
  exchange_c[me] = vec4(excess[0], excess[1], excess[2], excess[3]);
  barrier();
  const int rows = THREADS * PER_THREAD;
  bool noted = beyond_bound[me - uint(rank)] != 0u;
  if (noted && rank == 0) {
    float right = 0.0, inverse = 0.0;
    for (int e = 0; e < rows; ++e) {
      uint at = me + uint(e / PER_THREAD);
      int p = e % PER_THREAD;
      float coupling = exchange_b[at][p];
      float factor = coupling * inverse;
      float pivot = exchange_a[at][p] - coupling * factor;
      inverse = 1.0 / max(pivot, lengthPivot(weightOf(e - 1), weightOf(e)));
      right = (exchange_c[at][p] - coupling * right) * inverse;
      exchange_c[at][p] = right;
      exchange_a[at][p] = factor;
    }
    float solved = 0.0, factor = 0.0;
    for (int e = rows - 1; e >= 0; --e) {
      uint at = me + uint(e / PER_THREAD);
      int p = e % PER_THREAD;
      solved = boundedPull(exchange_c[at][p] - factor * solved, lengthOf(e));
      factor = exchange_a[at][p];
      exchange_c[at][p] = solved;
    }
  }
  barrier();
  if (noted) {
    for (int p = 0; p < PER_THREAD; ++p) pull[p] = exchange_c[me][p];
    pull_in = exchange_c[before(1)].w;
  }
  barrier();
  return pull_in;
}
