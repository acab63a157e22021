// Kernel text: see kernels/README.md. Air and hair on regular grids. Coordinates are in cells: node i of an axis is at
// i. The wind grid is staggered (Harlow and Welch 1965): component a is stored in the middle of the faces across axis
// a. Face i lies before cell i, so that the coordinates of every array are its own indices.

// Position among nodes 0 .. last of each axis; positions outside are clamped to the grid.
struct GridPlace {
  real3 low;   // index of the node before it
  real3 part;  // fraction of the distance to the next node, 0 to 1
};
LANE_FN GridPlace gridPlace(LANE_IN(real3) at, LANE_IN(real3) last) {
  real3 in_grid = makeReal3(clamp(at.x, lit(0), last.x), clamp(at.y, lit(0), last.y), clamp(at.z, lit(0), last.z));
  GridPlace place;
  place.low = makeReal3(min(floor(in_grid.x), last.x - lit(1)), min(floor(in_grid.y), last.y - lit(1)),
                        min(floor(in_grid.z), last.z - lit(1)));
  place.part = in_grid - place.low;
  return place;
}

// Trilinear interpolation of eight corners (vXYZ), with the weights of splatWeight().
LANE_FN real interpolated(LANE_IN(real) v000, LANE_IN(real) v100, LANE_IN(real) v010, LANE_IN(real) v110, LANE_IN(real) v001,
                          LANE_IN(real) v101, LANE_IN(real) v011, LANE_IN(real) v111, LANE_IN(real3) part) {
  real v00 = madd(v100 - v000, part.x, v000);
  real v10 = madd(v110 - v010, part.x, v010);
  real v01 = madd(v101 - v001, part.x, v001);
  real v11 = madd(v111 - v011, part.x, v011);
  real v0 = madd(v10 - v00, part.y, v00);
  real v1 = madd(v11 - v01, part.y, v01);
  return madd(v1 - v0, part.z, v0);
}
// Weight of the corner (cx, cy, cz), each 0 or 1, for a point at `part`.
LANE_FN real splatWeight(LANE_IN(real3) part, LANE_IN(real) cx, LANE_IN(real) cy, LANE_IN(real) cz) {
  real x = madd(cx, part.x + part.x - lit(1), lit(1) - part.x);
  real y = madd(cy, part.y + part.y - lit(1), lit(1) - part.y);
  real z = madd(cz, part.z + part.z - lit(1), lit(1) - part.z);
  return x * y * z;
}
// Rotates from the world's axes to those of the turbulence box, and back: half a turn about (2, 3, 7). Without it, wind
// along an axis of the box would repeat after one length of it, and eddies along that axis would stand still in it.
LANE_FN real3 toTurbulenceBox(LANE_IN(real3) v) {
  real by = (lit(2) * v.x + lit(3) * v.y + lit(7) * v.z) * lit(1.0 / 31);
  return makeReal3(lit(2) * by - v.x, lit(3) * by - v.y, lit(7) * by - v.z);
}
// One axis of a blur with the kernel (1 2 1) / 4.
LANE_FN real blurred(LANE_IN(real) before, LANE_IN(real) here, LANE_IN(real) after) {
  return madd(before + after, lit(0.25), here * lit(0.5));
}
// Rounds to integers, so that sums do not depend on their order.
LANE_FN real fixedPoint(LANE_IN(real) value) { return floor(value + lit(0.5)); }

// Semi-Lagrangian advection (Stam 1999, "Stable Fluids", section 3.2): position one step ago of what is at `at` now.
// `courant`: time step / cell, s/m.
LANE_FN real3 tracedBack(LANE_IN(real3) at, LANE_IN(real3) velocity, LANE_IN(real) courant) {
  return madd(velocity, lit(0) - courant, at);
}
// MacCormack correction (Selle, Fedkiw, Kim, Liu, Rossignac 2008, "An Unconditionally Stable MacCormack Method").
// `ahead`: advected once; `was`: before advection; `back`: advected forth and back; low, high: range of the values that
// `ahead` was interpolated from, to which the result is clamped.
LANE_FN real macCormack(LANE_IN(real) ahead, LANE_IN(real) was, LANE_IN(real) back, LANE_IN(real) low, LANE_IN(real) high) {
  return clamp(madd(was - back, lit(0.5), ahead), low, high);
}

// Divergence of a cell times its edge: net outflow through its six faces, m/s.
LANE_FN real outflow(LANE_IN(real) x0, LANE_IN(real) x1, LANE_IN(real) y0, LANE_IN(real) y1, LANE_IN(real) z0, LANE_IN(real) z1) {
  return (x1 - x0) + (y1 - y0) + (z1 - z0);
}
// Relative target divergence of a cell by a spherical wind source; `far`: distance of their centres, `radius`: that of
// the sphere, both in cells. Constant inside, so that the speed of its air rises linearly from the centre to the
// surface. It falls to 0 over one cell at the surface, so that a moving sphere enters a cell gradually. The caller
// scales the sum to the flow 4 pi radius^2 speed.
LANE_FN real sphereShare(LANE_IN(real) far, LANE_IN(real) radius) { return clamp(radius - far + lit(0.5), lit(0), lit(1)); }
// Momentum exchange (rate x time step) of a cell with a target divergence: the air that a source lets out has no
// momentum and replaces that share of the cell's air. `wanted`: target divergence x cell, m/s; `courant`: time step /
// cell, s/m.
LANE_FN real sphereExchange(LANE_IN(real) wanted, LANE_IN(real) courant) { return max(wanted, lit(0)) * courant; }
// Pressure projection: velocity of a face less the pressure gradient. Pressure is in m/s (pressure x time step /
// (density x cell)). `open`: 1, or 0 at solids.
LANE_FN real projectVelocity(LANE_IN(real) velocity, LANE_IN(real) open, LANE_IN(real) before, LANE_IN(real) after) {
  return madd(open, before - after, velocity);
}

// Velocity of air after implicit momentum exchange with matter of velocity `other`. `exchange`: rate x time step.
LANE_FN real draggedTo(LANE_IN(real) velocity, LANE_IN(real) other, LANE_IN(real) exchange) {
  return madd(exchange, other, velocity) * inverse(lit(1) + exchange);
}

// draggedTo() in hair with less drag along itself (slipDragLoss), which couples the components. `momentum`: sum of
// exchange x velocity of all that the air exchanges momentum with. `slip`, `slip_across`: the part of the exchange that
// is absent, the mean over hair directions t of less t t' times the hair's exchange; components xx, yy, zz and yz, xz,
// xy. Solves (1 + exchange - slip) u = velocity + momentum by cofactors.
LANE_FN real3 draggedAmong(LANE_IN(real3) velocity, LANE_IN(real3) momentum, LANE_IN(real) exchange, LANE_IN(real3) slip,
                           LANE_IN(real3) slip_across) {
  real per_whole = inverse(lit(1) + exchange);
  real3 right = (velocity + momentum) * per_whole, across = slip_across * (lit(0) - per_whole);
  real xx = lit(1) - slip.x * per_whole, yy = lit(1) - slip.y * per_whole, zz = lit(1) - slip.z * per_whole;
  real c_xx = yy * zz - across.x * across.x, c_yy = xx * zz - across.y * across.y, c_zz = xx * yy - across.z * across.z;
  real c_yz = across.y * across.z - xx * across.x, c_xz = across.x * across.z - yy * across.y,
       c_xy = across.x * across.y - zz * across.z;
  real per_determinant = inverse(xx * c_xx + across.z * c_xy + across.y * c_xz);
  return makeReal3(c_xx * right.x + c_xy * right.y + c_xz * right.z, c_xy * right.x + c_yy * right.y + c_yz * right.z,
                   c_xz * right.x + c_yz * right.y + c_zz * right.z) *
         per_determinant;
}

// Unit direction of a piece of a strand from its first vertex to its last; upright if both coincide.
LANE_FN real3 directionOfPiece(LANE_IN(real3) chord) {
  real3 some = chord + makeReal3(lit(0), lit(1e-12), lit(0));
  return some * inverse(sqrt(max(dot(some, some), lit(1e-30))));
}
// Part of the drag that a strand does not feel along itself: slender bodies have less drag along than across (Taylor
// 1952: about half). To be subtracted from a drag of rate x relative velocity; `less` = 1 - (along / across). It is
// evaluated once per step. The drag of the substeps also damps what it adds, so that at any rate its effect stays below
// the speed that it was evaluated from.
LANE_FN real3 slipDragLoss(LANE_IN(real3) relative, LANE_IN(real3) tangent, LANE_IN(real) rate, LANE_IN(real) less) {
  return tangent * (dot(relative, tangent) * rate * less);
}

// Fraction of a step by which hair positions are extrapolated with their velocities before they enter the grid. An
// acceleration that is constant over the step and evaluated at the present positions would amplify pressure waves.
LANE_FN real extrapolationShare() { return lit(0.5); }
// Pressure over density squared of hair denser than `rest`, as in smoothed particle hydrodynamics (Monaghan 1992):
// pressure = stiffness (density - rest). `stiffness`, m^2/s^2: squared speed of the pressure wave.
LANE_FN real crowding(LANE_IN(real) density, LANE_IN(real) rest, LANE_IN(real) stiffness) {
  real least = max(density, lit(1e-12));
  return stiffness * max(density - rest, lit(0)) * inverse(least * least);
}
// Additional pressure over density squared, the integral part of a controller. It grows while hair is denser than
// `rest` and shrinks while it is thinner. So permanent loads, such as the hair's own weight, are carried at rest
// density. gain = rate x time step; `most`: upper bound.
LANE_FN real heldCrowding(LANE_IN(real) held, LANE_IN(real) density, LANE_IN(real) rest, LANE_IN(real) stiffness,
                          LANE_IN(real) gain, LANE_IN(real) most) {
  real least = max(density, lit(1e-12));
  return clamp(madd(gain * stiffness, (density - rest) * inverse(least * least), held), lit(0), most);
}
// Greatest value of crowding() with a stiffness of 1 if hair alone has the density `own`: (d - rest) / d^2 has its
// maximum at d = 2 rest.
LANE_FN real largestCrowding(LANE_IN(real) rest, LANE_IN(real) own) {
  real density = max(own, rest + rest);
  return (density - rest) * inverse(density * density);
}
// Change of velocity along an axis by the pressure of hair. `crowding`: pressure over density squared, f, at the node;
// the other arguments are density and blurred mass x f before and after it; slope = - time step / (2 cell).
LANE_FN real pushAlong(LANE_IN(real) crowding, LANE_IN(real) density_before, LANE_IN(real) density_after,
                       LANE_IN(real) crowded_before, LANE_IN(real) crowded_after, LANE_IN(real) slope) {
  return slope * madd(crowding, density_after - density_before, crowded_after - crowded_before);
}
