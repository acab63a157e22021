// Kernel text: see kernels/README.md. Requires kernels/rotation.h.
//
// A strand as an inextensible Kirchhoff rod (Bergou et al. 2008, "Discrete Elastic Rods"; Kugelstadt and Schoemer 2016,
// "Position and Orientation Based Cosserat Rods"). docs/solver.md derives the equations that comments here cite by
// number.
//
// Notation: edge e has the unit tangent t_e and the material frame q_e (body z axis = t_e). Joint j is between edges
// j - 1 and j; joint 0 is between the root frame and edge 0. All masses and stiffnesses of a strand are divided by one
// reference mass, so that units are metres and seconds. A parameter `time2` is, unless stated otherwise,
// DragStep::time2 in s^2: the displacement that an acceleration of 1 m/s^2 gives in the substep (dt^2 without air
// drag).
//
// The functions straight...() at the end are for joints of a strand that is straight at rest, has no pin but the root
// and carries no material frames. Such a strand bends alike in every direction. Twist has no inertia, so its frames
// would follow the strand without twist, except for internal damping. Results equal those of the functions before them,
// which work in the frame of the joint's inner edge; there all vectors are in the world frame. t_in, t: unit tangents of
// the inner and the outer edge; swing_in, swing: their changes in the substep, perpendicular to them.

// Tangent of a material frame: its z axis.
LANE_FN real3 frameTangent(LANE_IN(quat) q) {
  return makeReal3(lit(2) * madd(q.x, q.z, q.w * q.y), lit(2) * madd(q.y, q.z, lit(0) - q.w * q.x),
                   lit(1) - lit(2) * madd(q.x, q.x, q.y * q.y));
}

// Moves the frame q of an edge, whose tangent is `tangent`, to the unit vector t by parallel transport (no twist).
LANE_FN quat transportTo(LANE_IN(quat) q, LANE_IN(real3) tangent, LANE_IN(real3) t) {
  return multiply(rotationBetween(tangent, t), q);
}

// Cosine of half the angle of a joint whose frames differ by the rotation p. Clamped near a full fold, where the strain
// would grow without bound.
LANE_FN real cappedCosine(LANE_IN(quat) p) { return max(abs(p.w), lit(0.2)); }

// Strain (Darboux vector) of the joint between frames a and b, in frame a: bending (x, y) and twist (z), 2
// tan(theta / 2) along the axis of the rotation from a to b. It stays finite up to a full fold (cappedCosine), so that
// a fold always pushes back. docs/solver.md (1).
LANE_FN real3 jointStrain(LANE_IN(quat) a, LANE_IN(quat) b) {
  quat p = multiply(conjugate(a), b);
  real w = lit(2) * inverse(cappedCosine(p));
  real s = select(p.w < lit(0), -w, w);
  return makeReal3(p.x * s, p.y * s, p.z * s);
}

// Moment of a joint on its outer edge, world: gradient of the elastic energy to a rotation of that edge. `strain`: see
// jointStrain(); `excess`: strain less rest strain; `bend`, `twist`: stiffness in m^2/s^2. docs/solver.md (11).
LANE_FN real3 jointMoment(LANE_IN(quat) a, LANE_IN(real3) strain, LANE_IN(real3) excess, LANE_IN(real) bend,
                          LANE_IN(real) twist) {
  real3 c = makeReal3(bend * excess.x, bend * excess.y, twist * excess.z);
  return rotate(a, madd(cross(strain, c), lit(0.5), c));
}

// Rotation of frame b against frame a about their common tangent, radians; small.
LANE_FN real spinBetween(LANE_IN(quat) a, LANE_IN(quat) b) { return clamp(jointStrain(a, b).z, lit(-1), lit(1)); }
// Rotation vector of an edge in a substep without twist, radians, in its own frame q. `advance`: displacement of its
// outer end relative to the inner one, over the edge's length.
LANE_FN real3 turningOf(LANE_IN(quat) q, LANE_IN(real3) advance) {
  real3 own = rotateBack(q, advance);
  return makeReal3(lit(0) - own.y, own.x, lit(0));
}
// Bending strain that a joint gains when its edges rotate by `turned_in` and `turned`, radians, each in its own frame.
// Internal (Kelvin-Voigt) damping adds to the strain what it gains in the damping time. jointMoment() is the transpose
// of this map. So damping dissipates the energy of motions that bend hair and of no others. Twist is not damped: it has
// no inertia here.
LANE_FN real3 gainedStrain(LANE_IN(real3) strain, LANE_IN(real3) turned_in, LANE_IN(real3) turned) {
  real3 more = turned - turned_in, sum = (turned + turned_in) * lit(0.5);
  return makeReal3(more.x + (strain.y * sum.z - strain.z * sum.y), more.y + (strain.z * sum.x - strain.x * sum.z), lit(0));
}

// Returns d: the torque of a joint about its inner edge's tangent is twist excess.z + d, about its outer edge's tangent
// twist excess.z - d. docs/solver.md (9).
LANE_FN real torqueDifference(LANE_IN(real3) strain, LANE_IN(real3) excess, LANE_IN(real) bend) {
  return lit(0.5) * bend * (strain.x * excess.y - strain.y * excess.x);
}
// Returns a, which bending adds to the stiffness of twist. If one edge of a joint rotates by phi about its tangent, its
// own torque changes by (twist + a) phi. The torque of the other edge changes by (a - twist) phi. Without terms in
// strain.z; clamped to 0 or more. docs/solver.md (9), (10).
LANE_FN real twistOfBending(LANE_IN(real3) strain, LANE_IN(real3) excess, LANE_IN(real) bend) {
  real3 rest = strain - excess;
  return max(lit(0.25) * bend * madd(strain.x, rest.x, strain.y * rest.y), lit(0));
}
// The same contribution by internal damping. `ahead`: the damping time in substeps.
LANE_FN real twistOfDamping(LANE_IN(real3) strain, LANE_IN(real) bend, LANE_IN(real) ahead) {
  return lit(0.25) * bend * ahead * madd(strain.x, strain.x, strain.y * strain.y);
}
// Strain of a joint after its inner and outer edge have rotated about their tangents by phi_in and phi (radians,
// small).
LANE_FN real3 twistedStrain(LANE_IN(real3) strain, LANE_IN(real) phi_in, LANE_IN(real) phi) {
  real mean = lit(0.5) * (phi_in + phi);
  return makeReal3(madd(strain.y, mean, strain.x), madd(lit(0) - strain.x, mean, strain.y), strain.z + phi - phi_in);
}
// `excess` plus internal damping. `gained`: bending strain gained in the substep without twist; strain less untwisted:
// gained by twist; `ahead`: the damping time in substeps.
LANE_FN real3 dampedExcess(LANE_IN(real3) excess, LANE_IN(real3) gained, LANE_IN(real3) untwisted, LANE_IN(real3) strain,
                           LANE_IN(real) ahead) {
  real3 by_twist = strain - untwisted;
  return makeReal3(madd(gained.x + by_twist.x, ahead, excess.x), madd(gained.y + by_twist.y, ahead, excess.y), excess.z);
}

// Frame rotated about its own tangent by the small angle phi, radians.
LANE_FN quat twistFrame(LANE_IN(quat) q, LANE_IN(real) phi) {
  real h = phi * lit(0.5);
  return normalizeQuat(makeQuat(madd(q.y, h, q.x), madd(lit(0) - q.x, h, q.y), madd(q.w, h, q.z), madd(lit(0) - q.z, h, q.w)));
}

// Whether a strand has an edge much shorter than its mean edge. All edges of such a strand take the time blend of the
// stiffest edge. With less blend on a short edge than on its neighbours, the strand gained energy and never came to
// rest.
LANE_FN mask isCutUnevenly(LANE_IN(real) shortest, LANE_IN(real) mean) { return shortest < lit(0.5) * mean; }

// Stiffness ratio of an edge: its bending stiffness against the inertia of its outer vertex, kappa = time2 bend / (mass
// length^2). docs/solver.md (6).
LANE_FN real stiffnessOf(LANE_IN(real) bend, LANE_IN(real) inverse_length, LANE_IN(real) time2, LANE_IN(real) weight) {
  return bend * inverse_length * inverse_length * time2 * weight;
}

// Whether a strand's rest shape is kinked. Its bends change from joint to joint by more than 0.04 rad (rms), and less
// evenly than along a curl or a wave of more than six edges. `bends`, `changes`, `second_changes`: sums over `joints`
// (without the root's) of |rest strain|^2 and of the squares of its first and second differences.
LANE_FN mask bendsUnevenly(LANE_IN(real) bends, LANE_IN(real) changes, LANE_IN(real) second_changes, LANE_IN(real) joints) {
  return changes > lit(0.0016) * joints && second_changes > bends;
}
// Whether the strand needs the treatment of kinked hair: it is also stiff enough. `kappa`: greatest stiffness ratio of
// its edges.
LANE_FN mask isKinked(LANE_IN(mask) uneven, LANE_IN(real) kappa) { return uneven && kappa > lit(0.3); }
// Whether the bends at rest are sharp: fewer than 5.6 edges make a full turn. Sums as in bendsUnevenly().
LANE_FN mask isSharp(LANE_IN(real) bends, LANE_IN(real) joints) { return bends > lit(1.5) * joints; }

// Time blend: forces on an edge are evaluated at `blend` x old position + (1 - blend) x inertial point. Blend 0 is
// implicit Euler, which damps a mode of angular frequency w with damping ratio w dt / 2. Blend 1 is the average
// acceleration method (Newmark 1959), which damps nothing.
//
// docs/solver.md (7): the result is 0.9 for smooth motion and falls to 0 as the edge rotates by 18 to 26 degrees in the
// substep. It is less at bent joints with some stiffness and for large `kappa`. `advance`: inertial edge less old edge;
// `kink`: old edge less the edge before it; both over the edge's length. `kappa`: see stiffnessOf(), isCutUnevenly().
// `kinked`: see isKinked(); such strands get 0, because undamped small waves grew between their kinks.
LANE_FN real timeBlend(LANE_IN(real3) advance, LANE_IN(real3) kink, LANE_IN(real) kappa, LANE_IN(mask) kinked) {
  real slow = select(kinked, lit(0), lit(1)) * clamp(lit(2) - lit(10) * dot(advance, advance), lit(0), lit(1));
  return lit(0.9) * slow * inverse(madd(lit(0.05), kappa, madd(lit(20) * min(lit(10) * kappa, lit(1)), dot(kink, kink), lit(1))));
}
// Share of the new increment in the position where forces are evaluated; the matrix gets this share of the stiffness. 1
// for implicit Euler, 1/4 for average acceleration. docs/solver.md (8).
LANE_FN real implicitShare(LANE_IN(real) blend) { return lit(1) - lit(0.75) * blend; }

// Stiffness of a joint in the bending matrix: a majorant of the true Hessian in the directions of the two tangents.
// `c`: cosine of the angle between them. `time2` here: implicit share x dt^2 + dt x damping time. docs/solver.md (13).
LANE_FN real bendMatrixStiffness(LANE_IN(real) bend, LANE_IN(real) c, LANE_IN(real) time2) {
  return bend * time2 * inverse(max(lit(0.5) * (lit(1) + c), lit(0.1)));
}
// Margin that a bent joint adds to the matrix on each of its edges, for the rotation of tangents under its moment. It
// acts as inertia against the rigid rotation of a curl. Tuned: with 0.75 in place of 1.25, stiff curls are unstable.
// Kinked hair needs 4, because curlSoftness() assumes that the next vertices move like this one, and theirs do not.
// docs/solver.md (13).
LANE_FN real bendMatrixMargin(LANE_IN(real) stiffness, LANE_IN(real) c, LANE_IN(real3) excess, LANE_IN(mask) kinked) {
  real fold = max(lit(2) - lit(2) * c, lit(0));
  return stiffness * madd(select(kinked, lit(4), lit(1.25)), fold, lit(5) * min(dot(excess, excess), lit(4)));
}

// Stiffness of an edge in the bending matrix: the margins of its two joints, and its kept tension. docs/solver.md (13).
LANE_FN real edgeMatrixStiffness(LANE_IN(real) margins, LANE_IN(real) inverse_length, LANE_IN(real) kept, LANE_IN(real) blend) {
  return madd(margins * inverse_length, inverse_length, max(kept, lit(0)) * inverse_length * implicitShare(blend));
}

// `push` without its component along the normal of a contact (zero if there is no contact).
LANE_FN real3 alongSurface(LANE_IN(real3) push, LANE_IN(real3) normal) { return madd(normal, lit(0) - dot(push, normal), push); }

// The bending system, docs/solver.md (12), has one displacement per vertex. bendOwn() is the diagonal entry of the
// outer vertex of edge e by joints of stiffness k0 (before edge e), k1 and k2 (the next two). bendAcross() couples that
// vertex to the next one, bendAcrossTwo() to the one after. `il`, `il_out`, `il_out2`: inverse lengths of edge e and
// the next two, 1/m.
LANE_FN real bendOwn(LANE_IN(real) k0, LANE_IN(real) k1, LANE_IN(real) k2, LANE_IN(real) il, LANE_IN(real) il_out) {
  real sum = il + il_out;
  return k0 * il * il + k1 * sum * sum + k2 * il_out * il_out;
}
LANE_FN real bendAcross(LANE_IN(real) k1, LANE_IN(real) k2, LANE_IN(real) il, LANE_IN(real) il_out, LANE_IN(real) il_out2) {
  return lit(0) - k1 * (il + il_out) * il_out - k2 * il_out * (il_out + il_out2);
}
LANE_FN real bendAcrossTwo(LANE_IN(real) k2, LANE_IN(real) il_out, LANE_IN(real) il_out2) { return k2 * il_out * il_out2; }

// Lengths and tensions belong in the metric of the bending matrix A, which is dense. Tension pulls a vertex of a curl
// inwards, along the difference b of its two tangents, and there A resists. So the length system, docs/solver.md (16)
// and (17), uses the metric weight (1 - softness b b' / b.b), whose softness follows from b A b. Its rows stay
// tridiagonal, as with the masses alone (Goldenthal et al. 2007, "Efficient Simulation of Inextensible Cloth"). In the
// metric of the masses, tensions lag behind, which feeds energy to curls.
//
// `stiffness`: of the vertex's joint in A; t_in2, t_in, t_out, t_out2: tangents of the two edges before and the two
// after the vertex; `anchoring`: edgeAnchoring() of the edge before it if that edge is anchored, otherwise 0.
LANE_FN real curlSoftness(LANE_IN(real) weight, LANE_IN(real) stiffness, LANE_IN(real) inverse_length, LANE_IN(real3) t_in2,
                          LANE_IN(real3) t_in, LANE_IN(real3) t_out, LANE_IN(real3) t_out2, LANE_IN(real) anchoring) {
  real3 b = t_out - t_in;
  real3 change = t_out2 - t_in2 - b * lit(3);
  real bends = dot(b, b);
  real held = weight * inverse_length * inverse_length * madd(stiffness, dot(change, change), anchoring * bends);
  return held * inverse(bends + held * lit(1.01) + lit(1e-12));
}
// Resistance of A to the rotation of an anchored edge, docs/solver.md (18): one whose inner end is the root or a pin,
// which cannot move along with its outer end. It sums the stiffness of the inner joint and the margins of both joints.
// Without it, soft hair that folds down over its root oscillated without end.
LANE_FN real edgeAnchoring(LANE_IN(real) stiffness, LANE_IN(real) margin, LANE_IN(real) margin_out) {
  return stiffness + margin + margin_out;
}
// Weight of a vertex in this metric along an adjacent edge. `c`: cosine of the angle between its two tangents.
LANE_FN real weightAlong(LANE_IN(real) weight, LANE_IN(real) softness, LANE_IN(real) c) {
  return weight * (lit(1) - lit(0.5) * softness * (lit(1) - c));
}
// Off-diagonal entry of the length system for the two edges that meet at a vertex. The system has one unknown per edge
// (lambda x weight, m); its diagonal sums the weights of both ends along the edge.
LANE_FN real lengthAcross(LANE_IN(real) weight, LANE_IN(real) softness, LANE_IN(real) c) {
  return lit(0) - weight * (c + lit(0.5) * softness * (lit(1) - c));
}
// A vertex in contact (softness 0) moves along the surface only. This term is subtracted from weightAlong() of edge t
// (with t_other = t) and added to lengthAcross() of both edges.
LANE_FN real weightHeld(LANE_IN(real3) t, LANE_IN(real3) t_other, LANE_IN(real3) normal, LANE_IN(real) weight) {
  return weight * dot(t, normal) * dot(t_other, normal);
}
// Added to the diagonal so that contact leaves at least a tenth of the weights. An edge parallel to the normals at its
// ends would otherwise get an unbounded tension increment and throw sideways any edge that is not exactly parallel.
LANE_FN real lengthHeld(LANE_IN(real3) t, LANE_IN(real3) normal_in, LANE_IN(real) weight_in, LANE_IN(real3) normal,
                        LANE_IN(real) weight) {
  real a_in = dot(t, normal_in), a = dot(t, normal);
  return max(weight_in * (a_in * a_in - lit(0.9)) + weight * (a * a - lit(0.9)), lit(0));
}
// Correction strain, docs/solver.md (20): displacement of an edge's ends by its tension increment `lambda`, over its
// length. If it is large for any edge of a strand, the tridiagonal metric is too inaccurate for that strand. It would
// feed energy to hair, first to stiff, sharply bent or kinked hair.
LANE_FN real correctionStrain(LANE_IN(real) lambda, LANE_IN(real) weight_in, LANE_IN(real) weight, LANE_IN(real) inverse_length) {
  return abs(lambda) * (weight_in + weight) * inverse_length;
}
// Correction strain up to which the tridiagonal metric is accurate enough. `sharp`: isSharp() or bendsUnevenly();
// `kappa`: greatest stiffness ratio of the strand's edges.
LANE_FN real correctionLimit(LANE_IN(mask) sharp, LANE_IN(real) kappa) {
  return select(sharp || kappa > lit(10), lit(0.05), lit(0.15));
}
LANE_FN mask needsDenseMetric(LANE_IN(real) strain, LANE_IN(real) limit) { return strain > limit; }
// Overshoot, 0 to 1, docs/solver.md (25): share of a correction beyond the edge's own length (`strain` above 1). The
// substep cannot resolve how a strand beside a body folds then, and its displacement must not become velocity in full.
// `nearness`: of the body, see kernels/contact.h. A strand between two pins overshoots without any body: its `nearness`
// is 1.
//
// velocityClamp() returns the factor on the velocities of the strand's vertices, of which the largest is `speed`.
// `fastest`: greatest speed before the substep of any vertex, the root, a pin or a nearby body; both m/s. The bound is
// 1.1 fastest + 0.1 m/s. Between two pins it is 0.9 fastest + 0.1 m/s: both pins hold the strand, so that it keeps what
// energy it gains and must lose some in each substep.
LANE_FN real overshoot(LANE_IN(real) strain, LANE_IN(real) nearness) { return clamp(strain - lit(1), lit(0), lit(1)) * nearness; }
LANE_FN real velocityClamp(LANE_IN(real) speed, LANE_IN(real) fastest, LANE_IN(real) overshot, LANE_IN(mask) between_pins) {
  real bound = madd(fastest, select(between_pins, lit(0.9), lit(1.1)), lit(0.1));
  return max(lit(1) - overshot * max(lit(1) - bound * inverse(max(speed, lit(1e-6))), lit(0)), lit(1e-6));
}
// Displacement of a vertex, per weight, by the tension increments of the edges before and after it, in this metric,
// docs/solver.md (19). With softness 0 it is the force. In contact, only the alongSurface() part acts.
LANE_FN real3 shiftByTensions(LANE_IN(real3) t_in, LANE_IN(real) lambda_in, LANE_IN(real3) t_out, LANE_IN(real) lambda_out,
                              LANE_IN(real) softness) {
  real held = lit(0.5) * softness * (lambda_in + lambda_out);
  return t_out * (lambda_out - held) - t_in * (lambda_in - held);
}
// Least pivot in the elimination of the length system. Low enough for strands of 128 vertices: on a straight strand of
// n vertices, pivots fall to 1 / n, and the solution must not depend on the order of elimination.
LANE_FN real lengthPivot(LANE_IN(real) weight_in, LANE_IN(real) weight) {
  return max((weight_in + weight) * lit(1e-3), lit(1e-6));
}
// Constraint residual of an edge for the length solve: 0 if both ends are held, otherwise its excess length, m.
LANE_FN real lengthResidual(LANE_IN(real) excess, LANE_IN(real) weight_in, LANE_IN(real) weight) {
  return select(weight_in + weight > lit(0), excess, lit(0));
}
// Displacement that restores an edge's rest length, docs/solver.md (22), along the edge, or along `otherwise` if the
// edge has no direction. A small difference by design: rebuilding the edge from direction and length would move it by
// the rounding of both.
LANE_FN real3 missingLength(LANE_IN(real3) edge, LANE_IN(real3) otherwise, LANE_IN(real) rest_length) {
  real3 t = directionOr(edge, otherwise);
  return t * (rest_length - dot(edge, t));
}
// Conjugate gradient iterations (Shewchuk 1994, algorithm B3) for the length system in the dense metric J A^-1 J',
// docs/solver.md (21), preconditioned with the tridiagonal system. Two are accurate enough; with one, some stiff
// strands do not come to rest.
const int kTensionIterations = 2;
// Whether tension increments are found by elimination (kernels/stiff_tensions.h) in place of conjugate gradients. The
// residual of the iterations is left to exact lengths, which bends joints; stiff kinked strands never came to rest
// then. `kappa`: greatest stiffness ratio of the strand's edges; `pressed`: a body presses the strand, which lowers the
// limit.
LANE_FN mask isStiff(LANE_IN(real) kappa) { return kappa > lit(100); }
LANE_FN mask isEliminated(LANE_IN(real) kappa, LANE_IN(real) strain, LANE_IN(real) limit, LANE_IN(mask) pressed) {
  return isStiff(kappa) && (strain > lit(0.3) || (pressed && needsDenseMetric(strain, limit)));
}
// Whether two pins hold a strand taut. Its tension increments are always found by elimination, and its lengths are not
// solved again. Conjugate gradients do not suffice: equal increments all along hardly move a nearly straight strand, so
// that the metric of the masses is nearly singular for them.
LANE_FN mask isTaut(LANE_IN(real) tautness) { return tautness > lit(3); }
// Quotient of the conjugate gradient method; 0 if the denominator vanishes. Bounded by 16: longer steps, on strands far
// from their lengths, are more rounding than progress.
LANE_FN real conjugateStep(LANE_IN(real) numerator, LANE_IN(real) denominator) {
  mask some = denominator > lit(1e-30);
  return min(select(some, numerator, lit(0)) * inverse(select(some, denominator, lit(1))), lit(16));
}

// Warm start of an edge's tension, in units of length x mass (force x dt^2): the tension of the last substep. An edge
// that rotates loses up to 2 % of it, so that errors of fast motion decay. Compression is limited to a value below the
// buckling load. `advance`: as in timeBlend(). docs/solver.md (23).
LANE_FN real keptTension(LANE_IN(real) tension, LANE_IN(real3) advance, LANE_IN(real) bend, LANE_IN(real) inverse_length,
                         LANE_IN(real) time2) {
  real forgotten = min(lit(200) * dot(advance, advance), lit(0.02));
  return max(tension * (lit(1) - forgotten), bend * inverse_length * time2 * lit(-0.1));
}

// Tension of a stretch of a strand between two pins at distance `span`, over its weight or other driving force: a
// nearly taut strand hangs in a parabola. At least 1. Slack is clamped from below so that the result is bounded.
// `span`, `length`: m.
LANE_FN real tautness(LANE_IN(real) span, LANE_IN(real) length) {
  real slack = max(length - span, madd(lit(1e-5), length, lit(1e-9)));
  return max(sqrt(span * inverse(lit(24) * slack)), lit(1));
}
// Greatest tension, in units of length x mass, docs/solver.md (24), that the next substep may start from. Without this
// bound, stiff hair could keep a false tension after fast motion. `mass`: of all free vertices; `length`: of the
// strand, m; `driven`: acceleration by gravity plus the greatest by air and external forces, m/s^2, times the greatest
// tautness() between its pins.
LANE_FN real tensionBound(LANE_IN(real) mass, LANE_IN(real) length, LANE_IN(real) driven, LANE_IN(real) time2) {
  return mass * time2 * madd(lit(50), length, lit(3) * driven);
}

// Bending strain, world; see jointStrain().
LANE_FN real3 straightStrain(LANE_IN(real3) t_in, LANE_IN(real3) t) {
  real inverse_cosine = inverseSqrt(max(lit(0.5) * (lit(1) + dot(t_in, t)), lit(1e-6)));  // of half the angle
  return cross(t_in, t) * (inverse_cosine * min(inverse_cosine, lit(5)));
}

// Angle, radians, by which the outer edge must rotate about itself more than the inner one so that there is no twist
// between them (Bergou et al. 2008, gradient of holonomy).
LANE_FN real straightSpin(LANE_IN(real3) t_in, LANE_IN(real3) t, LANE_IN(real3) swing_in, LANE_IN(real3) swing) {
  return dot(cross(t, t_in), swing_in + swing) * inverse(max(lit(1) + dot(t_in, t), lit(1e-3)));
}

// Strain gained by gainedStrain() and twistedStrain(), rotated back by a quarter turn: t_in x result. The swing of the
// outer edge is carried by the shortest rotation from it to the inner one. `spin`: mean rotation of the two edges about
// themselves, radians.
LANE_FN real3 straightGain(LANE_IN(real3) strain, LANE_IN(real3) t_in, LANE_IN(real3) t, LANE_IN(real3) swing_in,
                           LANE_IN(real3) swing, LANE_IN(real) spin) {
  real along = dot(swing, t_in) * inverse(max(lit(1) + dot(t_in, t), lit(1e-3)));
  return swing - (t_in + t) * along - swing_in - strain * spin;
}

// See torqueDifference(). `damped`: bend x damping time in substeps.
LANE_FN real straightTorque(LANE_IN(real3) strain, LANE_IN(real3) gain, LANE_IN(real) damped) {
  return lit(0.5) * damped * dot(strain, gain);
}

// See jointMoment(). `torque`: straightTorque() of this joint; `beyond`: sum over all joints after it.
LANE_FN real3 straightMoment(LANE_IN(real3) strain, LANE_IN(real3) gain, LANE_IN(real3) t_in, LANE_IN(real) bend,
                             LANE_IN(real) damped, LANE_IN(real) torque, LANE_IN(real) beyond) {
  real twisting = torque + lit(2) * beyond;  // moment about the inner edge before it bends
  return strain * bend + cross(t_in, gain * damped - strain * (lit(0.5) * twisting)) + t_in * (twisting + torque);
}
