// Part of rod.comp: stiff tensions (STIFF), the tension increments of taut strands and of stiff strands with large
// correction strain, by elimination: kernels/stiff_tensions.h. One invocation per strand works; the others wait.

// An edge and the vertex at its end. eliminateBendingAlong() replaces mass by the inverse pivot, and first and second (the
// couplings to the next two vertices inwards) by elimination factors. tensionAlong() replaces tangent by the vertex's
// displacement and excess by the edge's tension increment.
struct StiffEdge {
  vec3 tangent;
  float excess;
#if BODIES
  vec3 normal;
#endif
  float weight, mass, first, second;
};
#if BODIES
#define NORMAL_OF(edge) edge.normal
#else
#define NORMAL_OF(edge) vec3(0)
#endif
shared StiffEdge stiff_edges[WORKGROUP * PER_THREAD];
// A TensionRow packed in eight vec4: the padding of a structure would exceed the shared memory of some drivers.
shared vec4 tension_rows[8 * WORKGROUP * PER_THREAD];

void putTensionRow(uint at, TensionRow row) {
  tension_rows[8u * at] = vec4(row.shift, row.lambda);
  tension_rows[8u * at + 1u] = vec4(row.column_x, row.far.mixed.x);
  tension_rows[8u * at + 2u] = vec4(row.column_y, row.far.mixed.y);
  tension_rows[8u * at + 3u] = vec4(row.column_z, row.far.mixed.z);
  tension_rows[8u * at + 4u] = vec4(row.far.own, row.lambda_by_lambda);
  tension_rows[8u * at + 5u] = vec4(row.by_lambda, 0);
  tension_rows[8u * at + 6u] = vec4(row.lambda_near, 0);
  tension_rows[8u * at + 7u] = vec4(row.lambda_far, 0);
}
TensionRow tensionRow(uint at) {
  TensionRow row;
  row.shift = tension_rows[8u * at].xyz;
  row.column_x = tension_rows[8u * at + 1u].xyz;
  row.column_y = tension_rows[8u * at + 2u].xyz;
  row.column_z = tension_rows[8u * at + 3u].xyz;
  row.far.own = tension_rows[8u * at + 4u].xyz;
  row.far.mixed = vec3(tension_rows[8u * at + 1u].w, tension_rows[8u * at + 2u].w, tension_rows[8u * at + 3u].w);
  row.by_lambda = tension_rows[8u * at + 5u].xyz;
  row.lambda_near = tension_rows[8u * at + 6u].xyz;
  row.lambda_far = tension_rows[8u * at + 7u].xyz;
  row.lambda = tension_rows[8u * at].w;
  row.lambda_by_lambda = tension_rows[8u * at + 4u].w;
  return row;
}

// Eliminates the bending matrix of the strand whose edges start at index `at` of stiff_edges, as
// RodStep::eliminateBending() of core/rod_sweep.inl.
void eliminateBendingAlong(uint at) {
  float alone1 = 0.0, alone2 = 0.0, sum1 = 0.0, sum2 = 0.0, across1 = 0.0, second1 = 0.0, second2 = 0.0;
  for (int e = edges - 1; e >= 0; --e) {
    const StiffEdge edge = stiff_edges[at + uint(e)];
    const float factor1 = across1 * alone1, factor2 = second2 * alone2;
    const float sum = edge.mass - factor1 * sum1 - factor2 * sum2;
    const float across_in = edge.first - second1 * factor1;
    const float alone = 1.0 / (sum - across_in - edge.second);
    stiff_edges[at + uint(e)].mass = alone;
    stiff_edges[at + uint(e)].first = across_in * alone;
    stiff_edges[at + uint(e)].second = edge.second * alone;
    alone2 = alone1;
    alone1 = alone;
    sum2 = sum1;
    sum1 = sum;
    across1 = across_in;
    second2 = second1;
    second1 = edge.second;
  }
}

// Tension increments and displacements of that strand.
void tensionAlong(uint at) {
  eliminateBendingAlong(at);
  OuterTensions outside = noOuterTensions();
  for (int e = edges - 1; e >= 0; --e) {
    const StiffEdge edge = stiff_edges[at + uint(e)], inside = stiff_edges[at + uint(max(e - 1, 0))];
    const bool moves = edge.weight > 0.0, moves_in = e > 0 && inside.weight > 0.0;
    putTensionRow(at + uint(e),
                  eliminateTension(outside, moves, edge.mass, edge.first, edge.second, select(moves, edge.tangent, vec3(0)),
                                   select(moves_in, edge.tangent, vec3(0)), edge.excess, NORMAL_OF(edge)));
  }
  vec3 near = vec3(0), far = vec3(0);  // displacements of the next two vertices inwards, m
  float pulled = firstTension(outside);
  for (int e = 0; e < edges; ++e) {
    const TensionRow row = tensionRow(at + uint(e));
    const vec3 moved = shiftOf(row, near, far, pulled);
    stiff_edges[at + uint(e)].tangent = moved;
    stiff_edges[at + uint(e)].excess = pulled;
    pulled = tensionOf(row, near, far, pulled);
    far = near;
    near = moved;
  }
}

// Applies stiff tensions in place of applyTensionsThroughBending(). `mine`: whether this strand takes part; all invocations
// of the workgroup must call it.
void eliminateTensions(bool mine) {
  const uint own = me * PER_THREAD, of_strand = (me - uint(rank)) * PER_THREAD;
  for (int p = 0; p < PER_THREAD; ++p) {
    StiffEdge edge;
    edge.tangent = tangent[p];
    edge.excess = lengthResidualOf(p, dot(newEdge(p), tangent[p]));
#if BODIES
    edge.normal = normals[p];
#endif
    edge.weight = weight(p);
    edge.mass = mass(p);
    edge.first = p > 0 ? first[max(p - 1, 0)] : across.y;
    edge.second = p > 1 ? second[max(p - 2, 0)] : p > 0 ? across.z : across.x;
    if (rank == 0 && p == 0) {  // no edge before the first
      edge.first = bendAcross(stiffness[0], stiffness[1], 0.0, inverseLength(0), inverseLength(1)) - edge_stiffness[0];
      edge.second = 0.0;
    }
    stiff_edges[own + p] = edge;
  }
  memoryBarrierShared();
  barrier();
  if (mine && rank == 0) tensionAlong(of_strand);
  memoryBarrierShared();
  barrier();
  if (!mine) return;
  for (int p = 0; p < PER_THREAD; ++p) {
    if (!isEdge(p)) continue;
    shift[p] += stiff_edges[own + p].tangent;
    tension[p] += stiff_edges[own + p].excess;
    lambda[p] = softness[p] = 0.0;
  }
  if (hasBefore(1)) shift_in += stiff_edges[own - 1u].tangent;  // taut strands get no second length pass, which would set it
  lambda_in = lambda_out = softness_in = 0.0;
}
