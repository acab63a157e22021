// Kernel text: see kernels/README.md.

// Unit vector along a; zero if a is shorter than 1e-18. The square of that is still a normal float, because GPUs flush
// denormal numbers to zero.
LANE_FN real3 normalizeOrZero(LANE_IN(real3) a) {
  real l2 = dot(a, a);
  mask tiny = l2 < lit(1e-36);
  real inverse = select(tiny, lit(0), inverseSqrt(select(tiny, lit(1), l2)));
  return a * inverse;
}

// Unit vector along the edge, or `otherwise` if the edge is shorter than a nanometre.
LANE_FN real3 directionOr(LANE_IN(real3) edge, LANE_IN(real3) otherwise) {
  real l2 = dot(edge, edge);
  mask tiny = l2 < lit(1e-18);
  return select(tiny, otherwise, edge * inverseSqrt(max(l2, lit(1e-18))));
}

// v rotated by the unit quaternion q: v + 2 w (u x v) + 2 u x (u x v), u = q.xyz.
LANE_FN real3 rotate(LANE_IN(quat) q, LANE_IN(real3) v) {
  real3 u = makeReal3(q.x, q.y, q.z);
  real3 c = cross(u, v) * lit(2);
  return madd(c, q.w, v) + cross(u, c);
}

LANE_FN quat conjugate(LANE_IN(quat) q) { return makeQuat(lit(0) - q.x, lit(0) - q.y, lit(0) - q.z, q.w); }

// v rotated by the inverse of the unit quaternion q.
LANE_FN real3 rotateBack(LANE_IN(quat) q, LANE_IN(real3) v) { return rotate(conjugate(q), v); }

// Hamilton product: first b, then a.
LANE_FN quat multiply(LANE_IN(quat) a, LANE_IN(quat) b) {
  return makeQuat(madd(a.w, b.x, madd(a.x, b.w, madd(a.y, b.z, lit(0) - a.z * b.y))),
                  madd(a.w, b.y, madd(a.y, b.w, madd(a.z, b.x, lit(0) - a.x * b.z))),
                  madd(a.w, b.z, madd(a.z, b.w, madd(a.x, b.y, lit(0) - a.y * b.x))),
                  madd(a.w, b.w, lit(0) - madd(a.x, b.x, madd(a.y, b.y, a.z * b.z))));
}

LANE_FN quat normalizeQuat(LANE_IN(quat) q) {
  real inverse = inverseSqrt(madd(q.x, q.x, madd(q.y, q.y, madd(q.z, q.z, q.w * q.w))));
  return makeQuat(q.x * inverse, q.y * inverse, q.z * inverse, q.w * inverse);
}

// Shortest rotation that takes the unit vector a to the unit vector b. Within 2.6 degrees of opposite directions
// (1 + a.b < 1e-3) it rotates by less than needed, so that it stays finite everywhere.
LANE_FN quat rotationBetween(LANE_IN(real3) a, LANE_IN(real3) b) {
  real3 axis = cross(a, b);
  real w = max(lit(1) + dot(a, b), lit(1e-3));
  return normalizeQuat(makeQuat(axis.x, axis.y, axis.z, w));
}

// Normalised linear interpolation of unit quaternions on the shorter arc, t in [0, 1].
LANE_FN quat interpolateRotation(LANE_IN(quat) a, LANE_IN(quat) b, LANE_IN(real) t) {
  real d = madd(a.x, b.x, madd(a.y, b.y, madd(a.z, b.z, a.w * b.w)));
  real tb = select(d < lit(0), lit(0) - t, t);
  real ta = lit(1) - t;
  return normalizeQuat(
      makeQuat(madd(a.x, ta, b.x * tb), madd(a.y, ta, b.y * tb), madd(a.z, ta, b.z * tb), madd(a.w, ta, b.w * tb)));
}
