// Kernel text: see kernels/README.md. Requires kernels/rotation.h.
//
// The curve of a drawn hair that is interpolated from guides. For scalar lanes only: it uses sines and cosines.

// Position on a guide between two of its vertices: a cubic Hermite curve from p0 to p1 with tangents m0 and m1 (m per
// unit of the knots). `h`: distance of the two knots; `s`: fraction of the interval, 0 to 1. Written relative to p0 to
// keep precision far from the origin.
LANE_FN real3 splinePosition(LANE_IN(real3) p0, LANE_IN(real3) p1, LANE_IN(real3) m0, LANE_IN(real3) m1, LANE_IN(real) h,
                             LANE_IN(real) s) {
  real s2 = s * s;
  real s3 = s2 * s;
  real3 bend = m0 * (s3 - lit(2) * s2 + s) + m1 * (s3 - s2);
  return p0 + (p1 - p0) * (lit(3) * s2 - lit(2) * s3) + bend * h;
}
// Derivative of splinePosition() by the knot parameter.
LANE_FN real3 splineDerivative(LANE_IN(real3) p0, LANE_IN(real3) p1, LANE_IN(real3) m0, LANE_IN(real3) m1, LANE_IN(real) h,
                               LANE_IN(real) s) {
  real s2 = s * s;
  real3 bend = m0 * (lit(3) * s2 - lit(4) * s + lit(1)) + m1 * (lit(3) * s2 - lit(2) * s);
  return (p1 - p0) * (lit(6) * (s - s2) / h) + bend;
}

// Reflects v in the plane with normal `across`; returns v if that has no length.
LANE_FN real3 mirrored(LANE_IN(real3) v, LANE_IN(real3) across) {
  real l2 = dot(across, across);
  mask tiny = l2 < lit(1e-16);
  return select(tiny, v, v - across * (lit(2) * dot(across, v) / select(tiny, lit(1), l2)));
}
// Unit normal of a rotation minimizing frame, carried along `step` from the unit tangent `last_tangent` to `tangent`,
// by double reflection (Wang, Juettler, Zheng, Liu 2008, "Computation of rotation minimizing frames"). Zero if it
// becomes parallel to the tangent.
LANE_FN real3 carriedNormal(LANE_IN(real3) normal, LANE_IN(real3) last_tangent, LANE_IN(real3) step, LANE_IN(real3) tangent) {
  real3 turned = mirrored(last_tangent, step);
  real3 n = mirrored(mirrored(normal, step), tangent - turned);
  return normalizeOrZero(n - tangent * dot(n, tangent));
}

// Bound hairs, which nodes of guides carry; BoundHairReference (groom/bound_growth.h) has the whole formula.
//
// Rotation of a node from rest. `last`: that of the node before it towards the root. The unit tangents are the node's.
// Rotates by the smallest angle more than `last`, which is how a rod's material frame moves while its twist strain does
// not change. The identity at rest, for curled guides too.
LANE_FN quat nodeRotation(LANE_IN(quat) last, LANE_IN(real3) rest_tangent, LANE_IN(real3) tangent) {
  return normalizeQuat(multiply(rotationBetween(rotate(last, rest_tangent), tangent), last));
}
// Share of its motion against its root that a guide keeps. `farthest`: distance, m, of the node that is farthest from
// where the root's motion carries it. Up to 0.02 mm the guide counts as at rest, so that a codec's error moves no hair at
// rest. From 0.1 mm on the share is 1. A node is at most 0.035 mm from its place, and moves at most twice as fast.
LANE_FN real motionShare(LANE_IN(real) farthest) {
  real t = clamp(farthest * lit(12500) - lit(0.25), lit(0), lit(1));
  return t * t * (lit(3) - lit(2) * t);
}
// Position of a node of a guide that keeps this share. `rest`: where the root's motion carries the node. `node` to the bit
// where the share is 1.
LANE_FN real3 settledNode(LANE_IN(real3) node, LANE_IN(real3) rest, LANE_IN(real) share) {
  return node + (rest - node) * (lit(1) - share);
}
// Place on a guide of a point at the fraction `along` of a bound hair's length, as a fraction of the guide's: at equal
// arc lengths, or at equal fractions where the guide is the shorter one. Lengths: m, at rest.
LANE_FN real placeOnGuide(LANE_IN(real) along, LANE_IN(real) hair_length, LANE_IN(real) guide_length) {
  return select(guide_length > hair_length, along * (hair_length / max(guide_length, lit(1e-9))), along);
}
// Position to which a node carries a point. `rest`: the point, `node_rest`: the node, both at rest.
LANE_FN real3 carriedPoint(LANE_IN(real3) node, LANE_IN(quat) rotation, LANE_IN(real3) node_rest, LANE_IN(real3) rest) {
  return node + rotate(rotation, rest - node_rest);
}

// Radius of a lock along its length u, 0 to 1: a quadratic Bezier curve over factors at root, middle and tip.
LANE_FN real lockRadius(LANE_IN(real3) profile, LANE_IN(real) u) {
  real v = lit(1) - u;
  return v * v * profile.x + lit(2) * u * v * profile.y + u * u * profile.z;
}
LANE_FN real lockRadiusSlope(LANE_IN(real3) profile, LANE_IN(real) u) {
  return lit(2) * ((lit(1) - u) * (profile.y - profile.x) + u * (profile.z - profile.y));
}

// Angle of a number of turns, radians, without whole turns.
LANE_FN real turnAngle(LANE_IN(real) turns) { return lit(6.283185307179586) * (turns - floor(turns + lit(0.5))); }

// Position of a hair in the twist-free frame of its first guide: along normal (x) and binormal (y), metres, and the
// derivatives by u, the fraction of the length from the root.
struct AcrossGuide {
  real x, y, slope_x, slope_y;
};
LANE_FN AcrossGuide turning(LANE_IN(real) turns, LANE_IN(real) per_u, LANE_IN(real) radius, LANE_IN(real) slope) {
  real angle = turnAngle(turns);
  real c = cos(angle);
  real s = sin(angle);
  real around = lit(6.283185307179586) * per_u * radius;
  AcrossGuide at;
  at.x = radius * c;
  at.y = radius * s;
  at.slope_x = slope * c - around * s;
  at.slope_y = slope * s + around * c;
  return at;
}
// Sum of three offsets. First, the position in the lock (`offset`, m, only x and y) times the lock's radius. Second, a
// curl: a helix of `curl_radius` (m) that widens from the root, with `curl_turns` over the whole length. Third,
// deviations: by `tip` (m), most of it in the last quarter, and by `whole` (m) everywhere but at the root. Both
// deviations rotate by one and a half turns over the length.
LANE_FN AcrossGuide hairAcross(LANE_IN(real) u, LANE_IN(real3) offset, LANE_IN(real3) profile, LANE_IN(real) tip,
                               LANE_IN(real) whole, LANE_IN(real) deviation_phase, LANE_IN(real) curl_radius,
                               LANE_IN(real) curl_turns, LANE_IN(real) curl_phase) {
  real opening = u * (lit(2) - u);
  real opening_slope = lit(2) - lit(2) * u;
  real u2 = u * u;
  real u5 = u2 * u2 * u;
  AcrossGuide strays = turning(deviation_phase + lit(1.5) * u, lit(1.5), tip * u5 * u + whole * opening,
                               lit(6) * tip * u5 + whole * opening_slope);
  AcrossGuide curl = turning(curl_phase + curl_turns * u, curl_turns, curl_radius * opening, curl_radius * opening_slope);
  real radius = lockRadius(profile, u);
  real slope = lockRadiusSlope(profile, u);
  AcrossGuide at;
  at.x = offset.x * radius + strays.x + curl.x;
  at.y = offset.y * radius + strays.y + curl.y;
  at.slope_x = offset.x * slope + strays.slope_x + curl.slope_x;
  at.slope_y = offset.y * slope + strays.slope_y + curl.slope_y;
  return at;
}

// Offset by a curl that is sampled from a strand (render/hair_growth.h). p0, p1: two samples (only x and y) with
// slopes m0, m1, at distance `h` in u; `s`: fraction of the interval; `scale`: m; `turns`: rotation about the guide.
LANE_FN AcrossGuide exampleAcross(LANE_IN(real3) p0, LANE_IN(real3) p1, LANE_IN(real3) m0, LANE_IN(real3) m1, LANE_IN(real) h,
                                  LANE_IN(real) s, LANE_IN(real) turns, LANE_IN(real) scale) {
  real3 place = splinePosition(p0, p1, m0, m1, h, s) * scale;
  real3 slope = splineDerivative(p0, p1, m0, m1, h, s) * scale;
  real angle = turnAngle(turns);
  real c = cos(angle);
  real n = sin(angle);
  AcrossGuide at;
  at.x = place.x * c - place.y * n;
  at.y = place.x * n + place.y * c;
  at.slope_x = slope.x * c - slope.y * n;
  at.slope_y = slope.x * n + slope.y * c;
  return at;
}
LANE_FN AcrossGuide bothAcross(LANE_IN(AcrossGuide) a, LANE_IN(AcrossGuide) b) {
  AcrossGuide at;
  at.x = a.x + b.x;
  at.y = a.y + b.y;
  at.slope_x = a.slope_x + b.slope_x;
  at.slope_y = a.slope_y + b.slope_y;
  return at;
}

// Share, 0 to 1, by which a hair follows only the first of its three guides, and its derivative by u: `clump` u, plus
// what bodies require beyond that (`bodies`, with its slope).
struct Closing {
  real part, slope;
};
LANE_FN Closing hairClosing(LANE_IN(real) u, LANE_IN(real) clump, LANE_IN(real) bodies, LANE_IN(real) bodies_slope) {
  real open = lit(1) - clump * u;
  Closing closing;
  closing.part = clump * u + open * bodies;
  closing.slope = clump * (lit(1) - bodies) + open * bodies_slope;
  return closing;
}

// Offset of a hair that follows one guide from a root `beside` that guide's root (m, only x and y). It closes in like
// hair between guides.
LANE_FN AcrossGuide besideGuide(LANE_IN(real3) beside, LANE_IN(Closing) closing) {
  real open = lit(1) - closing.part;
  AcrossGuide at;
  at.x = beside.x * open;
  at.y = beside.y * open;
  at.slope_x = -(beside.x * closing.slope);
  at.slope_y = -(beside.y * closing.slope);
  return at;
}

// Position of a hair at u. `a`: position of its first guide; `ab`, `ac`: vectors from there to the other two guides,
// with their weights.
LANE_FN real3 hairPosition(LANE_IN(real3) a, LANE_IN(real3) ab, LANE_IN(real3) ac, LANE_IN(real) weight_b, LANE_IN(real) weight_c,
                           LANE_IN(Closing) closing, LANE_IN(AcrossGuide) across, LANE_IN(real3) normal,
                           LANE_IN(real3) binormal) {
  real open = lit(1) - closing.part;
  return a + ab * (open * weight_b) + ac * (open * weight_c) + normal * across.x + binormal * across.y;
}
// Derivative of hairPosition() by u, without a part along the guide: a rotation minimizing frame rotates only about
// axes perpendicular to the tangent. `da`, `dab`, `dac`: derivatives of a, ab, ac.
LANE_FN real3 hairDerivative(LANE_IN(real3) da, LANE_IN(real3) dab, LANE_IN(real3) dac, LANE_IN(real3) ab, LANE_IN(real3) ac,
                             LANE_IN(real) weight_b, LANE_IN(real) weight_c, LANE_IN(Closing) closing,
                             LANE_IN(AcrossGuide) across, LANE_IN(real3) normal, LANE_IN(real3) binormal) {
  real open = lit(1) - closing.part;
  real3 spread = dab * (open * weight_b) + dac * (open * weight_c);
  real3 close = (ab * weight_b + ac * weight_c) * closing.slope;
  return da + spread - close + normal * across.slope_x + binormal * across.slope_y;
}

// Width of a hair over its full width at the fraction `along` of its length: 1 up to three quarters, then linear to 0
// at the tip.
LANE_FN real hairTaper(LANE_IN(real) along) { return clamp(lit(4) * (lit(1) - along), lit(0), lit(1)); }

// Clearance of a hair's vertex from bodies, m: `clear`, reduced within 1/20 of the length from the root to the root's
// own distance if that is less.
LANE_FN real keptDistance(LANE_IN(real) u, LANE_IN(real) root_distance, LANE_IN(real) clear) {
  real t = clamp(u * lit(20), lit(0), lit(1));
  return clear + (min(root_distance, clear) - clear) * (lit(1) - t * t * (lit(3) - lit(2) * t));
}

// A hair with a vertex inside a body follows one guide from there on, because guides do not enter bodies (Yuksel and
// Tariq 2010, "Advanced Techniques in Real-Time Hair Rendering and Simulation"). The transition is within `zone`, a
// fraction of the length, before that vertex. To avoid popping, closingAsked() rises linearly with the vertex's depth
// up to 2 mm; the maximum over all vertices counts. `ahead`: distance of the vertex along u, negative behind it.
LANE_FN real closingAsked(LANE_IN(real) depth) { return clamp(depth * lit(500), lit(0), lit(1)); }
LANE_FN real closingBefore(LANE_IN(real) asked, LANE_IN(real) ahead, LANE_IN(real) zone) {
  real t = clamp(lit(1) - ahead / zone, lit(0), lit(1));
  return asked * t * t * (lit(3) - lit(2) * t);
}
