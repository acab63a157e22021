// Kernel text: see kernels/README.md. The pulls of a stiff strand in very violent motion (isEliminated) or of a taut one (isTaut), and what
// they move, by elimination: pulls p of edges and shifts d of vertices with A d = B' p and B d = excess, where A is the bending matrix and B
// tells how far shifts shorten edges. From tip to root, a vertex together with the edge after it, in blocks of three: A is the same along x, y
// and z, but tensions act along edges.

// A symmetric matrix: xx, yy, zz and yz, zx, xy.
struct Symmetric {
  real3 own, mixed;
};
FN Symmetric makeSymmetric(IN(real3) own, IN(real3) mixed) {
  Symmetric s;
  s.own = own;
  s.mixed = mixed;
  return s;
}
FN Symmetric scaled(IN(Symmetric) s, IN(real) k) { return makeSymmetric(s.own * k, s.mixed * k); }
FN Symmetric plusEverywhere(IN(Symmetric) s, IN(real) k) { return makeSymmetric(s.own + makeReal3(k, k, k), s.mixed); }
// s + v w', of parallel v and w.
FN Symmetric plusProduct(IN(Symmetric) s, IN(real3) v, IN(real3) w) {
  return makeSymmetric(makeReal3(madd(v.x, w.x, s.own.x), madd(v.y, w.y, s.own.y), madd(v.z, w.z, s.own.z)),
                       makeReal3(madd(v.y, w.z, s.mixed.x), madd(v.z, w.x, s.mixed.y), madd(v.x, w.y, s.mixed.z)));
}
FN real3 columnX(IN(Symmetric) s) { return makeReal3(s.own.x, s.mixed.z, s.mixed.y); }
FN real3 columnY(IN(Symmetric) s) { return makeReal3(s.mixed.z, s.own.y, s.mixed.x); }
FN real3 columnZ(IN(Symmetric) s) { return makeReal3(s.mixed.y, s.mixed.x, s.own.z); }
FN real3 product(IN(Symmetric) s, IN(real3) v) { return madd(columnX(s), v.x, madd(columnY(s), v.y, columnZ(s) * v.z)); }

// Of a positive definite one: inverse pivots, and factors below the diagonal. Its inverse as a matrix would not do: along tensions and
// across them it differs by many orders, and what is small would be lost.
struct Triangles {
  real3 pivots;
  real xy, xz, yz;
};
FN Triangles trianglesOf(IN(Symmetric) s) {
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
FN real3 solved(IN(Triangles) t, IN(real3) v) {
  real y = madd(lit(0) - t.xy, v.x, v.y);
  real z = madd(lit(0) - t.yz, y, madd(lit(0) - t.xz, v.x, v.z)) * t.pivots.z;
  y = madd(lit(0) - t.yz, z, y * t.pivots.y);
  return makeReal3(madd(lit(0) - t.xy, y, madd(lit(0) - t.xz, z, v.x * t.pivots.x)), y, z);
}

// How a vertex gives way to a push, which `some` (1, else 0) lets move: less `held` times what the push does along `off`.
FN real3 pushed(IN(Triangles) gives, IN(real) some, IN(real3) off, IN(real3) held, IN(real3) push) {
  return madd(held, lit(0) - dot(off, push), solved(gives, push) * some);
}

// What is left of all that is farther out when a vertex is eliminated. Of pulls: what they add to what the elimination of A alone
// leaves of the vertex and of the next one inwards, on their diagonals and in what couples them (columns), and right-hand sides. (A alone
// is not eliminated again: its small numbers would be lost in the sums.) Of the edge after the vertex: how its pull acts on both, how far it
// gives way by itself, and its excess.
struct OuterPulls {
  Symmetric near, far;
  real3 column_x, column_y, column_z;
  real3 right, right_far;
  real3 along, along_far;
  real yields, excess;
};
FN OuterPulls noOuterPulls() {
  OuterPulls none;
  real3 zero = makeReal3(lit(0), lit(0), lit(0));
  none.near = none.far = makeSymmetric(zero, zero);
  none.column_x = none.column_y = none.column_z = zero;
  none.right = none.right_far = none.along = none.along_far = zero;
  none.yields = lit(1);
  none.excess = lit(0);
  return none;
}
// What substitution needs of a vertex and the edge after it, whose shift and pull follow from the shifts of the next two vertices inwards
// and the pull of the edge between.
struct PullRow {
  real3 shift;
  real3 column_x, column_y, column_z;
  Symmetric far;
  real3 by_pull;
  real3 pull_near, pull_far;
  real pull, pull_by_pull;
};
// A vertex and the edge after it. `alone`, `factor`, `factor2`: of the elimination of A, the vertex' inverse pivot and the factors of
// the next two inwards on it; `outer`, `inner`: how the pull of the edge before the vertex acts on it and on the next one inwards: its
// tangent, or 0 where that is pinned; `normal`: of a body that presses the vertex, which then gives way along the surface only, or 0.
FN PullRow eliminatePull(INOUT(OuterPulls) outside, IN(mask) moves, IN(real) alone, IN(real) factor, IN(real) factor2,
                         IN(real3) outer, IN(real3) inner, IN(real) excess, IN(real3) normal) {
  Symmetric added = outside.near;
  real3 added_x = outside.column_x, added_y = outside.column_y, added_z = outside.column_z;
  real pivot = inverse(alone), first = pivot * factor, second = pivot * factor2;  // what A couples to the next two
  Triangles gives = trianglesOf(plusEverywhere(added, pivot));  // how the vertex gives way to a push
  real some = select(moves, lit(1), lit(0));
  // A body takes this away: how it would give way to a push along the normal, as much as makes it stay on the surface.
  real3 off = solved(gives, normal) * some;
  real along = dot(normal, off);
  real3 held = off * select(along > lit(0), inverse(select(along > lit(0), along, lit(1))), lit(0));
  // How much less it does than in A alone.
  real3 less_x = solved(gives, columnX(added)), less_y = solved(gives, columnY(added)), less_z = solved(gives, columnZ(added));
  Symmetric less = makeSymmetric(makeReal3(less_x.x, less_y.y, less_z.z), makeReal3(less_z.y, less_x.z, less_y.x));
  less = plusEverywhere(scaled(less, alone * some), alone - alone * some);
  less = plusProduct(less, off, held);
  // What that makes of the coupling to the next vertex, without `factor`, and all of it.
  real3 x = pushed(gives, some, off, held, added_x) - columnX(less) * first, y = pushed(gives, some, off, held, added_y) - columnY(less) * first;
  real3 z = pushed(gives, some, off, held, added_z) - columnZ(less) * first;
  real3 all_x = makeReal3(x.x + factor, x.y, x.z), all_y = makeReal3(y.x, y.y + factor, y.z);
  real3 all_z = makeReal3(z.x, z.y, z.z + factor);

  // The edge after the vertex: how the vertex gives way to its pull, and what that pull is.
  real3 to_edge = pushed(gives, some, off, held, outside.along), moved = pushed(gives, some, off, held, outside.right);
  real share = inverse(dot(outside.along, to_edge) + outside.yields);
  real3 pull_near = madd(to_edge, first, makeReal3(dot(added_x, to_edge), dot(added_y, to_edge), dot(added_z, to_edge))) -
                    outside.along_far;
  PullRow row;
  row.pull = (outside.excess - dot(to_edge, outside.right)) * share;
  row.pull_near = pull_near * share;
  row.pull_far = to_edge * (second * share);
  row.pull_by_pull = dot(to_edge, outer) * share;
  // The vertex.
  row.shift = madd(to_edge, row.pull, moved);
  row.column_x = all_x - to_edge * row.pull_near.x;
  row.column_y = all_y - to_edge * row.pull_near.y;
  row.column_z = all_z - to_edge * row.pull_near.z;
  Symmetric kept = plusProduct(less, to_edge, to_edge * share);  // how much less it gives way with the edge than in A alone
  row.far = scaled(plusEverywhere(kept, lit(0) - alone), lit(0) - second);
  row.by_pull = madd(to_edge, lit(0) - row.pull_by_pull, pushed(gives, some, off, held, outer));

  // What is left for the next one.
  OuterPulls left;
  left.near = plusProduct(outside.far, pull_near, row.pull_near);
  left.near.own = left.near.own - makeReal3(madd(first, x.x, dot(added_x, all_x)), madd(first, y.y, dot(added_y, all_y)),
                                            madd(first, z.z, dot(added_z, all_z)));
  left.near.mixed = left.near.mixed - makeReal3(madd(first, z.y, dot(added_y, all_z)), madd(first, x.z, dot(added_z, all_x)),
                                                madd(first, y.x, dot(added_x, all_y)));
  left.far = scaled(kept, second * second);
  left.column_x = pull_near * row.pull_far.x - makeReal3(x.x, y.x, z.x) * second;
  left.column_y = pull_near * row.pull_far.y - makeReal3(x.y, y.y, z.y) * second;
  left.column_z = pull_near * row.pull_far.z - makeReal3(x.z, y.z, z.z) * second;
  left.right = outside.right_far - makeReal3(dot(all_x, outside.right), dot(all_y, outside.right), dot(all_z, outside.right)) -
               pull_near * row.pull;
  left.right_far = row.shift * (lit(0) - second);
  left.along = madd(row.by_pull, first, inner) + makeReal3(dot(added_x, row.by_pull), dot(added_y, row.by_pull), dot(added_z, row.by_pull)) +
               outside.along_far * row.pull_by_pull;
  left.along_far = row.by_pull * second;
  left.yields = dot(outer, row.by_pull) + lit(1e-9);  // regular where both ends are pinned, too
  left.excess = madd(row.pull_by_pull, outside.excess, excess + dot(row.by_pull, outside.right));
  outside = left;
  return row;
}
// The pull of the edge that ends at the root.
FN real firstPull(IN(OuterPulls) outside) { return outside.excess * inverse(outside.yields); }
// `near`, `far`: shifts of the next two vertices inwards; `pull`: of the edge to the nearer one.
FN real3 shiftOf(IN(PullRow) row, IN(real3) near, IN(real3) far, IN(real) pull) {
  return row.shift - row.column_x * near.x - row.column_y * near.y - row.column_z * near.z - product(row.far, far) - row.by_pull * pull;
}
FN real pullOf(IN(PullRow) row, IN(real3) near, IN(real3) far, IN(real) pull) {
  return row.pull + dot(row.pull_near, near) + dot(row.pull_far, far) + row.pull_by_pull * pull;
}
