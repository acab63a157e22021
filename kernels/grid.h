// Kernel text: see kernels/README.md. Air and hair on regular grids. Places are in cells: node i of an axis is at i. The wind
// is staggered (Harlow and Welch 1965): component a is known in the middle of the faces across axis a, and face i lies before
// cell i, so that places of every array are its own indices.

// Where a point lies among nodes 0 .. last of each axis; beyond them it is that of the nearest point.
struct GridPlace {
  real3 low;   // node before it, whole numbers
  real3 part;  // way to the next node, 0 to 1
};
FN GridPlace gridPlace(IN(real3) at, IN(real3) last) {
  real3 in_grid = makeReal3(clamp(at.x, lit(0), last.x), clamp(at.y, lit(0), last.y), clamp(at.z, lit(0), last.z));
  GridPlace place;
  place.low = makeReal3(min(floor(in_grid.x), last.x - lit(1)), min(floor(in_grid.y), last.y - lit(1)),
                        min(floor(in_grid.z), last.z - lit(1)));
  place.part = in_grid - place.low;
  return place;
}

// Trilinear interpolation between eight corners (vXYZ). The weights of `splatWeight` are the same.
FN real interpolated(IN(real) v000, IN(real) v100, IN(real) v010, IN(real) v110, IN(real) v001, IN(real) v101,
                     IN(real) v011, IN(real) v111, IN(real3) part) {
  real v00 = madd(v100 - v000, part.x, v000);
  real v10 = madd(v110 - v010, part.x, v010);
  real v01 = madd(v101 - v001, part.x, v001);
  real v11 = madd(v111 - v011, part.x, v011);
  real v0 = madd(v10 - v00, part.y, v00);
  real v1 = madd(v11 - v01, part.y, v01);
  return madd(v1 - v0, part.z, v0);
}
// Share of the corner (cx, cy, cz), each 0 or 1, in what lies at `part`.
FN real splatWeight(IN(real3) part, IN(real) cx, IN(real) cy, IN(real) cz) {
  real x = madd(cx, part.x + part.x - lit(1), lit(1) - part.x);
  real y = madd(cy, part.y + part.y - lit(1), lit(1) - part.y);
  real z = madd(cz, part.z + part.z - lit(1), lit(1) - part.z);
  return x * y * z;
}
// From the world's axes to those of the box of turbulence, and back: half a turn about (2, 3, 7). Wind along an axis of the box would bring
// the same again after one length of it, and eddies that lie along that axis would stand still in it.
FN real3 turnedToBox(IN(real3) v) {
  real by = (lit(2) * v.x + lit(3) * v.y + lit(7) * v.z) * lit(1.0 / 31);
  return makeReal3(lit(2) * by - v.x, lit(3) * by - v.y, lit(7) * by - v.z);
}
// One axis of a blur by (1 2 1) / 4.
FN real blurred(IN(real) before, IN(real) here, IN(real) after) {
  return madd(before + after, lit(0.25), here * lit(0.5));
}
// To whole numbers, so that sums do not depend on their order.
FN real fixedPoint(IN(real) value) { return floor(value + lit(0.5)); }

// Semi-Lagrangian advection (Stam 1999, "Stable Fluids", section 3.2): where what is at `at` now was. `courant`: time step
// over cell, s/m.
FN real3 tracedBack(IN(real3) at, IN(real3) velocity, IN(real) courant) { return madd(velocity, lit(0) - courant, at); }
// MacCormack's correction (Selle, Fedkiw, Kim, Liu, Rossignac 2008, "An Unconditionally Stable MacCormack Method"): `ahead`
// advected once, `was` before it, `back` advected forth and back; limited to the values it was taken from.
FN real macCormack(IN(real) ahead, IN(real) was, IN(real) back, IN(real) low, IN(real) high) {
  return clamp(madd(was - back, lit(0.5), ahead), low, high);
}

// What flows out of a cell through its six faces, times the cell, m/s.
FN real outflow(IN(real) x0, IN(real) x1, IN(real) y0, IN(real) y1, IN(real) z0, IN(real) z1) {
  return (x1 - x0) + (y1 - y0) + (z1 - z0);
}
// A cell's share of what a sphere of wind lets out, by how far (in cells) its middle is from the sphere's: even within, so that its air
// speeds up evenly from the middle to the surface; where the surface passes, as far as it passes, so that a sphere that moves does not come
// to a cell all at once. To be scaled to the flow 4 pi radius^2 speed.
FN real sphereShare(IN(real) far, IN(real) radius) { return clamp(radius - far + lit(0.5), lit(0), lit(1)); }
// Exchange of momentum (rate x time step) of a cell with an outflow that is wanted there: what is let out comes without momentum and takes the
// place of so much of the air. courant: time step over cell, s/m.
FN real sphereExchange(IN(real) wanted, IN(real) courant) { return max(wanted, lit(0)) * courant; }
// A face's velocity less the gradient of the pressure, which is in m/s (pressure x time step / (density x cell)). open: 1,
// or 0 at solids.
FN real lessGradient(IN(real) velocity, IN(real) open, IN(real) before, IN(real) after) {
  return madd(open, before - after, velocity);
}

// Velocity of air that exchanges momentum with what moves at `other`, implicitly: `exchange` = rate x time step.
FN real draggedTo(IN(real) velocity, IN(real) other, IN(real) exchange) {
  return madd(exchange, other, velocity) * inverse(lit(1) + exchange);
}

// The same in hair that holds air back less along itself (dragNotFelt), which couples the components: `momentum` is exchange x other of all that
// air is drawn to. Of the exchange `slip` is not there, the mean of less t t' over the directions t of the hair, by its part of the exchange:
// xx, yy, zz; `slip_across`: yz, xz, xy. Solves (1 + exchange - slip) u = velocity + momentum, by cofactors.
FN real3 draggedAmong(IN(real3) velocity, IN(real3) momentum, IN(real) exchange, IN(real3) slip, IN(real3) slip_across) {
  real per_whole = inverse(lit(1) + exchange);
  real3 right = (velocity + momentum) * per_whole, across = slip_across * (lit(0) - per_whole);
  real xx = lit(1) - slip.x * per_whole, yy = lit(1) - slip.y * per_whole, zz = lit(1) - slip.z * per_whole;
  real c_xx = yy * zz - across.x * across.x, c_yy = xx * zz - across.y * across.y, c_zz = xx * yy - across.z * across.z;
  real c_yz = across.y * across.z - xx * across.x, c_xz = across.x * across.z - yy * across.y, c_xy = across.x * across.y - zz * across.z;
  real per_determinant = inverse(xx * c_xx + across.z * c_xy + across.y * c_xz);
  return makeReal3(c_xx * right.x + c_xy * right.y + c_xz * right.z, c_xy * right.x + c_yy * right.y + c_yz * right.z,
                   c_xz * right.x + c_yz * right.y + c_zz * right.z) * per_determinant;
}

// Direction of a piece of a strand, from its first vertex to its last; upright where both are at one place.
FN real3 directionOfPiece(IN(real3) chord) {
  real3 some = chord + makeReal3(lit(0), lit(1e-12), lit(0));
  return some * inverse(sqrt(max(dot(some, some), lit(1e-30))));
}
// Slender bodies feel less drag along themselves than across (Taylor 1952: about half). What is to be taken from a drag of
// rate x relative: its part along the strand, `less` = 1 - (along / across). It is found once a step, but what it adds meanwhile the
// drag itself, in every substep, takes: at any rate no more is left than the speed that it was found from.
FN real3 dragNotFelt(IN(real3) relative, IN(real3) tangent, IN(real) rate, IN(real) less) {
  return tangent * (dot(relative, tangent) * rate * less);
}

// Hair is looked at where it will be this part of a step from now, if it goes on as it goes. An acceleration that is constant over the step
// would feed waves of pressure if it came from where hair is.
FN real partAhead() { return lit(0.5); }
// Pressure over density squared of hair that is denser than `rest`, as smoothed particles use it (Monaghan 1992): pressure =
// stiffness (density - rest). stiffness in m^2/s^2 is the speed squared of the wave that it makes.
FN real crowding(IN(real) density, IN(real) rest, IN(real) stiffness) {
  real least = max(density, lit(1e-12));
  return stiffness * max(density - rest, lit(0)) * inverse(least * least);
}
// What is pushed with beyond that: it grows while hair is denser than `rest` and shrinks while it is thinner, so that what
// must be carried all the time, as hair's own weight, is carried at the rest density (the integral part of a controller).
// gain = rate x time step.
FN real heldCrowding(IN(real) held, IN(real) density, IN(real) rest, IN(real) stiffness, IN(real) gain, IN(real) most) {
  real least = max(density, lit(1e-12));
  return clamp(madd(gain * stiffness, (density - rest) * inverse(least * least), held), lit(0), most);
}
// The most that crowding comes to with a stiffness of 1 where hair alone makes a density `own`: (d - rest) / d^2 has its top
// at d = 2 rest.
FN real largestCrowding(IN(real) rest, IN(real) own) {
  real density = max(own, rest + rest);
  return (density - rest) * inverse(density * density);
}
// Change of velocity along an axis by a push f of hair with f = `crowding` at the node, from the densities and the blurred
// mass x f before and after it; slope = - time step / (2 cell).
FN real pushAlong(IN(real) crowding, IN(real) density_before, IN(real) density_after, IN(real) crowded_before,
                  IN(real) crowded_after, IN(real) slope) {
  return slope * madd(crowding, density_after - density_before, crowded_after - crowded_before);
}
