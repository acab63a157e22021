// Kernel text: see kernels/README.md. Requires kernels/rotation.h.
//
// A signed distance field (SDF) in bricks of 8 x 8 x 8 cells. core/distance_field.h has the memory layout, which the
// backends read. Indices of bricks, corners and samples are whole reals below 2^24, exact in float.
//
// A field may be bent (Bend): the point at p was at p + w(p) at rest, with a quadratic polynomial w. Linear blend
// skinning between two joints whose weights change linearly is of this form. Outside its box, w takes the value at the
// nearest point of the box.

// A point in the field's grid.
struct FieldPlace {
  real brick;         // index of the brick
  real corner;        // index of the brick's low corner among the corners
  real first_sample;  // index of the cell's low sample in the brick
  real3 in_brick;     // position within the brick, 0 to 1
  real3 in_cell;      // position within the cell, 0 to 1
  real3 outside;      // m, from the nearest point of the grid, to which all of the above belong
};

LANE_FN real3 floorBelow(LANE_IN(real3) a, LANE_IN(real3) end) {
  return makeReal3(min(floor(a.x), end.x - lit(1)), min(floor(a.y), end.y - lit(1)), min(floor(a.z), end.z - lit(1)));
}

// `origin`: low corner of the grid, m; `cell`: m; `bricks`: their number per axis.
LANE_FN FieldPlace fieldPlace(LANE_IN(real3) p, LANE_IN(real3) origin, LANE_IN(real) cell, LANE_IN(real3) bricks) {
  real3 size = bricks * lit(8);
  real3 wanted = (p - origin) * (lit(1) / cell);
  real3 at = makeReal3(clamp(wanted.x, lit(0), size.x), clamp(wanted.y, lit(0), size.y), clamp(wanted.z, lit(0), size.z));
  real3 b = floorBelow(at * lit(0.125), bricks);
  real3 local = at - b * lit(8);
  real3 c = floorBelow(local, makeReal3(lit(8), lit(8), lit(8)));
  FieldPlace place;
  place.brick = (b.z * bricks.y + b.y) * bricks.x + b.x;
  place.corner = (b.z * (bricks.y + lit(1)) + b.y) * (bricks.x + lit(1)) + b.x;
  place.first_sample = (c.z * lit(9) + c.y) * lit(9) + c.x;
  place.in_brick = local * lit(0.125);
  place.in_cell = local - c;
  place.outside = (wanted - at) * cell;
  return place;
}

// Trilinear interpolant of eight samples (vXYZ) at t in [0, 1]^3, and its exact gradient by t.
LANE_FN real trilinear(LANE_IN(real) v000, LANE_IN(real) v100, LANE_IN(real) v010, LANE_IN(real) v110, LANE_IN(real) v001,
                       LANE_IN(real) v101, LANE_IN(real) v011, LANE_IN(real) v111, LANE_IN(real3) t, LANE_OUT(real3) gradient) {
  real dx00 = v100 - v000;
  real dx10 = v110 - v010;
  real dx01 = v101 - v001;
  real dx11 = v111 - v011;
  real x00 = madd(dx00, t.x, v000);
  real x10 = madd(dx10, t.x, v010);
  real x01 = madd(dx01, t.x, v001);
  real x11 = madd(dx11, t.x, v011);
  real dy0 = x10 - x00;
  real dy1 = x11 - x01;
  real dz = madd(dy1, t.y, x01) - madd(dy0, t.y, x00);
  real dx0 = madd(dx10 - dx00, t.y, dx00);
  real dx1 = madd(dx11 - dx01, t.y, dx01);
  gradient = makeReal3(madd(dx1 - dx0, t.z, dx0), madd(dy1 - dy0, t.z, dy0), dz);
  return madd(dz, t.z, madd(dy0, t.y, x00));
}

// Signed distance in a brick beyond the band, on `side` 1 (outside) or -1 (inside): never farther from 0 than the true
// one. A distance function has slope 1 at most. So the interpolant of the corners deviates by at most the mean distance
// to them, which the root mean square bounds. `brick`: edge of the brick, m.
LANE_FN real farDistance(LANE_IN(real) at_corners, LANE_IN(real3) in_brick, LANE_IN(real) brick, LANE_IN(real) side,
                         LANE_IN(real) band) {
  real3 rest = makeReal3(lit(1), lit(1), lit(1)) - in_brick;
  real off = brick * sqrt(max(dot(in_brick, rest), lit(0)));
  return side * max(band, side * at_corners - off);
}

// Lower bound of the distance outside the grid, which extends at least `band` beyond the body. `normal`: the gradient.
LANE_FN real distanceOutsideGrid(LANE_IN(real3) outside, LANE_IN(real) band, LANE_OUT(real3) normal) {
  normal = normalizeOrZero(outside);
  return band + length(outside);
}

// Stored values around a point. In bricks near the surface (`side` 0): samples at the corners of its cell, in units of
// `quantum`. In other bricks and outside the grid: distances at the corners of its brick, m, and `side` 1 or -1.
struct FieldCorners {
  real v000, v100, v010, v110, v001, v101, v011, v111;
  real side;
};

// Value of `clear` for a query without contact: the distance inside, beyond the band, is not shortened then.
LANE_FN real noClearance() { return lit(-1e9); }
// Signed distance (m) and unit normal for contact. Inside, beyond the band, it is never farther from 0 than the true
// one, so that contact does not overshoot (except with noClearance). Outside, where it is only a lower bound, it is
// at least `clear`, so that nothing is pushed.
LANE_FN real fieldDistance(LANE_IN(FieldPlace) place, LANE_IN(FieldCorners) at, LANE_IN(real) cell, LANE_IN(real) band,
                           LANE_IN(real) quantum, LANE_IN(real) clear, LANE_OUT(real3) normal) {
  mask stored = abs(at.side) < lit(0.5);
  real3 gradient;
  real value = trilinear(at.v000, at.v100, at.v010, at.v110, at.v001, at.v101, at.v011, at.v111,
                         select(stored, place.in_cell, place.in_brick), gradient);
  real far = farDistance(value, place.in_brick, cell * lit(8), at.side, band);
  real3 beyond;
  real outside = distanceOutsideGrid(place.outside, band, beyond);
  mask in_grid = dot(place.outside, place.outside) < lit(1e-30);
  real3 way = normalizeOrZero(select(in_grid, gradient, beyond));
  normal = select(dot(way, way) > lit(0.5), way, makeReal3(lit(0), lit(1), lit(0)));
  far = select(in_grid, select(clear > noClearance(), far, value), outside);
  far = select(far > lit(0), max(far, clear), far);
  return select(stored && in_grid, value * quantum, far);
}

struct Bend {
  real3 one, x, y, z, xx, yy, zz, xy, yz, zx;  // coefficients of these products of p's components
  real3 reach;                                 // half extents of the box about the origin, m
};

LANE_FN real3 inBendBox(LANE_IN(Bend) bend, LANE_IN(real3) p) {
  return makeReal3(clamp(p.x, -bend.reach.x, bend.reach.x), clamp(p.y, -bend.reach.y, bend.reach.y),
                   clamp(p.z, -bend.reach.z, bend.reach.z));
}

LANE_FN real3 bendShift(LANE_IN(Bend) bend, LANE_IN(real3) p) {
  real3 q = inBendBox(bend, p);
  real3 by_x = madd(bend.xx, q.x, madd(bend.xy, q.y, bend.x));
  real3 by_y = madd(bend.yy, q.y, madd(bend.yz, q.z, bend.y));
  real3 by_z = madd(bend.zz, q.z, madd(bend.zx, q.x, bend.z));
  return madd(by_x, q.x, madd(by_y, q.y, madd(by_z, q.z, bend.one)));
}

// Derivatives of w by the components of a point q in its box.
LANE_FN void bendRates(LANE_IN(Bend) bend, LANE_IN(real3) q, LANE_OUT(real3) by_x, LANE_OUT(real3) by_y, LANE_OUT(real3) by_z) {
  by_x = madd(bend.xx, q.x + q.x, madd(bend.xy, q.y, madd(bend.zx, q.z, bend.x)));
  by_y = madd(bend.yy, q.y + q.y, madd(bend.yz, q.z, madd(bend.xy, q.x, bend.y)));
  by_z = madd(bend.zz, q.z + q.z, madd(bend.zx, q.x, madd(bend.yz, q.y, bend.z)));
}

// Gradient at p in the bent state of a function whose gradient at rest is `normal`.
LANE_FN real3 bentGradient(LANE_IN(Bend) bend, LANE_IN(real3) p, LANE_IN(real3) normal) {
  real3 by_x, by_y, by_z;
  bendRates(bend, inBendBox(bend, p), by_x, by_y, by_z);
  return makeReal3(normal.x + select(abs(p.x) > bend.reach.x, lit(0), dot(by_x, normal)),
                   normal.y + select(abs(p.y) > bend.reach.y, lit(0), dot(by_y, normal)),
                   normal.z + select(abs(p.z) > bend.reach.z, lit(0), dot(by_z, normal)));
}

// Position in the bent state of the point that is at `rest` at rest: two fixed-point iterations of x = rest - w(x),
// from x = p.
LANE_FN real3 placedByBend(LANE_IN(Bend) bend, LANE_IN(real3) rest, LANE_IN(real3) p) {
  return rest - bendShift(bend, rest - bendShift(bend, p));
}
// Position to which the surface carries the point at p while the bend changes from `before` to `now`.
LANE_FN real3 carriedByBend(LANE_IN(Bend) before, LANE_IN(Bend) now, LANE_IN(real3) p) {
  return placedByBend(now, p + bendShift(before, p), p);
}

// Distance to a bent surface, m. `distance`: that at rest; `gradient`: its bentGradient(), on return the unit normal.
// First order within 5 mm of the surface. Elsewhere a bound that is never farther from 0 than the true distance,
// because the bend stretches distances by at most `stretch`.
LANE_FN real bentDistance(LANE_IN(real) distance, LANE_IN(real) stretch, LANE_INOUT(real3) gradient) {
  real rise = length(gradient);
  mask near = abs(distance) < lit(5e-3) && rise > lit(0.25);
  gradient = gradient * inverse(max(rise, lit(1e-12)));
  return distance / select(near, rise, stretch);
}
