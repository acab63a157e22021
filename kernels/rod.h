// Kernel text: see kernels/README.md. A strand as an inextensible Kirchhoff rod: unit tangents t_e and material frames
// q_e (body z = t_e) on edges e, bending and twist at joints j between edges j-1 and j; joint 0 is between the root frame
// and edge 0. All masses of a strand are divided by one reference mass, stiffnesses too, so units are metres and seconds.

FN real3 frameTangent(IN(quat) q) {
  return makeReal3(lit(2) * madd(q.x, q.z, q.w * q.y), lit(2) * madd(q.y, q.z, lit(0) - q.w * q.x),
                   lit(1) - lit(2) * madd(q.x, q.x, q.y * q.y));
}

FN quat conjugate(IN(quat) q) { return makeQuat(lit(0) - q.x, lit(0) - q.y, lit(0) - q.z, q.w); }

// Frame q of an edge moved with its tangent to the unit vector t, without twist.
FN quat transportTo(IN(quat) q, IN(real3) t) { return multiply(rotationBetween(frameTangent(q), t), q); }

// Bending (x, y) and twist (z) strain of the joint between frames a and b, in frame a: 2 tan(theta/2) along the axis of
// the rotation from a to b. Grows without bound towards a full fold and is capped near it, so a fold always pushes back.
FN real3 jointStrain(IN(quat) a, IN(quat) b) {
  quat p = multiply(conjugate(a), b);
  real w = lit(2) / max(abs(p.w), lit(0.2));
  real s = select(p.w < lit(0), lit(0) - w, w);
  return makeReal3(p.x * s, p.y * s, p.z * s);
}

// Moment of a joint on its outer edge, world: gradient of the elastic energy to a rotation of that edge. `strain` as
// above, `excess` = strain less rest strain, k = (bending, bending, twist) stiffness in m^2/s^2.
FN real3 jointMoment(IN(quat) a, IN(real3) strain, IN(real3) excess, IN(real) bend, IN(real) twist) {
  real3 c = makeReal3(bend * excess.x, bend * excess.y, twist * excess.z);
  return rotate(a, madd(cross(strain, c), lit(0.5), c));
}

// How the moment of a joint changes when its outer edge turns about its own tangent t by phi and its inner edge about
// t_in by phi_in (radians, small).
FN real3 momentOfTwist(IN(real3) t_in, IN(real3) t, IN(real) phi_in, IN(real) phi, IN(real) bend, IN(real) twist) {
  real3 turn = madd(t, phi, t_in * (lit(0) - phi_in));
  real3 mean = t_in + t;
  real share = (twist - bend) * dot(mean, turn) / max(dot(mean, mean), lit(1e-3));
  return madd(turn, bend, mean * share);
}

// How the twists of the two edges of a joint are coupled, where their tangents t_in and t make an angle of cosine c: the
// mixed second derivative of its energy. The part of its moment is held back where it would make the twist unstable.
FN real twistCoupling(IN(real) bend, IN(real) twist, IN(real) c, IN(real3) moment, IN(real3) t_in, IN(real3) t) {
  real turning = lit(0.5) * dot(moment, cross(t_in, t));
  return lit(0) - bend * c - (twist - bend) * lit(0.5) * (lit(1) + c) -
         min(turning, lit(0.9) * bend * (lit(1) - c));
}

// Frame turned about its own tangent by the small angle phi.
FN quat twistFrame(IN(quat) q, IN(real) phi) {
  real h = phi * lit(0.5);
  return normalizeQuat(makeQuat(madd(q.y, h, q.x), madd(lit(0) - q.x, h, q.y), madd(q.w, h, q.z),
                                madd(lit(0) - q.z, h, q.w)));
}

// Stiffness of a joint in the bending matrix: a majorant of its true Hessian in the turning of the two tangents, where
// they make an angle of cosine c. `time2` = dt^2 + dt x damping time.
FN real bendMatrixStiffness(IN(real) bend, IN(real) c, IN(real) time2) {
  return bend * time2 / max(lit(0.5) * (lit(1) + c), lit(0.1));
}
// What a bent joint adds to the matrix on each of its edges: the turning of directions under its moment.
FN real bendMatrixMargin(IN(real) stiffness, IN(real) c, IN(real3) excess) {
  real fold = max(lit(2) - lit(2) * c, lit(0));
  return stiffness * madd(lit(3), fold, lit(10) * min(dot(excess, excess), lit(4)));
}

// What a joint adds to the diagonal of the twist system on both its edges; `twistCoupling` couples them.
FN real twistOwn(IN(real) bend, IN(real) twist, IN(real) c) {
  return madd(twist - bend, (lit(1) + c) * lit(0.5), bend);
}

// The kept tension acts along `t + share (old - t)`, between the old and the new direction of its edge, which makes the
// motion of the chain second order in time. No share where the edge turned by more than 26 degrees or is stiff.
// `weight`: 1 / mass of its outer vertex.
FN real oldDirectionShare(IN(real3) old, IN(real3) t, IN(real) bend, IN(real) inverse_length, IN(real) weight,
                          IN(real) dt2) {
  real stiff = bend * inverse_length * inverse_length * dt2 * weight;
  real turned_little = clamp(dot(old, t) * lit(20) - lit(18), lit(0), lit(1));
  return turned_little * lit(0.9) / madd(stiff, lit(0.05), lit(1));
}
// Stiffness of an edge in the bending matrix: the margins of its two joints, and its kept tension.
FN real edgeMatrixStiffness(IN(real) margins, IN(real) inverse_length, IN(real) kept, IN(real) share) {
  return madd(margins * inverse_length, inverse_length,
              max(kept, lit(0)) * inverse_length * (lit(1) - share * lit(0.75)));
}

// `push` without its part along a contact's normal (zero where there is no contact).
FN real3 alongSurface(IN(real3) push, IN(real3) normal) { return madd(normal, lit(0) - dot(push, normal), push); }

// The bending system, one unknown displacement per vertex: what joints of stiffness k0 (before edge e), k1 and k2 (the two
// after it) put on the diagonal of the outer vertex of edge e, and what couples it to the next vertex and the one after.
// `il`, `il_out`, `il_out2`: inverse lengths of edge e and the two after it.
FN real bendOwn(IN(real) k0, IN(real) k1, IN(real) k2, IN(real) il, IN(real) il_out) {
  real sum = il + il_out;
  return k0 * il * il + k1 * sum * sum + k2 * il_out * il_out;
}
FN real bendAcross(IN(real) k1, IN(real) k2, IN(real) il, IN(real) il_out, IN(real) il_out2) {
  return lit(0) - k1 * (il + il_out) * il_out - k2 * il_out * (il_out + il_out2);
}
FN real bendAcrossTwo(IN(real) k2, IN(real) il_out, IN(real) il_out2) { return k2 * il_out * il_out2; }

// What of a vertex's weight (1 / mass) acts along an edge t next to it: in contact it gives way along the surface only.
FN real weightAlong(IN(real3) t, IN(real3) normal, IN(real) weight) {
  real a = dot(t, normal);
  return weight * (lit(1) - a * a);
}
// The length system has one unknown (m, pull x weight) per edge and on its diagonal the weights of both ends along it; this
// couples the edges t and t_other that meet at a vertex.
FN real lengthAcross(IN(real3) t, IN(real3) t_other, IN(real3) normal, IN(real) weight) {
  return lit(0) - weight * (dot(t, t_other) - dot(t, normal) * dot(t_other, normal));
}
// What the elimination of the length system may divide by at least. Low enough for strands of 128 vertices: on a straight
// one of n the pivots fall to 1 / n, and what elimination gives must not depend on its order.
FN real lengthPivot(IN(real) weight_in, IN(real) weight) { return max((weight_in + weight) * lit(1e-3), lit(1e-6)); }
// The pull of an edge, bounded so that no strand is torn apart in one substep.
FN real boundedPull(IN(real) pull, IN(real) rest_length) {
  real limit = rest_length * lit(20);
  return clamp(pull, lit(0) - limit, limit);
}

// The tension that a substep starts from, in units of length x mass: that of the last one. Edges that turn, from t_old to
// t, forget 2 % of it, so that errors of fast motion do not stay; compression is held below the buckling load.
FN real keptTension(IN(real) tension, IN(real3) t_old, IN(real3) t, IN(real) bend, IN(real) inverse_length,
                    IN(real) time2) {
  real forgotten = min((lit(1) - dot(t_old, t)) * lit(400), lit(0.02));
  return max(tension * (lit(1) - forgotten), bend * inverse_length * time2 * lit(-0.1));
}

// In a curl, tension pulls a vertex inwards, against the bending matrix more than against its mass. This is the part of
// a vertex's weight (1 / mass) by which tension moves it less than the mass alone would let it, along an edge next to it:
// 0 on a straight strand. c: cosine at the vertex's joint; stiffness: of that joint in the bending matrix; edge: what
// the matrix has on the edge before it. Tensions that are solved without it lag behind, which feeds energy to curls.
FN real tensionSoftness(IN(real) mass, IN(real) stiffness, IN(real) edge, IN(real) inverse_length, IN(real) c) {
  real fold = lit(2) - lit(2) * min(abs(c), lit(1));
  real resistance = lit(1.6) * fold * madd(stiffness * inverse_length, inverse_length * fold, edge);
  return lit(0.5) * fold * resistance / (mass + resistance);
}
