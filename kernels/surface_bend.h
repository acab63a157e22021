// Kernel text: see kernels/README.md. A bent surface: the point at p was at p + w(p) at rest, with a quadratic
// polynomial w. Linear blend skinning between two joints whose weights change linearly is of this form. Outside its
// box, w takes the value at the nearest point of the box.

struct Bend {
  real3 one, x, y, z, xx, yy, zz, xy, yz, zx;  // coefficients of these products of p's components
  real3 reach;                                 // half extents of the box about the origin, m
};

FN real3 inBendBox(IN(Bend) bend, IN(real3) p) {
  return makeReal3(clamp(p.x, lit(0) - bend.reach.x, bend.reach.x), clamp(p.y, lit(0) - bend.reach.y, bend.reach.y),
                   clamp(p.z, lit(0) - bend.reach.z, bend.reach.z));
}

FN real3 bendShift(IN(Bend) bend, IN(real3) p) {
  real3 q = inBendBox(bend, p);
  real3 by_x = madd(bend.xx, q.x, madd(bend.xy, q.y, bend.x));
  real3 by_y = madd(bend.yy, q.y, madd(bend.yz, q.z, bend.y));
  real3 by_z = madd(bend.zz, q.z, madd(bend.zx, q.x, bend.z));
  return madd(by_x, q.x, madd(by_y, q.y, madd(by_z, q.z, bend.one)));
}

// Derivatives of w by the components of a point q in its box.
FN void bendRates(IN(Bend) bend, IN(real3) q, OUT(real3) by_x, OUT(real3) by_y, OUT(real3) by_z) {
  by_x = madd(bend.xx, q.x + q.x, madd(bend.xy, q.y, madd(bend.zx, q.z, bend.x)));
  by_y = madd(bend.yy, q.y + q.y, madd(bend.yz, q.z, madd(bend.xy, q.x, bend.y)));
  by_z = madd(bend.zz, q.z + q.z, madd(bend.zx, q.x, madd(bend.yz, q.y, bend.z)));
}

// Gradient at p in the bent state of a function whose gradient at rest is `normal`.
FN real3 bentGradient(IN(Bend) bend, IN(real3) p, IN(real3) normal) {
  real3 by_x, by_y, by_z;
  bendRates(bend, inBendBox(bend, p), by_x, by_y, by_z);
  return makeReal3(normal.x + select(abs(p.x) > bend.reach.x, lit(0), dot(by_x, normal)),
                   normal.y + select(abs(p.y) > bend.reach.y, lit(0), dot(by_y, normal)),
                   normal.z + select(abs(p.z) > bend.reach.z, lit(0), dot(by_z, normal)));
}

// Position in the bent state of the point that is at `rest` at rest: two fixed-point iterations of x = rest - w(x),
// from x = p.
FN real3 placedByBend(IN(Bend) bend, IN(real3) rest, IN(real3) p) { return rest - bendShift(bend, rest - bendShift(bend, p)); }
// Position to which the surface carries the point at p while the bend changes from `before` to `now`.
FN real3 carriedByBend(IN(Bend) before, IN(Bend) now, IN(real3) p) { return placedByBend(now, p + bendShift(before, p), p); }

// Distance to a bent surface, m. `distance`: that at rest; `gradient`: its bentGradient(), on return the unit normal.
// First order within 5 mm of the surface. Elsewhere a bound that is never farther from 0 than the true distance,
// because the bend stretches distances by at most `stretch`.
FN real bentDistance(IN(real) distance, IN(real) stretch, INOUT(real3) gradient) {
  real rise = length(gradient);
  mask near = abs(distance) < lit(5e-3) && rise > lit(0.25);
  gradient = gradient * inverse(max(rise, lit(1e-12)));
  return distance / select(near, rise, stretch);
}
