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
