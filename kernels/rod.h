// Kernel text: see kernels/README.md. A strand as an inextensible Kirchhoff rod: unit tangents t_e and material frames
// q_e (body z = t_e) on edges e, bending and twist at joints j between edges j-1 and j; joint 0 is between the root frame
// and edge 0. All masses of a strand are divided by one reference mass, stiffnesses too, so units are metres and seconds.

FN real3 frameTangent(IN(quat) q) {
  return makeReal3(lit(2) * madd(q.x, q.z, q.w * q.y), lit(2) * madd(q.y, q.z, lit(0) - q.w * q.x),
                   lit(1) - lit(2) * madd(q.x, q.x, q.y * q.y));
}

// Frame q of an edge, whose tangent is its frameTangent(), moved with it to the unit vector t, without twist.
FN quat transportTo(IN(quat) q, IN(real3) tangent, IN(real3) t) { return multiply(rotationBetween(tangent, t), q); }

// Of half the angle of a joint whose frames differ by the rotation p, as far as its law goes: near a full fold it is capped.
FN real cappedCosine(IN(quat) p) { return max(abs(p.w), lit(0.2)); }

// Bending (x, y) and twist (z) strain of the joint between frames a and b, in frame a: 2 tan(theta/2) along the axis of
// the rotation from a to b, up to where it is capped, so a fold always pushes back.
FN real3 jointStrain(IN(quat) a, IN(quat) b) {
  quat p = multiply(conjugate(a), b);
  real w = lit(2) * inverse(cappedCosine(p));
  real s = select(p.w < lit(0), lit(0) - w, w);
  return makeReal3(p.x * s, p.y * s, p.z * s);
}

// Moment of a joint on its outer edge, world: gradient of the elastic energy to a rotation of that edge. `strain` as
// above, `excess` = strain less rest strain, k = (bending, bending, twist) stiffness in m^2/s^2.
FN real3 jointMoment(IN(quat) a, IN(real3) strain, IN(real3) excess, IN(real) bend, IN(real) twist) {
  real3 c = makeReal3(bend * excess.x, bend * excess.y, twist * excess.z);
  return rotate(a, madd(cross(strain, c), lit(0.5), c));
}

// How far frame b, whose tangent is that of a, is turned about it from a on: radians, small.
FN real spinBetween(IN(quat) a, IN(quat) b) { return clamp(jointStrain(a, b).z, lit(-1), lit(1)); }
// How an edge turns in a substep, without twist, in its own frame q; `advance`: of its outer end on the inner one over its length.
FN real3 turningOf(IN(quat) q, IN(real3) advance) {
  real3 own = rotateBack(q, advance);
  return makeReal3(lit(0) - own.y, own.x, lit(0));
}
// The bending strain that a joint gains when its edges turn so, each in its own frame. Internal damping (Kelvin and Voigt's) adds
// to the strain what it gains in the damping time. jointMoment() is the transpose of this, and so damping takes energy from all that
// bends hair and from nothing else. Twist is not damped: it has no inertia here.
FN real3 gainedStrain(IN(real3) strain, IN(real3) turned_in, IN(real3) turned) {
  real3 more = turned - turned_in, sum = (turned + turned_in) * lit(0.5);
  return makeReal3(more.x + (strain.y * sum.z - strain.z * sum.y), more.y + (strain.z * sum.x - strain.x * sum.z), lit(0));
}

// The torque of a joint about its inner edge's tangent is twist excess.z + d, about its outer edge's twist excess.z - d.
// This is d.
FN real torqueDifference(IN(real3) strain, IN(real3) excess, IN(real) bend) {
  return lit(0.5) * bend * (strain.x * excess.y - strain.y * excess.x);
}
// What bending adds to the stiffness of twist: the torques change by (twist + a) phi on the edge of a joint that turns by
// phi about its tangent and by (a - twist) phi on the other. This is a, without terms in strain.z, held positive.
FN real twistOfBending(IN(real3) strain, IN(real3) excess, IN(real) bend) {
  real3 rest = strain - excess;
  return max(lit(0.25) * bend * madd(strain.x, rest.x, strain.y * rest.y), lit(0));
}
// The same of internal damping; `ahead`: the damping time, in substeps.
FN real twistOfDamping(IN(real3) strain, IN(real) bend, IN(real) ahead) {
  return lit(0.25) * bend * ahead * madd(strain.x, strain.x, strain.y * strain.y);
}
// Strain of a joint when its inner and outer edge have turned about their tangents by phi_in and phi (radians, small).
FN real3 twistedStrain(IN(real3) strain, IN(real) phi_in, IN(real) phi) {
  real mean = lit(0.5) * (phi_in + phi);
  return makeReal3(madd(strain.y, mean, strain.x), madd(lit(0) - strain.x, mean, strain.y), strain.z + phi - phi_in);
}
// `excess` of a strain with what internal damping adds: `gained` in the substep without twist, the rest by twist.
FN real3 dampedExcess(IN(real3) excess, IN(real3) gained, IN(real3) untwisted, IN(real3) strain, IN(real) ahead) {
  real3 by_twist = strain - untwisted;
  return makeReal3(madd(gained.x + by_twist.x, ahead, excess.x), madd(gained.y + by_twist.y, ahead, excess.y), excess.z);
}

// Frame turned about its own tangent by the small angle phi.
FN quat twistFrame(IN(quat) q, IN(real) phi) {
  real h = phi * lit(0.5);
  return normalizeQuat(makeQuat(madd(q.y, h, q.x), madd(lit(0) - q.x, h, q.y), madd(q.w, h, q.z),
                                madd(lit(0) - q.z, h, q.w)));
}

// Whether a strand has an edge that is short beside the others. Of such a one all edges have the time blend of the stiffest: where a short
// edge had less than those next to it, that fed energy, and the strand never came to rest.
FN mask isCutUnevenly(IN(real) shortest, IN(real) mean) { return shortest < lit(0.5) * mean; }

// Stiffness of an edge against the inertia of its outer vertex: kappa = dt^2 bend / (mass length^2).
FN real stiffnessOf(IN(real) bend, IN(real) inverse_length, IN(real) time2, IN(real) weight) {
  return bend * inverse_length * inverse_length * time2 * weight;
}

// Whether a strand's shape is kinked: from joint to joint its bends at rest change by more than 0.04 rad (rms), and not evenly, as along a
// curl or a wave of more than six edges. Sums over `joints`, without the root's: |rest strain|^2, and the same of its first and second
// differences.
FN mask bendsUnevenly(IN(real) bends, IN(real) changes, IN(real) second_changes, IN(real) joints) {
  return changes > lit(0.0016) * joints && second_changes > bends;
}
// Whether it is to be taken as that: it is stiff enough for it to matter. `kappa`: the greatest of its edges.
FN mask isKinked(IN(mask) uneven, IN(real) kappa) { return uneven && kappa > lit(0.3); }
// Whether its bends at rest are sharp: fewer than 5.6 such edges make a turn. Sums as above.
FN mask isSharp(IN(real) bends, IN(real) joints) { return bends > lit(1.5) * joints; }

// Forces on an edge are taken at a blend of its old position (1) and the inertial point (0). 0 is implicit Euler, which
// damps a motion of angular frequency w by zeta = w dt / 2; 1 is the average acceleration method (Newmark 1959), which
// damps nothing. Here 0.9 where the motion is smooth and 0 where the edge turns by more than 18 to 26 degrees in the
// substep; less where a joint with some stiffness is bent and where `kappa` is large. `advance`: of the inertial edge on
// the old one, `kink`: of the old edge on the one before it, both over the edge's length. `kappa`: see stiffnessOf(), isCutUnevenly(). `kinked`: see
// isKinked(); between the kinks, too, small waves grew where nothing damped them.
FN real timeBlend(IN(real3) advance, IN(real3) kink, IN(real) kappa, IN(mask) kinked) {
  real slow = select(kinked, lit(0), lit(1)) * clamp(lit(2) - lit(10) * dot(advance, advance), lit(0), lit(1));
  return lit(0.9) * slow *
         inverse(madd(lit(0.05), kappa, madd(lit(20) * min(lit(10) * kappa, lit(1)), dot(kink, kink), lit(1))));
}
// Share of the new increment in the position where forces act: the matrix has this part of the stiffness. 1 for implicit
// Euler, 1/4 for average acceleration.
FN real implicitShare(IN(real) blend) { return lit(1) - lit(0.75) * blend; }

// Stiffness of a joint in the bending matrix: a majorant of its true Hessian in the turning of the two tangents, where
// they make an angle of cosine c. `time2` = implicit share x dt^2 + dt x damping time.
FN real bendMatrixStiffness(IN(real) bend, IN(real) c, IN(real) time2) {
  return bend * time2 * inverse(max(lit(0.5) * (lit(1) + c), lit(0.1)));
}
// What a bent joint adds to the matrix on each of its edges: the turning of directions under its moment. It acts as
// inertia against the turning of a curl; with 0.75 in the place of 1.25, stiff curls are unstable. So is kinked hair: its tensions do not
// act as curlSoftness() takes it, that the next vertices move as this one does.
FN real bendMatrixMargin(IN(real) stiffness, IN(real) c, IN(real3) excess, IN(mask) kinked) {
  real fold = max(lit(2) - lit(2) * c, lit(0));
  return stiffness * madd(select(kinked, lit(4), lit(1.25)), fold, lit(5) * min(dot(excess, excess), lit(4)));
}

// Stiffness of an edge in the bending matrix: the margins of its two joints, and its kept tension.
FN real edgeMatrixStiffness(IN(real) margins, IN(real) inverse_length, IN(real) kept, IN(real) blend) {
  return madd(margins * inverse_length, inverse_length, max(kept, lit(0)) * inverse_length * implicitShare(blend));
}

// `push` without its part along a contact's normal (zero where there is no contact).
FN real3 alongSurface(IN(real3) push, IN(real3) normal) { return madd(normal, lit(0) - dot(push, normal), push); }

// The bending system, one unknown displacement per vertex: what joints of stiffness k0 (before edge e), k1 and k2 (the two
// after it) put on the diagonal of the outer vertex of edge e, and what couples it to the next vertex and the one after.
// `il`, `il_out`, `il_out2`: inverse lengths of edge e and the two after it.
FN real bendOwn(IN(real) k0, IN(real) k1, IN(real) k2, IN(real) il, IN(real) il_out) {
  real sum = il + il_out;
  return k0 * il * il + k1 * sum * sum + k2 * il_out * il_out;
}
FN real bendAcross(IN(real) k1, IN(real) k2, IN(real) il, IN(real) il_out, IN(real) il_out2) {
  return lit(0) - k1 * (il + il_out) * il_out - k2 * il_out * (il_out + il_out2);
}
FN real bendAcrossTwo(IN(real) k2, IN(real) il_out, IN(real) il_out2) { return k2 * il_out * il_out2; }

// Lengths and tensions should be solved in the metric of the bending matrix A, which is dense. Tension pulls a vertex of a
// curl inwards, along the difference b of its tangents, and A holds it back there. So they are solved in the metric
// weight (1 - softness b b' / b.b), with the softness that b A b tells; its rows are tridiagonal. In the metric of the masses
// alone tensions lag behind, which feeds energy to curls. `stiffness`: of the vertex's joint in A; t_in2, t_in, t_out, t_out2:
// tangents of the two edges before and the two after the vertex. `anchoring`: of the edge before it, where that is anchored, else 0.
FN real curlSoftness(IN(real) weight, IN(real) stiffness, IN(real) inverse_length, IN(real3) t_in2, IN(real3) t_in,
                     IN(real3) t_out, IN(real3) t_out2, IN(real) anchoring) {
  real3 b = t_out - t_in;
  real3 change = t_out2 - t_in2 - b * lit(3);
  real bends = dot(b, b);
  real held = weight * inverse_length * inverse_length * madd(stiffness, dot(change, change), anchoring * bends);
  return held * inverse(bends + held * lit(1.01) + lit(1e-12));
}
// An edge is anchored whose inner end is held, by the root or a pin: it cannot go along with its outer one. This is what A has against its
// turning: the stiffness of its inner joint and the margins of both. Without it soft hair that folds down over its root bobbed for ever.
FN real edgeAnchoring(IN(real) stiffness, IN(real) margin, IN(real) margin_out) { return stiffness + margin + margin_out; }
// What of this metric acts along an edge next to the vertex, whose tangents make an angle of cosine c.
FN real weightAlong(IN(real) weight, IN(real) softness, IN(real) c) {
  return weight * (lit(1) - lit(0.5) * softness * (lit(1) - c));
}
// This couples the two edges that meet at a vertex in the length system, which has one unknown (m, pull x weight) per edge and on
// its diagonal the weights of both ends along it.
FN real lengthAcross(IN(real) weight, IN(real) softness, IN(real) c) {
  return lit(0) - weight * (c + lit(0.5) * softness * (lit(1) - c));
}
// In contact (softness zero) a vertex gives way along the surface only. That takes this off weightAlong() of edge t, with t as
// t_other, and adds it to lengthAcross() of both.
FN real weightHeld(IN(real3) t, IN(real3) t_other, IN(real3) normal, IN(real) weight) {
  return weight * dot(t, normal) * dot(t_other, normal);
}
// What is added to the diagonal, because contact leaves a tenth of the weights at least: an edge along the normals at its ends
// would get a pull without bound, and throw sideways whatever is not upright to the last digit.
FN real lengthHeld(IN(real3) t, IN(real3) normal_in, IN(real) weight_in, IN(real3) normal, IN(real) weight) {
  real a_in = dot(t, normal_in), a = dot(t, normal);
  return max(weight_in * (a_in * a_in - lit(0.9)) + weight * (a * a - lit(0.9)), lit(0));
}
// How far the pull of an edge would move its ends, over its length. Where that is violent for any edge of a strand, this metric
// is too bad a guess for it and would feed energy to hair: to stiff hair soonest, and to what is sharp or uneven.
FN real violence(IN(real) pull, IN(real) weight_in, IN(real) weight, IN(real) inverse_length) {
  return abs(pull) * (weight_in + weight) * inverse_length;
}
// The most that does not matter. `sharp`: isSharp() or bendsUnevenly(); `kappa`: the greatest of a strand's edges.
FN real violenceBorne(IN(mask) sharp, IN(real) kappa) { return select(sharp || kappa > lit(10), lit(0.05), lit(0.15)); }
FN mask isViolent(IN(real) violence, IN(real) borne) { return violence > borne; }
// Pulls that would move ends farther than their edges are long: how a strand beside a body folds then is beyond the substep, and what it
// would take for speed is not its own. thrownBy() says how much that is so, 0 to 1; `nearness`: of the body, see kernels/contact.h.
// Then slowed() is the part that its vertices keep of their speeds, of which the largest is `speed`; `fastest`: the most that any of them,
// its root, its pins or a body beside it had before, m/s. What hangs between two pins is beyond the substep without any body, and as
// both hold it whatever it gains it keeps: it has to lose some each time.
FN real thrownBy(IN(real) violence, IN(real) nearness) { return clamp(violence - lit(1), lit(0), lit(1)) * nearness; }
FN real slowed(IN(real) speed, IN(real) fastest, IN(real) thrown_by, IN(mask) between_pins) {
  real bound = madd(fastest, select(between_pins, lit(0.9), lit(1.1)), lit(0.1));
  return max(lit(1) - thrown_by * max(lit(1) - bound * inverse(max(speed, lit(1e-6))), lit(0)), lit(1e-6));
}
// How the pulls of the edges before and after a vertex move it in this metric, per weight; as a force with softness 0. In contact
// only alongSurface().
FN real3 pushOfPulls(IN(real3) t_in, IN(real) pull_in, IN(real3) t_out, IN(real) pull_out, IN(real) softness) {
  real held = lit(0.5) * softness * (pull_in + pull_out);
  return t_out * (pull_out - held) - t_in * (pull_in - held);
}
// What the elimination of the length system may divide by at least. Low enough for strands of 128 vertices: on a straight
// one of n the pivots fall to 1 / n, and what elimination gives must not depend on its order.
FN real lengthPivot(IN(real) weight_in, IN(real) weight) { return max((weight_in + weight) * lit(1e-3), lit(1e-6)); }
// Of the excess of an edge over its length, what its pull is to mend: nothing where both its ends are held.
FN real excessToMend(IN(real) excess, IN(real) weight_in, IN(real) weight) {
  return select(weight_in + weight > lit(0), excess, lit(0));
}
// What an edge lacks to its rest length, along itself, or along `otherwise` where it has no direction. As a small change: an edge
// made anew from direction and length would come out elsewhere by the rounding of both.
FN real3 missingLength(IN(real3) edge, IN(real3) otherwise, IN(real) rest_length) {
  real3 t = directionOr(edge, otherwise);
  return t * (rest_length - dot(edge, t));
}
// The length system of violent motion has the dense metric after all: J A^-1 J'. So many conjugate gradient iterations
// (Shewchuk 1994, algorithm B3), preconditioned with the tridiagonal system, solve it well enough; after one, some stiff strands
// never calm down. conjugateStep() is a quotient of theirs, 0 where there is nothing left to do. It is bounded: longer steps, on
// strands far from their lengths, are more rounding than progress.
const int kPullIterations = 2;
// What iterations leave is made good by exact lengths, which bends joints; what is stiff and kinked was thrown about by that for ever. So
// where that may be, pulls are found by elimination (kernels/stiff_pulls.h). `kappa`: the greatest of a strand's edges, see stiffnessOf();
// `pressed`: by a body, which leaves less room.
FN mask isStiff(IN(real) kappa) { return kappa > lit(100); }
FN mask isEliminated(IN(real) kappa, IN(real) violence, IN(real) borne, IN(mask) pressed) {
  return isStiff(kappa) && (violence > lit(0.3) || (pressed && isViolent(violence, borne)));
}
// Nor would they do for a strand that two pins hold taut: pulls that are the same all along hardly move what is nearly straight, and the
// metric of the masses tells nothing of them. Its pulls are always eliminated, and lengths not solved again.
FN mask isTaut(IN(real) tautness) { return tautness > lit(3); }
FN real conjugateStep(IN(real) numerator, IN(real) denominator) {
  mask some = denominator > lit(1e-30);
  return min(select(some, numerator, lit(0)) * inverse(select(some, denominator, lit(1))), lit(16));
}

// The tension that a substep starts from, in units of length x mass: that of the last one. Edges that turn forget up to
// 2 % of it, so that errors of fast motion do not stay; compression is held below the buckling load. `advance` as above.
FN real keptTension(IN(real) tension, IN(real3) advance, IN(real) bend, IN(real) inverse_length, IN(real) time2) {
  real forgotten = min(lit(200) * dot(advance, advance), lit(0.02));
  return max(tension * (lit(1) - forgotten), bend * inverse_length * time2 * lit(-0.1));
}

// How many times its weight, or what else drives it, a stretch of a strand carries as tension where two pins hold it nearly taut, a span
// apart: it hangs in a parabola. At least 1; no slack at all is taken for some, so that there is a bound.
FN real tautness(IN(real) span, IN(real) length) {
  real slack = max(length - span, madd(lit(1e-5), length, lit(1e-9)));
  return max(sqrt(span * inverse(lit(24) * slack)), lit(1));
}
// The most tension, in the same units, that is taken over into the next substep: stiff hair that was thrown about could
// otherwise keep a false tension of its own. `mass` of all free vertices, `length` of the strand in metres; `driven`: by gravity, and the
// most by air and what else accelerates a vertex, m/s^2; both times the most tautness() of what is between its pins.
FN real tensionBound(IN(real) mass, IN(real) length, IN(real) driven, IN(real) time2) {
  return mass * time2 * madd(lit(50), length, lit(3) * driven);
}
