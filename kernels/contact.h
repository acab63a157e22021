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
