// Quantisation in the lane vocabulary of kernels/README.md: grid positions, and directions as points of the octahedron or of
// a tangent plane. Operations are not fused and sums go from left to right, so that both ends compute the same bits.
// Octahedron |x| + |y| + |z| = 1, its lower half folded outwards onto the unit square: Meyer et al., On Floating-Point Normal
// Vectors, EGSR 2010; Cigolle et al., A Survey of Efficient Representations for Independent Unit Vectors, JCGT 2014. Its
// coordinates are whole numbers from 0 to `steps`, which is 2^bits - 1.
// Tangent plane of the unit sphere at the predicted direction: encoding 5 of docs/wire.md. The quantisation error is then
// isotropic, and the symbols are the prediction's error.

/// Nearest whole number, ties to even; |x| <= 2^22.
LANE_FN real nearestWhole(real x) { return (x + lit(12582912)) - lit(12582912); }

/// Nearest grid point of a coordinate in steps, clamped to +-most; -most for NaN.
LANE_FN real gridNumber(real steps, real most) {
  const real low = -most;
  const real above = select(low < steps, steps, low);
  return nearestWhole(select(above < most, above, most));
}

struct OctahedralPoint {
  real u, v;
};

LANE_FN real octahedralFold(real across, real along) { return (lit(1) - abs(across)) * select(along >= lit(0), lit(1), lit(-1)); }

/// Metric of the squared angle, to first order, by which the direction turns when the point moves by (du, dv): the
/// movement on the octahedron without its component along the direction.
struct OctahedralMetric {
  real uu, uv, vv;
};
LANE_FN real turnOf(const OctahedralMetric& metric, real du, real dv) {
  return metric.uu * du * du + lit(2) * metric.uv * du * dv + metric.vv * dv * dv;
}

/// The grid point whose direction is nearest to a direction of any length above 0. Rounding each coordinate alone
/// would increase the largest error by half, where the octahedron's faces are steepest to its axes.
LANE_FN OctahedralPoint toOctahedral(const real3& direction, real steps) {
  const real3 p = direction * (lit(1) / (abs(direction.x) + abs(direction.y) + abs(direction.z)));
  const real sign_x = select(p.x >= lit(0), lit(1), lit(-1)), sign_y = select(p.y >= lit(0), lit(1), lit(-1));
  const mask below = p.z < lit(0);
  const real at_u = clamp(select(below, octahedralFold(p.y, p.x), p.x) * lit(0.5) + lit(0.5), lit(0), lit(1)) * steps;
  const real at_v = clamp(select(below, octahedralFold(p.x, p.y), p.y) * lit(0.5) + lit(0.5), lit(0), lit(1)) * steps;
  const real u = nearestWhole(at_u), v = nearestWhole(at_v);
  const real off_u = u - at_u, off_v = v - at_v;
  real other_u = u - select(off_u < lit(0), lit(-1), lit(1)), other_v = v - select(off_v < lit(0), lit(-1), lit(1));
  other_u = select(other_u < lit(0) || other_u > steps, u, other_u);
  other_v = select(other_v < lit(0) || other_v > steps, v, other_v);
  // Tangents along u and v: above (1, 0, -sign_x) and (0, 1, -sign_y); below (0, turned, -sign_x) and (turned, 0,
  // -sign_y).
  const real across = sign_x * sign_y, turned = -across;
  const real radial_u = select(below, turned * p.y, p.x) - sign_x * p.z;
  const real radial_v = select(below, turned * p.x, p.y) - sign_y * p.z;
  const real inverse_square = lit(1) / (p.x * p.x + (p.y * p.y + p.z * p.z));
  const OctahedralMetric metric{lit(2) - radial_u * radial_u * inverse_square, across - radial_u * radial_v * inverse_square,
                                lit(2) - radial_v * radial_v * inverse_square};
  OctahedralPoint best{u, v};
  real least = turnOf(metric, off_u, off_v);
  const OctahedralPoint others[] = {{other_u, v}, {u, other_v}, {other_u, other_v}};
  for (const OctahedralPoint& other : others) {
    const real turn = turnOf(metric, other.u - at_u, other.v - at_v);
    const mask is_better = turn < least;
    least = select(is_better, turn, least);
    best = {select(is_better, other.u, best.u), select(is_better, other.v, best.v)};
  }
  return best;
}

/// The direction of a point, unit.
LANE_FN real3 fromOctahedral(const OctahedralPoint& point, real steps) {
  const real step = lit(2) / steps;
  const real x = point.u * step - lit(1), y = point.v * step - lit(1);
  const real z = lit(1) - abs(x) - abs(y);
  const mask below = z < lit(0);
  const real3 p = makeReal3(select(below, octahedralFold(y, x), x), select(below, octahedralFold(x, y), y), z);
  return p * (lit(1) / sqrt(p.x * p.x + p.y * p.y + p.z * p.z));
}

LANE_FN real plainDot(const real3& a, const real3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
LANE_FN real3 unit(const real3& a) { return a * (lit(1) / sqrt(plainDot(a, a))); }

/// Rotates `a` by the smallest rotation from `from` to `to`, all unit (parallel transport; Bergou et al., Discrete
/// Elastic Rods, 2008). Returns `a` where these are almost opposite.
LANE_FN real3 turned(const real3& a, const real3& from, const real3& to) {
  const real cosine = plainDot(from, to);
  const real3 both = from + to;
  const real3 less = a - both * (plainDot(both, a) / (lit(1) + cosine));
  return select(cosine > lit(-0.9), less + to * (lit(2) * plainDot(from, a)), a);
}

/// Axes u and v of the plane normal to a unit vector (Duff et al., Building an Orthonormal Basis, Revisited, JCGT
/// 2017).
LANE_FN void axesAcross(const real3& n, LANE_OUT(real3) u, LANE_OUT(real3) v) {
  const real sign = select(n.z < lit(0), lit(-1), lit(1));
  const real a = lit(-1) / (sign + n.z), b = n.x * n.y * a;
  u = makeReal3(lit(1) + sign * n.x * n.x * a, sign * b, -sign * n.x);
  v = makeReal3(b, sign + n.y * n.y * a, -n.y);
}
