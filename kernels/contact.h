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

// Where a rigid body takes a point of it in a substep, to second order: to `a`, where one of its points is at the end, after
// `a_motion`, turned about it by `turn` (radians along the axis).
FN real3 carriedBy(IN(real3) point, IN(real3) a, IN(real3) a_motion, IN(real3) turn) {
  real3 arm = (point - a) + a_motion;
  return a + arm + cross(turn, madd(cross(turn, arm), lit(0.5), arm));
}

// `force` without what goes along the normal.
FN real3 tangentialPart(IN(real3) force, IN(real3) normal) { return madd(normal, lit(0) - dot(force, normal), force); }

// Hair farther from a body than this, in metres, is not pressed by it any more.
FN real contactReach() { return lit(1e-3); }
// From 0 there to 1 in the body.
FN real nearness(IN(real) gap) { return clamp(madd(gap, lit(-1e3), lit(1)), lit(0), lit(1)); }
// Bodies that are nearer than this to where a vertex would go by itself, or that and half of its way, are heeded in the substep.
FN real lookReach() { return lit(2e-3); }
// A vertex that ends the substep farther than lookReach() from where it looked, or less than this from a plane that it keeps, looks
// once more.
FN real lookMargin() { return lit(5e-4); }
// An eighth of the radius R of a head, m.
FN real headEighth() { return lit(0.0125); }
// Arc length, m, that a strand gets to come out of a body in which its root is `root_depth` deeper than the root's clearance asks. Of great
// depths four times as much: twice what it would take at 60 degrees to the shortest way, for its first edges are stiff. Of small ones more:
// where the shortest way leads into the scalp it has to go along there, out of a flat body by sqrt(2 R depth).
FN real wayOutOf(IN(real) root_depth) {
  real depth = max(root_depth, lit(0));
  return lit(4) * sqrt(depth * (depth + headEighth()));
}
// The depth that has this way out.
FN real depthOfWayOut(IN(real) arc_length) {
  return lit(0.5) * (sqrt(madd(arc_length * arc_length, lit(0.25), headEighth() * headEighth())) - headEighth());
}
// How far from that body a vertex is kept at this arc length from the root, m: by `clear`, or by what it can be.
FN real clearanceInReach(IN(real) clear, IN(real) root_depth, IN(real) arc_length) {
  return clear - max(wayOutOf(root_depth) - arc_length, lit(0)) * lit(0.5);
}
// What presses a vertex from two sides and leaves no room between has to give way at either by this, m, for the vertex to be in the middle.
// Of planes that meet at more than 37 degrees nothing: out between them it can get.
FN real pinch(IN(real) gap, IN(real3) normal, IN(real) other_gap, IN(real3) other_normal) {
  real facing = clamp(madd(dot(normal, other_normal), lit(-10), lit(-8)), lit(0), lit(1));
  return max(lit(0) - (gap + other_gap), lit(0)) * lit(0.5) * facing;
}
// By how much making lengths exact may press hair into a body, metres.
FN real contactSlack() { return lit(2e-5); }
// The part of what forces did to a vertex in a substep by which its kept contact force follows. At rest that is nothing;
// with all of it a blow would be answered twice, by the surface and by the force, which adds energy.
FN real contactFollows() { return lit(0.5); }

// What Coulomb's law leaves of the slip of a vertex at x, which started out at `carried` and is pressed with `pressure`: its new place.
// Friction is at most friction x pressure and only takes back slip. `drag`: the friction that has acted already, `total`: all of it.
FN real3 withFriction(IN(real3) x, IN(real3) carried, IN(real3) normal, IN(real) pressure, IN(real) friction, IN(real) weight,
                      IN(real3) drag, OUT(real3) total, OUT(mask) slides) {
  real3 slip = tangentialPart(x - carried, normal);
  real3 wanted = madd(slip, lit(0) - inverse(weight), drag);
  real amount = length(wanted), most = friction * pressure;
  slides = amount >= most;
  total = wanted * (most / select(slides, max(amount, lit(1e-30)), lit(1)));
  real taken = dot(drag - total, slip) * weight / max(dot(slip, slip), lit(1e-30));
  return madd(slip, lit(0) - select(slides, clamp(taken, lit(0), lit(1)), lit(1)), x);
}
// `force` where Coulomb's law allows it: normal forces only push, friction is at most friction x normal force.
FN real3 inFrictionCone(IN(real3) force, IN(real3) normal, IN(real) friction) {
  real3 along = tangentialPart(force, normal);
  real pressure = max(dot(force, normal), lit(0));
  return madd(normal, pressure, along * min(friction * pressure / max(length(along), lit(1e-30)), lit(1)));
}

// Contact of a vertex at x by itself, in units of length x mass (force x substep^2). `force` is what the body presses it with; the vertex
// is moved by what that was too little. `gap` < 0 is depth. `carried`: where the surface has taken the point at which the vertex was.
FN real3 resolveContact(IN(real3) x, IN(real3) carried, IN(real3) normal, IN(real) gap, IN(real) friction, IN(real) weight,
                        INOUT(real3) force) {
  real mass = inverse(weight);
  real held = max(dot(force, normal), lit(0));
  real pressure = max(held - gap * mass, lit(0)), kept = max(held - max(gap, lit(0)) * mass, lit(0));
  real3 drag = tangentialPart(force, normal), total;
  mask slides;
  real3 out_x = withFriction(madd(normal, max(lit(0) - gap, lit(0)), x), carried, normal, pressure, friction, weight, drag, total, slides);
  real3 sliding = madd(normal, kept, total * (kept / max(pressure, lit(1e-30))));
  force = select(slides, sliding, inFrictionCone(madd(normal, kept, drag), normal, friction));
  return out_x;
}

// Contact of a vertex that is part of a bent strand, in two steps. First, where it is to be held: on the surface. `force` has pressed it
// in the last substep and acts in this one; `moved` is how far forces have moved x. `follows`: the part of the normal reaction that is
// kept for the next substep, `rubs`: the friction that is. At rest that is all of it; what the strand's own speed called for is over with
// the substep.
FN real3 heldPlace(IN(real3) x, IN(real3) carried, IN(real3) moved, IN(real3) normal, IN(real) gap, IN(real) friction, IN(real) weight,
                   IN(real3) force, OUT(real) follows, OUT(real3) rubs) {
  real mass = inverse(weight);
  follows = select(gap < lit(0), clamp(dot(moved, normal) * contactFollows() / min(gap, lit(-1e-12)), lit(0), lit(1)), lit(1));
  real3 drag = tangentialPart(force, normal), total;
  mask slides;
  real3 place = withFriction(madd(normal, lit(0) - gap, x), carried, normal, max(dot(force, normal) - gap * mass, lit(0)), friction, weight,
                             drag, total, slides);
  rubs = select(slides, total, madd(tangentialPart(moved, normal), lit(0) - mass * contactFollows(), drag));
  return place;
}
// Then, from the reaction of the bending system to all that are held: who pulls at the body is let go, and the system solved again so
// without its force, at most so many times in all.
const int kHoldRounds = 8;
FN mask letsGo(IN(real3) force, IN(real3) reaction, IN(real3) normal) { return dot(force + reaction, normal) < lit(0); }
// One that is not held and gets deeper than where it would be is held after all.
FN mask isPushed(IN(real3) push, IN(real3) moved, IN(real3) normal) { return dot(moved - push, normal) < lit(0) - lit(1e-7); }
// The force that is kept of one that is held.
FN real3 heldForce(IN(real3) force, IN(real3) reaction, IN(real) follows, IN(real3) rubs, IN(real3) normal, IN(real) friction) {
  return inFrictionCone(madd(normal, dot(madd(reaction, follows, force), normal), rubs), normal, friction);
}

// An edge from `inner` to x, `gap` < 0 behind the plane across `normal`, turned towards where the nearest point of that plane is:
// its new end. Never turns by much for little.
FN real3 turnedTowards(IN(real3) x, IN(real3) inner, IN(real3) normal, IN(real) gap, IN(real) edge_length) {
  return madd(directionOr(madd(normal, lit(0) - gap, x) - inner, normal), edge_length, inner);
}
// Ends that are still in the body after two of these turns go on with turnedOut(). This is the gap to take away: what counts is the
// least deep of x, of where the end was before the substep (`carried`) and of the inner end; all of it to 2 mm, none from 3 mm on.
// Who is deep and hangs on who is deep would be thrown to either side for the last bit.
FN real lastTurn(IN(real3) x, IN(real3) inner, IN(real3) carried, IN(real3) normal, IN(real) gap) {
  real least = gap + max(max(dot(normal, carried - x), dot(normal, inner - x)), lit(0));
  return gap * clamp(madd(least, lit(1e3), lit(3)), lit(0), lit(1));
}
// The outer end x of an edge that starts at `inner`, when it is `gap` < 0 behind the plane across the unit `normal`: the edge
// turned until the end is in the plane, or as far out as its length allows.
FN real3 turnedOut(IN(real3) x, IN(real3) inner, IN(real3) normal, IN(real) gap, IN(real) edge_length) {
  real3 edge = x - inner;
  real rise = clamp((dot(edge, normal) - gap) * inverse(max(edge_length, lit(1e-12))), lit(-1), lit(1));
  real3 across = select(abs(normal.x) < lit(0.7), makeReal3(lit(0), normal.z, lit(0) - normal.y),
                        makeReal3(normal.y, lit(0) - normal.x, lit(0)));
  real3 along = directionOr(tangentialPart(edge, normal), across * inverseSqrt(dot(across, across)));
  return madd(madd(normal, rise, along * sqrt(max(lit(1) - rise * rise, lit(0)))), edge_length, inner);
}
// The same behind two planes, which turning it out of one after the other may never leave: its end in both, on the side along
// their crease where it is now; where its length does not reach that, as much too deep in either as they ask of it.
FN real3 turnedIntoCrease(IN(real3) x, IN(real3) inner, IN(real3) first_carried, IN(real3) first, IN(real) first_gap,
                          IN(real3) second_carried, IN(real3) second, IN(real) second_gap, IN(real) edge_length) {
  real3 edge = x - inner;
  real first_deep = min(first_gap, lit(0)), second_deep = min(second_gap, lit(0));
  real per_length = inverse(max(edge_length, lit(1e-12)));
  real first_rise = first_deep - lastTurn(x, inner, first_carried, first, first_deep) - first_gap + dot(first, edge);
  real second_rise = second_deep - lastTurn(x, inner, second_carried, second, second_deep) - second_gap + dot(second, edge);
  real c = dot(first, second);
  real per_part = per_length * inverse(max(lit(1) - c * c, lit(1e-3)));
  real3 across = madd(first, (first_rise - c * second_rise) * per_part, second * ((second_rise - c * first_rise) * per_part));
  real3 crease = normalizeOrZero(cross(first, second));
  real along = sqrt(max(lit(1) - dot(across, across), lit(0)));
  real3 way = madd(crease, select(dot(edge, crease) < lit(0), lit(0) - along, along), across);
  return madd(directionOr(way, edge * per_length), edge_length, inner);
}
