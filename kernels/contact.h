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

// Where a rigid body takes a point of it in a substep, to second order: to `a`, where one of its points is at the end, after
// `a_motion`, turned about it by `turn` (radians along the axis).
FN real3 carriedBy(IN(real3) point, IN(real3) a, IN(real3) a_motion, IN(real3) turn) {
  real3 arm = (point - a) + a_motion;
  return a + arm + cross(turn, madd(cross(turn, arm), lit(0.5), arm));
}

// `force` without what goes along the normal.
FN real3 tangentialPart(IN(real3) force, IN(real3) normal) { return madd(normal, lit(0) - dot(force, normal), force); }

// What of its weight a length solve is to move a vertex with that friction holds. Not nothing: an edge whose both ends are
// held might have any tension.
FN real heldGive() { return lit(0.25); }
// By how much making lengths exact may press hair into a body, metres.
FN real contactSlack() { return lit(2e-5); }

// Contact of a vertex at x: where it has to go. `force` is what the body pressed it with in the last substep, in units of
// length x mass (force x substep^2), and has acted already; the vertex is moved by what that was too little or too much,
// as Coulomb's law has it: normal forces only push, friction is at most friction x normal force and only takes back slip.
// `gap` < 0 is depth. `carried`: where the surface has taken the point at which the vertex was. `moved`: how far forces have
// moved x in this substep. What they did is kept in `force` for the next one, at rest all of it; what the vertex's own
// speed did is over with the substep. A vertex that was pressed too much comes back, but by no more than it was moved.
// `give` is what of its weight a length solve is to move it with along the surface.
FN real3 resolveContact(IN(real3) x, IN(real3) carried, IN(real3) moved, IN(real3) normal, IN(real) gap, IN(real) friction,
                        IN(real) weight, INOUT(real3) force, OUT(real) give) {
  real mass = inverse(weight);
  real held = max(dot(force, normal), lit(0));
  real rise = dot(moved, normal);
  real pressure = max(held - gap * mass, lit(0));
  real back = min(held * weight, max(rise, lit(0)));
  real3 out_x = madd(normal, max(lit(0) - gap, lit(0) - back), x);

  real3 drag = tangentialPart(force, normal), slip = tangentialPart(out_x - carried, normal);
  real3 wanted = madd(slip, lit(0) - mass, drag);
  real amount = length(wanted), most = friction * pressure;
  mask slides = amount >= most;
  real3 total = wanted * (most / select(slides, max(amount, lit(1e-30)), lit(1)));
  real taken = dot(drag - total, slip) * weight / max(dot(slip, slip), lit(1e-30));
  out_x = madd(slip, lit(0) - select(slides, clamp(taken, lit(0), lit(1)), lit(1)), out_x);

  real kept = max(held + min(lit(0) - gap, lit(0) - rise) * mass, lit(0));
  real3 stuck = madd(tangentialPart(moved, normal), lit(0) - mass, drag);
  real3 sliding = total * (kept / max(pressure, lit(1e-30)));
  real share = min(friction * kept / max(length(stuck), lit(1e-30)), lit(1));
  force = madd(normal, kept, select(slides, sliding, stuck * share));
  give = select(slides, lit(1), heldGive());
  return out_x;
}
