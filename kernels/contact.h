// Kernel text: see kernels/README.md. Signed distances are in metres, negative inside; `normal` is a unit vector
// pointing out of the body.

FN real sphereDistance(IN(real3) p, IN(real3) centre, IN(real) radius, OUT(real3) normal) {
  real3 d = p - centre;
  real l = length(d);
  mask at_centre = l < lit(1e-12);
  real3 up = makeReal3(lit(0), lit(1), lit(0));
  normal = select(at_centre, up, d * inverse(select(at_centre, lit(1), l)));
  return l - radius;
}

// Capsule from a to b; a = b is a sphere.
FN real capsuleDistance(IN(real3) p, IN(real3) a, IN(real3) b, IN(real) radius, OUT(real3) normal, OUT(real) along) {
  real3 axis = b - a;
  real l2 = dot(axis, axis);
  mask point = l2 < lit(1e-24);
  along = select(point, lit(0), clamp(dot(p - a, axis) / select(point, lit(1), l2), lit(0), lit(1)));
  return sphereDistance(p, madd(axis, along, a), radius, normal);
}

// Half space behind the plane through `point` with unit normal `n`.
FN real planeDistance(IN(real3) p, IN(real3) point, IN(real3) n, OUT(real3) normal) {
  normal = n;
  return dot(p - point, n);
}

// The hull of a ball of `radius` about a and one of `radius_b` about b (a round cone); one ball in the other or a = b is the
// larger ball. The normal meets the axis where it makes the cone's half angle with the plane across it; `along` is that
// place, 0 at a to 1 at b.
FN real taperedCapsuleDistance(IN(real3) p, IN(real3) a, IN(real3) b, IN(real) radius, IN(real) radius_b, OUT(real3) normal,
                               OUT(real) along) {
  real3 axis = b - a;
  real l2 = dot(axis, axis);
  mask point = l2 < lit(1e-24);
  real il = select(point, lit(1e12), inverseSqrt(select(point, lit(1), l2)));
  real3 unit = axis * il;
  real3 d = p - a;
  real y = dot(d, unit);
  real away = length(madd(unit, lit(0) - y, d));
  real sine = (radius - radius_b) * il;
  real cosine = sqrt(max(lit(1) - sine * sine, lit(1e-12)));
  along = clamp((y - sine * away / cosine) * il, lit(0), lit(1));
  along = select(sine >= lit(1), lit(0), select(sine <= lit(-1), lit(1), along));
  return sphereDistance(p, madd(axis, along, a), madd(radius_b - radius, along, radius), normal);
}

// Box about the origin along the axes; `extent`: half its edges.
FN real boxDistance(IN(real3) p, IN(real3) extent, OUT(real3) normal) {
  real3 q = makeReal3(abs(p.x), abs(p.y), abs(p.z)) - extent;
  real nearest = max(q.x, max(q.y, q.z));
  mask by_x = q.x >= max(q.y, q.z);
  mask by_y = (q.y >= q.z) && !by_x;
  real3 face = makeReal3(select(by_x, lit(1), lit(0)), select(by_y, lit(1), lit(0)), select(by_x || by_y, lit(0), lit(1)));
  mask outside = nearest > lit(1e-12);
  real3 way = select(outside, makeReal3(max(q.x, lit(0)), max(q.y, lit(0)), max(q.z, lit(0))), face);
  real l = length(way);
  way = way * inverse(l);
  normal = makeReal3(select(p.x < lit(0), lit(0) - way.x, way.x), select(p.y < lit(0), lit(0) - way.y, way.y),
                     select(p.z < lit(0), lit(0) - way.z, way.z));
  return select(outside, l, nearest);
}

// Ellipsoid about the origin along the axes; `extent`: its half axes, at most 100 times as long as the shortest. The nearest
// point is extent^2 p / (extent^2 + t) with the t that puts it on the surface (Eberly, "Distance from a point to an
// ellipse, an ellipsoid, or a hyperellipsoid"); t by Newton's method on the secular equation's reciprocal (More, Sorensen
// 1983), from below. In units of the shortest half axis, and t from its pole.
FN real ellipsoidDistance(IN(real3) p, IN(real3) extent, OUT(real3) normal) {
  real least = min(extent.x, min(extent.y, extent.z));
  real scale = lit(1) / least;
  real3 e = extent * scale;
  real3 y = makeReal3(max(abs(p.x) * scale, lit(1e-6)), max(abs(p.y) * scale, lit(1e-6)), max(abs(p.z) * scale, lit(1e-6)));
  real3 over = makeReal3(e.x * e.x - lit(1), e.y * e.y - lit(1), e.z * e.z - lit(1));
  real3 ey = makeReal3(e.x * y.x, e.y * y.y, e.z * y.z);
  real t = max(ey.x - over.x, max(ey.y - over.y, ey.z - over.z));
  real3 g = ey;
  for (int i = 0; i < 8; ++i) {
    real3 pole = makeReal3(lit(1) / (t + over.x), lit(1) / (t + over.y), lit(1) / (t + over.z));
    g = makeReal3(ey.x * pole.x, ey.y * pole.y, ey.z * pole.z);
    real g2 = dot(g, g);
    real slope = g.x * g.x * pole.x + g.y * g.y * pole.y + g.z * g.z * pole.z;
    t = madd((sqrt(g2) - lit(1)) * g2, lit(1) / slope, t);
  }
  real3 n = makeReal3(g.x / e.x, g.y / e.y, g.z / e.z);
  n = n * inverseSqrt(dot(n, n));
  real3 surface = makeReal3(g.x * e.x, g.y * e.y, g.z * e.z);
  normal = makeReal3(select(p.x < lit(0), lit(0) - n.x, n.x), select(p.y < lit(0), lit(0) - n.y, n.y),
                     select(p.z < lit(0), lit(0) - n.z, n.z));
  return dot(y - surface, n) * least;
}

// A convex body is what lies behind all its planes, unit normals n_i and distances d_i from the origin. To be called for one
// after the other: `nearest` and `normal` are of the plane that is nearest so far, at first -1e9 and any. Exact inside and
// before the faces; before edges and corners a lower bound.
FN void convexPlane(IN(real3) p, IN(real3) n, IN(real) d, INOUT(real) nearest, INOUT(real3) normal) {
  real distance = dot(p, n) - d;
  mask nearer = distance > nearest;
  nearest = select(nearer, distance, nearest);
  normal = select(nearer, n, normal);
}

// How far the surface moves at x in `dt`: with the axis point q by q_motion, and around it.
FN real3 surfaceMotion(IN(real3) x, IN(real3) q, IN(real3) q_motion, IN(real3) angular_velocity, IN(real) dt) {
  return madd(cross(angular_velocity, x - q), dt, q_motion);
}

// Moves x out of a body along its normal when the signed distance less the hair radius is negative, then takes back
// of the tangential slip against the surface as much as Coulomb's law allows: at most friction x depth.
// x_start: position at the start of the substep; surface_motion: how far the surface moved since then; both metres.
FN real3 resolveContact(IN(real3) x, IN(real3) x_start, IN(real3) surface_motion, IN(real3) normal, IN(real) distance,
                        IN(real) friction) {
  real depth = max(lit(0) - distance, lit(0));
  real3 out_x = madd(normal, depth, x);
  real3 slip = (out_x - x_start) - surface_motion;
  real3 tangential = madd(normal, lit(0) - dot(slip, normal), slip);
  real amount = length(tangential);
  mask slides = amount > friction * depth;
  real share = select(slides, friction * depth / select(slides, amount, lit(1)), lit(1));
  real held = select(distance < lit(0), share, lit(0));
  return madd(tangential, lit(0) - held, out_x);
}
