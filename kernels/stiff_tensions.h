// Kernel text: see kernels/README.md. Tension increments of a stiff strand with a large correction strain
// (isEliminated) or of a taut one (isTaut), and the displacements that they cause, by elimination; docs/solver.md (21).
// The unknowns are the increments p of edges and the displacements d of vertices:
//   A d = B' p
//   B d = excess
// A is the bending matrix, and B maps displacements to the shortening of edges. The elimination runs from tip to root
// over pairs of a vertex and the edge after it, in blocks of three: A is the same along x, y and z, but tensions act
// along edges.

// Symmetric 3 x 3 matrix: xx, yy, zz and yz, zx, xy.
struct Symmetric {
  real3 own, mixed;
};
LANE_FN Symmetric makeSymmetric(LANE_IN(real3) own, LANE_IN(real3) mixed) {
  Symmetric s;
  s.own = own;
  s.mixed = mixed;
  return s;
}
LANE_FN Symmetric scaled(LANE_IN(Symmetric) s, LANE_IN(real) k) { return makeSymmetric(s.own * k, s.mixed * k); }
// s + k I.
LANE_FN Symmetric plusEverywhere(LANE_IN(Symmetric) s, LANE_IN(real) k) {
  return makeSymmetric(s.own + makeReal3(k, k, k), s.mixed);
}
// s + v w' for parallel v and w.
LANE_FN Symmetric plusProduct(LANE_IN(Symmetric) s, LANE_IN(real3) v, LANE_IN(real3) w) {
  return makeSymmetric(makeReal3(madd(v.x, w.x, s.own.x), madd(v.y, w.y, s.own.y), madd(v.z, w.z, s.own.z)),
                       makeReal3(madd(v.y, w.z, s.mixed.x), madd(v.z, w.x, s.mixed.y), madd(v.x, w.y, s.mixed.z)));
}
LANE_FN real3 columnX(LANE_IN(Symmetric) s) { return makeReal3(s.own.x, s.mixed.z, s.mixed.y); }
LANE_FN real3 columnY(LANE_IN(Symmetric) s) { return makeReal3(s.mixed.z, s.own.y, s.mixed.x); }
LANE_FN real3 columnZ(LANE_IN(Symmetric) s) { return makeReal3(s.mixed.y, s.mixed.x, s.own.z); }
LANE_FN real3 product(LANE_IN(Symmetric) s, LANE_IN(real3) v) {
  return madd(columnX(s), v.x, madd(columnY(s), v.y, columnZ(s) * v.z));
}

// LDL' factors of a positive definite matrix: inverse pivots, and factors below the diagonal. An explicit inverse would
// not do: along and across tensions it differs by many orders of magnitude, and its small entries would be lost.
struct Triangles {
  real3 pivots;
  real xy, xz, yz;
};
LANE_FN Triangles trianglesOf(LANE_IN(Symmetric) s) {
  Triangles t;
  t.pivots.x = inverse(s.own.x);
  t.xy = s.mixed.z * t.pivots.x;
  t.xz = s.mixed.y * t.pivots.x;
  real y = madd(lit(0) - t.xy, s.mixed.z, s.own.y), across = madd(lit(0) - t.xy, s.mixed.y, s.mixed.x);
  t.pivots.y = inverse(max(y, lit(1e-7) * s.own.y));
  t.yz = across * t.pivots.y;
  real z = madd(lit(0) - t.yz, across, madd(lit(0) - t.xz, s.mixed.y, s.own.z));
  t.pivots.z = inverse(max(z, lit(1e-7) * s.own.z));
  return t;
}
// Solves the factored system for v.
LANE_FN real3 solved(LANE_IN(Triangles) t, LANE_IN(real3) v) {
  real y = madd(lit(0) - t.xy, v.x, v.y);
  real z = madd(lit(0) - t.yz, y, madd(lit(0) - t.xz, v.x, v.z)) * t.pivots.z;
  y = madd(lit(0) - t.yz, z, y * t.pivots.y);
  return makeReal3(madd(lit(0) - t.xy, y, madd(lit(0) - t.xz, z, v.x * t.pivots.x)), y, z);
}

// Displacement of a vertex by `push`. `some`: 1 if the vertex moves, otherwise 0. `off`, `held`: projection of a
// pressed vertex onto the surface.
LANE_FN real3 pushed(LANE_IN(Triangles) gives, LANE_IN(real) some, LANE_IN(real3) off, LANE_IN(real3) held, LANE_IN(real3) push) {
  return madd(held, lit(0) - dot(off, push), solved(gives, push) * some);
}

// What remains of all vertices and edges farther out when a vertex is eliminated. `near`, `far`, `column_*`: what
// tensions add to the elimination of A alone, on the diagonals of this vertex and of the next one inwards, and on their
// coupling. (A itself is not eliminated again: small entries would be lost in the sums.) `right`, `right_far`:
// right-hand sides of the two vertices. Of the edge after the vertex: `along`, `along_far`: how its tension acts on
// both; `yields`: its own compliance; `excess`: its residual, m.
struct OuterTensions {
  Symmetric near, far;
  real3 column_x, column_y, column_z;
  real3 right, right_far;
  real3 along, along_far;
  real yields, excess;
};
LANE_FN OuterTensions noOuterTensions() {
  OuterTensions none;
  none.near = none.far = makeSymmetric(zero3(), zero3());
  none.column_x = none.column_y = none.column_z = zero3();
  none.right = none.right_far = none.along = none.along_far = zero3();
  none.yields = lit(1);
  none.excess = lit(0);
  return none;
}
// Back substitution of a vertex and the edge after it: coefficients of their displacement and increment by the
// displacements of the next two vertices inwards and the increment of the edge before the vertex.
struct TensionRow {
  real3 shift;
  real3 column_x, column_y, column_z;
  Symmetric far;
  real3 by_lambda;
  real3 lambda_near, lambda_far;
  real lambda, lambda_by_lambda;
};
// Eliminates a vertex and the edge after it. `alone`, `factor`, `factor2`: from the elimination of A, the vertex's
// inverse pivot and the factors of the next two vertices inwards on it. `outer`, `inner`: action of the tension of the
// edge before the vertex on this vertex and on the next one inwards: its tangent, or 0 if that vertex is pinned.
// `normal`: of a body that presses the vertex, which then moves along the surface only, or 0.
LANE_FN TensionRow eliminateTension(LANE_INOUT(OuterTensions) outside, LANE_IN(mask) moves, LANE_IN(real) alone,
                                    LANE_IN(real) factor, LANE_IN(real) factor2, LANE_IN(real3) outer, LANE_IN(real3) inner,
                                    LANE_IN(real) excess, LANE_IN(real3) normal) {
  Symmetric added = outside.near;
  real3 added_x = outside.column_x, added_y = outside.column_y, added_z = outside.column_z;
  real pivot = inverse(alone), first = pivot * factor, second = pivot * factor2;  // couplings in A to the next two vertices
  Triangles gives = trianglesOf(plusEverywhere(added, pivot));                    // compliance of the vertex
  real some = select(moves, lit(1), lit(0));
  // Contact: `held` removes the displacement along the normal, so that the vertex stays on the surface.
  real3 off = solved(gives, normal) * some;
  real along = dot(normal, off);
  real3 held = off * select(along > lit(0), inverse(select(along > lit(0), along, lit(1))), lit(0));
  // Compliance that the vertex lacks against A alone.
  real3 less_x = solved(gives, columnX(added)), less_y = solved(gives, columnY(added)), less_z = solved(gives, columnZ(added));
  Symmetric less = makeSymmetric(makeReal3(less_x.x, less_y.y, less_z.z), makeReal3(less_z.y, less_x.z, less_y.x));
  less = plusEverywhere(scaled(less, alone * some), alone - alone * some);
  less = plusProduct(less, off, held);
  // Coupling to the next vertex: without `factor` (x, y, z), and all of it.
  real3 x = pushed(gives, some, off, held, added_x) - columnX(less) * first,
        y = pushed(gives, some, off, held, added_y) - columnY(less) * first;
  real3 z = pushed(gives, some, off, held, added_z) - columnZ(less) * first;
  real3 all_x = makeReal3(x.x + factor, x.y, x.z), all_y = makeReal3(y.x, y.y + factor, y.z);
  real3 all_z = makeReal3(z.x, z.y, z.z + factor);

  // The edge after the vertex: displacement of the vertex by its tension, and its increment.
  real3 to_edge = pushed(gives, some, off, held, outside.along), moved = pushed(gives, some, off, held, outside.right);
  real share = inverse(dot(outside.along, to_edge) + outside.yields);
  real3 lambda_near =
      madd(to_edge, first, makeReal3(dot(added_x, to_edge), dot(added_y, to_edge), dot(added_z, to_edge))) - outside.along_far;
  TensionRow row;
  row.lambda = (outside.excess - dot(to_edge, outside.right)) * share;
  row.lambda_near = lambda_near * share;
  row.lambda_far = to_edge * (second * share);
  row.lambda_by_lambda = dot(to_edge, outer) * share;
  // Displacement of the vertex.
  row.shift = madd(to_edge, row.lambda, moved);
  row.column_x = all_x - to_edge * row.lambda_near.x;
  row.column_y = all_y - to_edge * row.lambda_near.y;
  row.column_z = all_z - to_edge * row.lambda_near.z;
  Symmetric kept = plusProduct(less, to_edge, to_edge * share);  // compliance that the vertex with the edge lacks against A alone
  row.far = scaled(plusEverywhere(kept, -alone), lit(0) - second);
  row.by_lambda = madd(to_edge, lit(0) - row.lambda_by_lambda, pushed(gives, some, off, held, outer));

  // What remains for the next vertex inwards.
  OuterTensions left;
  left.near = plusProduct(outside.far, lambda_near, row.lambda_near);
  left.near.own = left.near.own - makeReal3(madd(first, x.x, dot(added_x, all_x)), madd(first, y.y, dot(added_y, all_y)),
                                            madd(first, z.z, dot(added_z, all_z)));
  left.near.mixed = left.near.mixed - makeReal3(madd(first, z.y, dot(added_y, all_z)), madd(first, x.z, dot(added_z, all_x)),
                                                madd(first, y.x, dot(added_x, all_y)));
  left.far = scaled(kept, second * second);
  left.column_x = lambda_near * row.lambda_far.x - makeReal3(x.x, y.x, z.x) * second;
  left.column_y = lambda_near * row.lambda_far.y - makeReal3(x.y, y.y, z.y) * second;
  left.column_z = lambda_near * row.lambda_far.z - makeReal3(x.z, y.z, z.z) * second;
  left.right = outside.right_far - makeReal3(dot(all_x, outside.right), dot(all_y, outside.right), dot(all_z, outside.right)) -
               lambda_near * row.lambda;
  left.right_far = row.shift * (lit(0) - second);
  left.along = madd(row.by_lambda, first, inner) +
               makeReal3(dot(added_x, row.by_lambda), dot(added_y, row.by_lambda), dot(added_z, row.by_lambda)) +
               outside.along_far * row.lambda_by_lambda;
  left.along_far = row.by_lambda * second;
  left.yields = dot(outer, row.by_lambda) + lit(1e-9);  // regular even if both ends are pinned
  left.excess = madd(row.lambda_by_lambda, outside.excess, excess + dot(row.by_lambda, outside.right));
  outside = left;
  return row;
}
// Increment of the edge at the root.
LANE_FN real firstTension(LANE_IN(OuterTensions) outside) { return outside.excess * inverse(outside.yields); }
// `near`, `far`: displacements of the next two vertices inwards; `lambda`: increment of the edge before the vertex.
LANE_FN real3 shiftOf(LANE_IN(TensionRow) row, LANE_IN(real3) near, LANE_IN(real3) far, LANE_IN(real) lambda) {
  return row.shift - row.column_x * near.x - row.column_y * near.y - row.column_z * near.z - product(row.far, far) -
         row.by_lambda * lambda;
}
LANE_FN real tensionOf(LANE_IN(TensionRow) row, LANE_IN(real3) near, LANE_IN(real3) far, LANE_IN(real) lambda) {
  return row.lambda + dot(row.lambda_near, near) + dot(row.lambda_far, far) + row.lambda_by_lambda * lambda;
}
