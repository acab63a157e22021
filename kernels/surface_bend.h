// Kernel text: see kernels/README.md. A surface that is bent: what is at p was at rest at p + w(p), with a quadratic w. Between
// two joints whose weights go over evenly linear blending is just that. Beyond its box w is what it is at the box's nearest point.

struct Bend {
  real3 one, x, y, z, xx, yy, zz, xy, yz, zx;  // factors of these products of p's components
  real3 reach;                                 // of the box about the origin, m
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

// How w changes with the components of a place q in its box.
FN void bendRates(IN(Bend) bend, IN(real3) q, OUT(real3) by_x, OUT(real3) by_y, OUT(real3) by_z) {
  by_x = madd(bend.xx, q.x + q.x, madd(bend.xy, q.y, madd(bend.zx, q.z, bend.x)));
  by_y = madd(bend.yy, q.y + q.y, madd(bend.yz, q.z, madd(bend.xy, q.x, bend.y)));
  by_z = madd(bend.zz, q.z + q.z, madd(bend.zx, q.x, madd(bend.yz, q.y, bend.z)));
}

// The gradient at p of what has the gradient `normal` where p is at rest.
FN real3 bentGradient(IN(Bend) bend, IN(real3) p, IN(real3) normal) {
  real3 by_x, by_y, by_z;
  bendRates(bend, inBendBox(bend, p), by_x, by_y, by_z);
  return makeReal3(normal.x + select(abs(p.x) > bend.reach.x, lit(0), dot(by_x, normal)),
                   normal.y + select(abs(p.y) > bend.reach.y, lit(0), dot(by_y, normal)),
                   normal.z + select(abs(p.z) > bend.reach.z, lit(0), dot(by_z, normal)));
}

// Where a bent surface has what is at `rest` at rest: by a second step of the fixed point of x = rest - w(x), from x = p on.
FN real3 placedByBend(IN(Bend) bend, IN(real3) rest, IN(real3) p) {
  return rest - bendShift(bend, rest - bendShift(bend, p));
}
// Where the bent surface has taken what was at p, when the bend went from `before` to `now`.
FN real3 carriedByBend(IN(Bend) before, IN(Bend) now, IN(real3) p) {
  return placedByBend(now, p + bendShift(before, p), p);
}

// Distance to a bent surface from `distance` at rest, with the gradient of that as bentGradient() has it, which becomes the unit
// normal. Near the surface to the first order, elsewhere no farther from 0 than the true one: distances grow by no more than
// `stretch` times the way.
FN real bentDistance(IN(real) distance, IN(real) stretch, INOUT(real3) gradient) {
  real rise = length(gradient);
  mask near = abs(distance) < lit(5e-3) && rise > lit(0.25);
  gradient = gradient * inverse(max(rise, lit(1e-12)));
  return distance / select(near, rise, stretch);
}
