// Encoding 5 of docs/wire.md: an edge's direction as a point of the tangent plane of the unit sphere at its
// prediction. The quantisation error is then isotropic, and the symbols are the prediction's error. In the lane
// vocabulary of kernels/README.md. Operations are not fused and sums go from left to right, so that both ends compute
// the same bits.

FN real plainDot(const real3& a, const real3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
FN real3 unit(const real3& a) { return a * (lit(1) / sqrt(plainDot(a, a))); }

/// Rotates `a` by the smallest rotation from `from` to `to`, all unit (parallel transport; Bergou et al., Discrete
/// Elastic Rods, 2008). Returns `a` where these are almost opposite.
FN real3 turned(const real3& a, const real3& from, const real3& to) {
  const real cosine = plainDot(from, to);
  const real3 both = from + to;
  const real3 less = a - both * (plainDot(both, a) / (lit(1) + cosine));
  return select(cosine > lit(-0.9), less + to * (lit(2) * plainDot(from, a)), a);
}

/// Axes u and v of the plane normal to a unit vector (Duff et al., Building an Orthonormal Basis, Revisited, JCGT
/// 2017).
FN void axesAcross(const real3& n, OUT(real3) u, OUT(real3) v) {
  const real sign = select(n.z < lit(0), lit(-1), lit(1));
  const real a = lit(-1) / (sign + n.z), b = n.x * n.y * a;
  u = makeReal3(lit(1) + sign * n.x * n.x * a, sign * b, lit(-1) * sign * n.x);
  v = makeReal3(b, sign + n.y * n.y * a, lit(-1) * n.y);
}
