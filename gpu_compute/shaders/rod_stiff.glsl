// The pulls of stiff strands in very violent motion and of taut ones: kernels/stiff_pulls.h, one invocation to a strand, while the others
// wait. Its part of rod.comp.

// An edge and the vertex at its end. Once the bending matrix is eliminated, the inverse pivot of the vertex stands in place of its mass
// and the factors of the next two inwards on it in place of what couples them; in the end its shift and the edge's pull in place of the
// tangent and the excess.
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
// A PullRow in eight vec4: as a structure in shared memory it would take more than every driver has.
shared vec4 pull_rows[8 * WORKGROUP * PER_THREAD];

void putPullRow(uint at, PullRow row) {
  pull_rows[8u * at] = vec4(row.shift, row.pull);
  pull_rows[8u * at + 1u] = vec4(row.column_x, row.far.mixed.x);
  pull_rows[8u * at + 2u] = vec4(row.column_y, row.far.mixed.y);
  pull_rows[8u * at + 3u] = vec4(row.column_z, row.far.mixed.z);
  pull_rows[8u * at + 4u] = vec4(row.far.own, row.pull_by_pull);
  pull_rows[8u * at + 5u] = vec4(row.by_pull, 0);
  pull_rows[8u * at + 6u] = vec4(row.pull_near, 0);
  pull_rows[8u * at + 7u] = vec4(row.pull_far, 0);
}
PullRow pullRow(uint at) {
  PullRow row;
  row.shift = pull_rows[8u * at].xyz;
  row.column_x = pull_rows[8u * at + 1u].xyz;
  row.column_y = pull_rows[8u * at + 2u].xyz;
  row.column_z = pull_rows[8u * at + 3u].xyz;
  row.far.own = pull_rows[8u * at + 4u].xyz;
  row.far.mixed = vec3(pull_rows[8u * at + 1u].w, pull_rows[8u * at + 2u].w, pull_rows[8u * at + 3u].w);
  row.by_pull = pull_rows[8u * at + 5u].xyz;
  row.pull_near = pull_rows[8u * at + 6u].xyz;
  row.pull_far = pull_rows[8u * at + 7u].xyz;
  row.pull = pull_rows[8u * at].w;
  row.pull_by_pull = pull_rows[8u * at + 4u].w;
  return row;
}

// The bending matrix of the strand whose edges stand from `at` on, as in RodStep::eliminateBending (core/rod_sweep.inl).
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

void pullAlong(uint at) {
  eliminateBendingAlong(at);
  OuterPulls outside = noOuterPulls();
  for (int e = edges - 1; e >= 0; --e) {
    const StiffEdge edge = stiff_edges[at + uint(e)], inside = stiff_edges[at + uint(max(e - 1, 0))];
    const bool moves = edge.weight > 0.0, moves_in = e > 0 && inside.weight > 0.0;
    putPullRow(at + uint(e), eliminatePull(outside, moves, edge.mass, edge.first, edge.second,
                                           select(moves, edge.tangent, vec3(0)), select(moves_in, edge.tangent, vec3(0)),
                                           edge.excess, NORMAL_OF(edge)));
  }
  vec3 near = vec3(0), far = vec3(0);  // shifts of the next two vertices inwards
  float pulled = firstPull(outside);
  for (int e = 0; e < edges; ++e) {
    const PullRow row = pullRow(at + uint(e));
    const vec3 moved = shiftOf(row, near, far, pulled);
    stiff_edges[at + uint(e)].tangent = moved;
    stiff_edges[at + uint(e)].excess = pulled;
    pulled = pullOf(row, near, far, pulled);
    far = near;
    near = moved;
  }
}

// The same as pullThroughBending(). `mine`: of this strand.
void pullByElimination(bool mine) {
  const uint own = me * PER_THREAD, of_strand = (me - uint(rank)) * PER_THREAD;
  for (int p = 0; p < PER_THREAD; ++p) {
    StiffEdge edge;
    edge.tangent = tangent[p];
    edge.excess = toMend(p, dot(newEdge(p), tangent[p]));
#if BODIES
    edge.normal = normals[p];
#endif
    edge.weight = weight(p);
    edge.mass = mass(p);
    edge.first = p > 0 ? first[max(p - 1, 0)] : across.y;
    edge.second = p > 1 ? second[max(p - 2, 0)] : p > 0 ? across.z : across.x;
    if (rank == 0 && p == 0) {  // there is no edge before it
      edge.first = bendAcross(stiffness[0], stiffness[1], 0.0, inverseLength(0), inverseLength(1)) - edge_stiffness[0];
      edge.second = 0.0;
    }
    stiff_edges[own + p] = edge;
  }
  memoryBarrierShared();
  barrier();
  if (mine && rank == 0) pullAlong(of_strand);
  memoryBarrierShared();
  barrier();
  if (!mine) return;
  for (int p = 0; p < PER_THREAD; ++p) {
    if (!isEdge(p)) continue;
    shift[p] += stiff_edges[own + p].tangent;
    tension[p] += stiff_edges[own + p].excess;
    pull[p] = softness[p] = 0.0;
  }
  if (hasBefore(1)) shift_in += stiff_edges[own - 1u].tangent;  // a taut strand's lengths are not solved again
  pull_in = pull_out = softness_in = 0.0;
}
