// Kernel text: see kernels/README.md. Requires kernels/rotation.h.
//
// Signed distances to primitives, and the contact law of a vertex. Distances are in metres, negative inside; `normal`
// is a unit vector that points out of the body. docs/solver.md, "Contact", has the design.

LANE_FN real sphereDistance(LANE_IN(real3) p, LANE_IN(real3) centre, LANE_IN(real) radius, LANE_OUT(real3) normal) {
  real3 d = p - centre;
  real l = length(d);
  mask at_centre = l < lit(1e-12);
  real3 up = makeReal3(lit(0), lit(1), lit(0));
  normal = select(at_centre, up, d * inverse(select(at_centre, lit(1), l)));
  return l - radius;
}

// Capsule from a to b; with a = b a sphere. `along`: position of the nearest point on the axis, 0 at a to 1 at b.
LANE_FN real capsuleDistance(LANE_IN(real3) p, LANE_IN(real3) a, LANE_IN(real3) b, LANE_IN(real) radius, LANE_OUT(real3) normal,
                             LANE_OUT(real) along) {
  real3 axis = b - a;
  real l2 = dot(axis, axis);
  mask point = l2 < lit(1e-24);
  along = select(point, lit(0), clamp(dot(p - a, axis) / select(point, lit(1), l2), lit(0), lit(1)));
  return sphereDistance(p, madd(axis, along, a), radius, normal);
}

// Half space behind the plane through `point` with unit normal `n`.
LANE_FN real planeDistance(LANE_IN(real3) p, LANE_IN(real3) point, LANE_IN(real3) n, LANE_OUT(real3) normal) {
  normal = n;
  return dot(p - point, n);
}

// Convex hull of a ball of `radius` about a and one of `radius_b` about b (a round cone). If one ball contains the
// other, or a = b, it is the larger ball. The normal through p meets the axis at `along`, 0 at a to 1 at b; there it
// makes the cone's half angle with the plane across the axis.
LANE_FN real taperedCapsuleDistance(LANE_IN(real3) p, LANE_IN(real3) a, LANE_IN(real3) b, LANE_IN(real) radius,
                                    LANE_IN(real) radius_b, LANE_OUT(real3) normal, LANE_OUT(real) along) {
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

// Axis-aligned box about the origin; `extent`: half its edges.
LANE_FN real boxDistance(LANE_IN(real3) p, LANE_IN(real3) extent, LANE_OUT(real3) normal) {
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

// Axis-aligned ellipsoid about the origin; `extent`: its half axes, in a ratio of at most 100. The nearest point is
// extent^2 p / (extent^2 + t) with the t that puts it on the surface (Eberly, "Distance from a point to an ellipse, an
// ellipsoid, or a hyperellipsoid"). t is found by Newton's method on the reciprocal of the secular equation (More,
// Sorensen 1983), from below. Units are the shortest half axis; t is measured from its pole.
LANE_FN real ellipsoidDistance(LANE_IN(real3) p, LANE_IN(real3) extent, LANE_OUT(real3) normal) {
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

// A convex body is the intersection of half spaces with unit normals n_i at distances d_i from the origin. Call this
// for one plane after the other: `nearest` and `normal` belong to the plane of greatest distance so far; start with
// -1e9 and any normal. Exact inside and in front of faces; in front of edges and corners a lower bound.
LANE_FN void convexPlane(LANE_IN(real3) p, LANE_IN(real3) n, LANE_IN(real) d, LANE_INOUT(real) nearest,
                         LANE_INOUT(real3) normal) {
  real distance = dot(p, n) - d;
  mask nearer = distance > nearest;
  nearest = select(nearer, distance, nearest);
  normal = select(nearer, n, normal);
}

// Position, at the end of a substep, of a point of a rigid body; second order in the rotation. `a`: position of one
// point of the body at the end, `a_motion`: its displacement, `turn`: rotation vector about it, radians.
LANE_FN real3 carriedBy(LANE_IN(real3) point, LANE_IN(real3) a, LANE_IN(real3) a_motion, LANE_IN(real3) turn) {
  real3 arm = (point - a) + a_motion;
  return a + arm + cross(turn, madd(cross(turn, arm), lit(0.5), arm));
}

// `force` without its component along the normal.
LANE_FN real3 tangentialPart(LANE_IN(real3) force, LANE_IN(real3) normal) {
  return madd(normal, lit(0) - dot(force, normal), force);
}

// Contact margin, m: a body does not press hair that is farther from it than this.
LANE_FN real contactReach() { return lit(1e-3); }
// 1 on the surface and inside, falling linearly to 0 at contactReach().
LANE_FN real nearness(LANE_IN(real) gap) { return clamp(madd(gap, lit(-1e3), lit(1)), lit(0), lit(1)); }
// Reach of a contact query, m. A query from where a vertex would move without forces finds the bodies within this
// distance plus half of the vertex's displacement.
LANE_FN real queryReach() { return lit(2e-3); }
// The contact cache is stale if the vertex ends the substep farther than queryReach() from its query point. The
// resolution of penetration also queries again if the vertex is nearer than this to a contact plane, m.
LANE_FN real requeryMargin() { return lit(5e-4); }
// An eighth of the scalp's assumed radius of curvature R, m.
LANE_FN real scalpRadiusEighth() { return lit(0.0125); }
// Arc length, m, that a strand gets to leave a body in which its root is `root_depth` deeper than the root's clearance.
// For large depths 4 times the depth: twice the length at 60 degrees to the shortest way, because the first edges are
// stiff. For small depths more: if the shortest way leads into the scalp, the strand must run along the scalp, out of a
// flat body by sqrt(2 R depth).
LANE_FN real exitArcLength(LANE_IN(real) root_depth) {
  real depth = max(root_depth, lit(0));
  return lit(4) * sqrt(depth * (depth + scalpRadiusEighth()));
}
// Inverse of exitArcLength(): the depth, m, for this arc length.
LANE_FN real depthForExitArc(LANE_IN(real) arc_length) {
  return lit(0.5) *
         (sqrt(madd(arc_length * arc_length, lit(0.25), scalpRadiusEighth() * scalpRadiusEighth())) - scalpRadiusEighth());
}
// Clearance from that body of a vertex at this arc length from the root, m: `clear`, reduced where the strand is too
// short to have left the body.
LANE_FN real clearanceInReach(LANE_IN(real) clear, LANE_IN(real) root_depth, LANE_IN(real) arc_length) {
  return clear - max(exitArcLength(root_depth) - arc_length, lit(0)) * lit(0.5);
}
// Distance, m, by which two opposite planes with no room between them yield, so that the vertex ends in the middle. 0
// for planes whose normals are more than 37 degrees from opposite: the vertex can leave between those. Full from 26
// degrees on.
LANE_FN real pinch(LANE_IN(real) gap, LANE_IN(real3) normal, LANE_IN(real) other_gap, LANE_IN(real3) other_normal) {
  real facing = clamp(madd(dot(normal, other_normal), lit(-10), lit(-8)), lit(0), lit(1));
  return max(lit(0) - (gap + other_gap), lit(0)) * lit(0.5) * facing;
}
// Depth to which exact lengths may push hair into a body, m.
LANE_FN real contactSlack() { return lit(2e-5); }
// Share of a substep's force correction by which the kept contact force (warm start) follows. At rest the correction is
// zero. With a share of 1 an impact would be answered twice, by the surface and by the kept force, which adds energy.
LANE_FN real contactFollows() { return lit(0.5); }

// Position of a vertex after Coulomb friction has reduced its slip. `x`: position; `carried`: position at the end of
// the substep of the surface point that the vertex started from; `pressure`: normal force. Friction is at most friction
// x pressure and only removes slip. `drag`: friction that has acted already; `total`: all of it; `slides`: the limit is
// reached.
LANE_FN real3 withFriction(LANE_IN(real3) x, LANE_IN(real3) carried, LANE_IN(real3) normal, LANE_IN(real) pressure,
                           LANE_IN(real) friction, LANE_IN(real) weight, LANE_IN(real3) drag, LANE_OUT(real3) total,
                           LANE_OUT(mask) slides) {
  real3 slip = tangentialPart(x - carried, normal);
  real3 wanted = madd(slip, lit(0) - inverse(weight), drag);
  real amount = length(wanted), most = friction * pressure;
  slides = amount >= most;
  total = wanted * (most / select(slides, max(amount, lit(1e-30)), lit(1)));
  real taken = dot(drag - total, slip) * weight / max(dot(slip, slip), lit(1e-30));
  return madd(slip, lit(0) - select(slides, clamp(taken, lit(0), lit(1)), lit(1)), x);
}
// Projects `force` into the friction cone (Coulomb): normal forces only push, friction is at most friction x normal
// force.
LANE_FN real3 inFrictionCone(LANE_IN(real3) force, LANE_IN(real3) normal, LANE_IN(real) friction) {
  real3 along = tangentialPart(force, normal);
  real pressure = max(dot(force, normal), lit(0));
  return madd(normal, pressure, along * min(friction * pressure / max(length(along), lit(1e-30)), lit(1)));
}

// Contact of a single vertex at x, in units of length x mass (force x substep^2). `force`: contact force that has acted
// in this substep; on return the force to keep. The vertex is moved by what that force lacked. `gap`: m, negative
// inside; `carried`: as in withFriction().
LANE_FN real3 resolveContact(LANE_IN(real3) x, LANE_IN(real3) carried, LANE_IN(real3) normal, LANE_IN(real) gap,
                             LANE_IN(real) friction, LANE_IN(real) weight, LANE_INOUT(real3) force) {
  real mass = inverse(weight);
  real held = max(dot(force, normal), lit(0));
  real pressure = max(held - gap * mass, lit(0)), kept = max(held - max(gap, lit(0)) * mass, lit(0));
  real3 drag = tangentialPart(force, normal), total;
  mask slides;
  real3 out_x =
      withFriction(madd(normal, max(lit(0) - gap, lit(0)), x), carried, normal, pressure, friction, weight, drag, total, slides);
  real3 sliding = madd(normal, kept, total * (kept / max(pressure, lit(1e-30))));
  force = select(slides, sliding, inFrictionCone(madd(normal, kept, drag), normal, friction));
  return out_x;
}

// Contact of a vertex that is part of a bent strand, in two steps. First, positionOnSurface() is the position on the surface at
// which to hold the vertex. `force`: contact force of the last substep, which acts in this one; `moved`: displacement
// of x by forces. `follows`: share of the normal reaction that is kept for the next substep; `kept_friction`: friction that is
// kept. At rest both are complete. The impulse that stops the strand's own velocity is not kept: impacts are not
// warm-started.
LANE_FN real3 positionOnSurface(LANE_IN(real3) x, LANE_IN(real3) carried, LANE_IN(real3) moved, LANE_IN(real3) normal,
                                LANE_IN(real) gap, LANE_IN(real) friction, LANE_IN(real) weight, LANE_IN(real3) force,
                                LANE_OUT(real) follows, LANE_OUT(real3) kept_friction) {
  real mass = inverse(weight);
  follows = select(gap < lit(0), clamp(dot(moved, normal) * contactFollows() / min(gap, lit(-1e-12)), lit(0), lit(1)), lit(1));
  real3 drag = tangentialPart(force, normal), total;
  mask slides;
  real3 place = withFriction(madd(normal, lit(0) - gap, x), carried, normal, max(dot(force, normal) - gap * mass, lit(0)),
                             friction, weight, drag, total, slides);
  kept_friction = select(slides, total, madd(tangentialPart(moved, normal), lit(0) - mass * contactFollows(), drag));
  return place;
}
// Second, from the reaction of the bending system at the held vertices: a vertex whose contact force would pull is
// released, and the system is solved again without that force. This active-set iteration for the complementarity
// problem of the substep (Moreau) makes at most kActiveSetIterations solves. docs/solver.md (26), (27).
const int kActiveSetIterations = 8;
LANE_FN mask isReleased(LANE_IN(real3) force, LANE_IN(real3) reaction, LANE_IN(real3) normal) {
  return dot(force + reaction, normal) < lit(0);
}
// A vertex that is not held and moves deeper than its position on the surface becomes held.
LANE_FN mask becomesHeld(LANE_IN(real3) push, LANE_IN(real3) moved, LANE_IN(real3) normal) {
  return dot(moved - push, normal) < lit(-1e-7);
}
// Contact force of a held vertex to keep for the next substep, docs/solver.md (28).
LANE_FN real3 heldForce(LANE_IN(real3) force, LANE_IN(real3) reaction, LANE_IN(real) follows, LANE_IN(real3) kept_friction,
                        LANE_IN(real3) normal, LANE_IN(real) friction) {
  return inFrictionCone(madd(normal, dot(madd(reaction, follows, force), normal), kept_friction), normal, friction);
}

// End of an edge from `inner` to x after a rotation towards the nearest point of a contact plane; x is behind it
// (`gap` < 0). A small gap never gives a large rotation.
LANE_FN real3 rotatedTowardsPlane(LANE_IN(real3) x, LANE_IN(real3) inner, LANE_IN(real3) normal, LANE_IN(real) gap,
                                  LANE_IN(real) edge_length) {
  return madd(directionOr(madd(normal, lit(0) - gap, x) - inner, normal), edge_length, inner);
}
// Gap that rotatedOntoPlane() removes from ends that are still inside after two rotations by rotatedTowardsPlane(). The decision
// uses the least deep of x, the carried point and the inner end: the whole gap down to a depth of 2 mm, none from 3 mm
// on. Otherwise rounding would decide to which side a deep end on a deep inner end jumps.
LANE_FN real gapToRemove(LANE_IN(real3) x, LANE_IN(real3) inner, LANE_IN(real3) carried, LANE_IN(real3) normal,
                         LANE_IN(real) gap) {
  real least = gap + max(max(dot(normal, carried - x), dot(normal, inner - x)), lit(0));
  return gap * clamp(madd(least, lit(1e3), lit(3)), lit(0), lit(1));
}
// Outer end of an edge from `inner` to x that is `gap` < 0 behind the plane with unit normal `normal`: the edge rotated
// until its end lies in the plane, or as far out as its length allows.
LANE_FN real3 rotatedOntoPlane(LANE_IN(real3) x, LANE_IN(real3) inner, LANE_IN(real3) normal, LANE_IN(real) gap,
                               LANE_IN(real) edge_length) {
  real3 edge = x - inner;
  real rise = clamp((dot(edge, normal) - gap) * inverse(max(edge_length, lit(1e-12))), lit(-1), lit(1));
  real3 across = select(abs(normal.x) < lit(0.7), makeReal3(lit(0), normal.z, lit(0) - normal.y),
                        makeReal3(normal.y, lit(0) - normal.x, lit(0)));
  real3 along = directionOr(tangentialPart(edge, normal), across * inverseSqrt(dot(across, across)));
  return madd(madd(normal, rise, along * sqrt(max(lit(1) - rise * rise, lit(0)))), edge_length, inner);
}
// Same for two planes, which alternating rotations may never satisfy together: the end lies in both planes, on the side
// along their crease where it is now. If the edge is too short for that, the end remains inside both in proportion to
// the rises that they ask for.
LANE_FN real3 rotatedIntoCrease(LANE_IN(real3) x, LANE_IN(real3) inner, LANE_IN(real3) first_carried, LANE_IN(real3) first,
                                LANE_IN(real) first_gap, LANE_IN(real3) second_carried, LANE_IN(real3) second,
                                LANE_IN(real) second_gap, LANE_IN(real) edge_length) {
  real3 edge = x - inner;
  real first_deep = min(first_gap, lit(0)), second_deep = min(second_gap, lit(0));
  real per_length = inverse(max(edge_length, lit(1e-12)));
  real first_rise = first_deep - gapToRemove(x, inner, first_carried, first, first_deep) - first_gap + dot(first, edge);
  real second_rise = second_deep - gapToRemove(x, inner, second_carried, second, second_deep) - second_gap + dot(second, edge);
  real c = dot(first, second);
  real per_part = per_length * inverse(max(lit(1) - c * c, lit(1e-3)));
  real3 across = madd(first, (first_rise - c * second_rise) * per_part, second * ((second_rise - c * first_rise) * per_part));
  real3 crease = normalizeOrZero(cross(first, second));
  real along = sqrt(max(lit(1) - dot(across, across), lit(0)));
  real3 way = madd(crease, select(dot(edge, crease) < lit(0), lit(0) - along, along), across);
  return madd(directionOr(way, edge * per_length), edge_length, inner);
}
