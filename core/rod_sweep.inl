// One step of a block of strands as inextensible rods (Bergou et al. 2008). docs/solver.md derives the substep, and
// comments cite its equations by number; kernels/rod.h has the formulas. Included after core/near_bodies.inl.
//
// A substep is linearised at the inertial point and solved directly along the strand: twist (tridiagonal), bending (one
// pentadiagonal matrix for x, y and z), lengths and tensions (tridiagonal). Each solve eliminates in one direction and
// substitutes in the other, so that they merge into six sweeps:
//   predict            root to tip: inertial points, tangents, frames
//   eliminateTwist     root to tip: joint strains, elimination of twist
//   eliminateBending   tip to root: substitution of twist, forces, elimination of bending
//   moveByForces       root to tip: substitution of bending, contact, elimination of lengths
//   substituteLengths  tip to root: tension increments
//   finish             root to tip: their displacements, exact lengths, velocities
// Strands above the correction limit take more: their tension increments act through the bending matrix. They and
// strands near a body have their lengths solved again (applyTensions, substituteLengths).
//
// After the sweeps come what is constant during a step (computeTraits: stiffness, rest bends, edge lengths, driving
// forces), lengths between pins (maxTautness, shareMissing), tension increments of stiff strands by elimination
// (eliminateTensions), and the velocity clamp of strands that overshoot. Contact is in core/rod_contact.inl.

// Scratch, [row][plane][lane], `vertices` + 2 rows. Row e is edge e or joint e, row i vertex i. Vertices are
// represented by their shifts since the substep began, which are small: rounding of positions would act as motion, and
// strands at rest would do a random walk.
enum RodScratch : int {
  kShift = 0,           // 3
  kTangent = 3,         // 3, of an edge; later of the length system
  kStrain = 6,          // 3, of a joint; later the right-hand sides of bending
  kShared = kStrain,    // 3, of an edge: its share of what exact lengths miss between pins, m
  kNormal = 9,          // 3, of the contact plane at a vertex
  kGained = 12,         // 3, bending strain that internal damping adds, per substep of the damping time
  kResidual = kGained,  // length residuals of the dense metric
  kConjugate,           // search direction of conjugate gradients
  kCorrection,          // preconditioned residual
  kFactor1 = 15,        // elimination factors: of twist, later of bending
  kFactor2 = 16,
  kBlend = kFactor2,  // time blend of an edge, until the elimination of bending
  kPivot = 17,        // inverse pivots of bending
  kRight = 18,        // right-hand sides of twist, later of lengths; then tension increments
  kSoftness = 19,     // of a vertex, see curlSoftness()
  kStiffness = 20,    // of a joint, see bendMatrixStiffness()
  kLengthFactor = kStiffness,
  kMargin = 21,            // of a joint, see bendMatrixMargin()
  kLengthPivot = kMargin,  // inverse pivots of lengths
  kRodScratchPlanes = 22
};
static_assert(kRodScratchPlanes == kSolverPlanes);

class RodStep {
 public:
  RodStep(const Block& block, const StepInput& input, Scalar* scratch)
      : b(block),
        in(input),
        p(*input.parameters),
        near_(block, input),
        grooming_(block, input, scratch),
        scratch_(scratch),
        n(block.vertices),
        ne(block.vertices - 1),
        among_bodies_(near_.size() > 0),
        h(static_cast<double>(p.time_step) / p.substeps) {
    begin_ = loadRoot(b, 0);
    end_ = loadRoot(b, kRootPlanes / 2);
    frame_ = begin_.rotation;
    const DragStep drag(p.air_drag, h);
    keep_ = drag.keep;
    time2_ = drag.time2;
    damped_ = p.damping_time > 0;
    ahead_ = lit(p.damping_time / h);
  }

  void run() {
    computeTraits();
    if (among_bodies_) {
      flagContactForces();
      near_.initSeparationBounds(in, scratch_ + solverScratch(n, kLanes) + groomingScratch(n, kLanes));
    }
    for (int substep = 0; substep < p.substeps; ++substep) {
      const double time = (substep + 1.0) / p.substeps;
      near_.place(in, time);
      const RootFrame root{madd(end_.position - begin_.position, lit(time), begin_.position),
                           interpolateRotation(begin_.rotation, end_.rotation, lit(time))};
      near_.placeRoots(root.position);
      predict(root, time);
      eliminateTwist();
      eliminateBending();
      in_length_pass_ = maskAll();
      near_contact_ = in_contact_ = !in_length_pass_;
      nearness_ = lit(0);
      moveByForces();
      const real most = substituteLengths();
      const mask dense_metric = needsDenseMetric(most, correction_limit_) && !taut_;
      const mask eliminated = isEliminated(stiffest_, most, correction_limit_, in_contact_) || taut_;
      if (anyTrue(dense_metric && !eliminated)) applyTensionsThroughBending(dense_metric && !eliminated);
      if (anyTrue(eliminated)) eliminateTensions(eliminated);
      in_length_pass_ = dense_metric || near_contact_;
      if (anyTrue(in_length_pass_)) {
        applyTensions();
        substituteLengths();
      }
      const real overshot = overshoot(most, select(between_pins_, lit(1), nearness_));
      const bool any_overshot = anyTrue(overshot > lit(0));
      const real before = any_overshot ? fastest() : lit(0);
      const real speed = finish(any_overshot);
      if (any_overshot) clampVelocities(velocityClamp(speed, before, overshot, between_pins_));
      frame_ = root.rotation;
    }
    if (!among_bodies_ && !in.primitives.empty())
      for (int i = 0; i < n; ++i) store3(zero3(), b.contact, i);
  }

 private:
  real get(int plane, int i) const { return load(scratch_ + row(plane, i)); }
  void set(int plane, int i, const real& v) { store(v, scratch_ + row(plane, i)); }
  real3 get3(int plane, int i) const { return {get(plane, i), get(plane + 1, i), get(plane + 2, i)}; }
  void set3(int plane, int i, const real3& v) {
    set(plane, i, v.x);
    set(plane + 1, i, v.y);
    set(plane + 2, i, v.z);
  }
  size_t row(int plane, int i) const { return (static_cast<size_t>(i) * kRodScratchPlanes + plane) * kLanes; }
  real state(const Scalar* planes, int plane, int i) const { return load(planes + at(plane, i)); }
  template <class Rows>
  real3 state3(const Rows& rows, int i) const {
    return load3(rows, i);
  }
  quat state4(const Scalar* planes, int i) const {
    return {state(planes, 0, i), state(planes, 1, i), state(planes, 2, i), state(planes, 3, i)};
  }
  void setState4(Scalar* planes, int i, const quat& v) const {
    store(v.x, planes + at(0, i));
    store(v.y, planes + at(1, i));
    store(v.z, planes + at(2, i));
    store(v.w, planes + at(3, i));
  }
  real lengthOf(int e) const { return state(b.rest_length, 0, e); }
  real inverseLength(int e) const { return load(massData(b, kInverseLength, e)); }
  real bend(int j) const { return state(b.bend, 0, j); }
  real twist(int j) const { return state(b.twist, 0, j); }
  // Damping time of joint j, in substeps.
  real ahead(int j) const { return b.grooming == nullptr ? ahead_ : ahead_ * groomingFactor(b, kDampingScale, j); }
  real ownMass(int i) const { return load(massData(b, kMass, i)); }
  real ownWeight(int i) const { return load(massData(b, kWeight, i)); }
  real mass(int i) const { return grooming_.on() ? grooming_.mass(i) : ownMass(i); }
  real weight(int i) const { return grooming_.on() ? grooming_.weight(i) : ownWeight(i); }
  // Weight of the outer vertex of edge e or, if that is pinned, of the inner one. Otherwise the last edge before a pin
  // would have another time blend than the edges before it, and tremble.
  real freeWeight(int e) const {
    const real outer = weight(e + 1);
    return b.pinned && e > 0 ? select(outer > lit(0), outer, weight(e)) : outer;
  }
  // edgeAnchoring() of edge e if it is anchored, otherwise 0.
  real anchoring(int e) const {
    if (e > 0 && !b.pinned) return lit(0);
    const real anchored = edgeAnchoring(get(kStiffness, e), get(kMargin, e), get(kMargin, e + 1));
    return e > 0 ? select(weight(e) > lit(0), lit(0), anchored) : anchored;
  }

  void computeTraits();
  void computeBendTraits();
  real airAccelerationBound(int i, const real& wind) const;
  real maxTautness() const;
  void predict(const RootFrame& root, double time);
  real3 ownShift(int i) const;
  real3 inertialShift(int i, const real3& own, const RootFrame& root, double time) const;
  void eliminateTwist();
  void eliminateBending();
  void moveByForces();
  void applyTensions();
  template <class Shift>
  void moveAndEliminateLengths(Shift shift);
  void findContact(int i, const real3& shift, const real3& moved);
  void holdAtContact(int i, const real3& x, const real3& moved);
  void pressThroughBending();
  struct HeldRow;
  HeldRow& heldRow(int i) const;
  real substituteLengths();
  void applyTensionsThroughBending(const mask& dense_metric);
  void eliminateTensions(const mask& strands);
  class BentMoves;
  class TensionShifts;
  real fastest() const;
  real finish(bool any_overshot);
  void shareMissing();
  void clampVelocities(const real& part);
  real3 collide(int i, const real3& shift);
  real3 pressed(int i, const real3& shift, const real3& x);
  real3 resolvePenetration(int i, const real3& shift, const real3& inner);
  real3 rotatedOutOfBodies(int i, const real3& placed, const real3& inner, const mask& lanes);
  bool hasNormal(int i) const { return among_bodies_ && has_normal_[i]; }
  real3 normalAt(int i) const { return hasNormal(i) ? get3(kNormal, i) : zero3(); }
  // Part of a push on vertex i that contact does not cancel.
  real3 heldAt(int i, const real3& push) const { return hasNormal(i) ? alongSurface(push, get3(kNormal, i)) : push; }
  // Length residual of edge e for the length solve. Taut strands have none in the second length pass unless a body is
  // near: elimination has solved their lengths.
  real lengthResidualOf(int e, const real& length) const {
    const real excess = length - lengthOf(e);
    if (!b.pinned) return excess;
    return select(in_length_pass_ || !taut_, lengthResidual(excess, e > 0 ? weight(e) : lit(0), weight(e + 1)), lit(0));
  }
  void flagContactForces();
  void recordContact(int i, const real& gap, const mask& pressed) {
    near_contact_ = near_contact_ || gap < contactReach() || pressed;
    nearness_ = max(nearness_, select(weight(i) > lit(0), nearness(gap), lit(0)));
  }

  const Block& b;
  const StepInput& in;
  const Parameters& p;
  NearBodies near_;
  Grooming grooming_;
  Scalar* scratch_;
  const int n, ne;
  const bool among_bodies_;
  const double h;
  double keep_ = 1, time2_ = 0;  // see DragStep
  bool damped_ = false;
  real ahead_;               // damping time in substeps, without factors of joints
  real root_spin_ = lit(0);  // radians, rotation of the root about its tangent in this substep
  RootFrame begin_, end_;
  quat frame_;  // of the root after the last substep

  RootFrame root_;             // at the end of this substep
  quat inner_frame_;           // of the root, without the swing of its tangent in this substep
  real3 tangent_old_, swing_;  // root tangent before the substep, and its change
  real3 jump_;                 // m, displacement of the root beyond its velocity
  // Per vertex among bodies: whether some lane has a contact force, and a contact normal in this substep. Most have
  // none.
  bool has_force_[kMaxVerticesPerStrand], has_normal_[kMaxVerticesPerStrand];
  mask kinked_, cut_unevenly_;  // strands for which isKinked() and isCutUnevenly() hold
  mask between_pins_, taut_;    // strands with a free vertex before a pinned one; of these the taut ones, see isTaut()
  real stiffest_;               // greatest stiffness ratio kappa of a strand, see stiffnessOf()
  real correction_limit_;       // see correctionLimit()
  mask in_length_pass_;  // strands whose lengths are solved in this pass: first all, then those that need the second length pass
  mask near_contact_;    // strands with a vertex that a body is near in this substep or has pressed
  real nearness_;        // nearness() of the nearest body to any vertex of the strand in this substep
  mask in_contact_;      // strands with a vertex that a body presses or has pressed
  real max_tension_;     // bound on the tension that is kept between substeps, see tensionBound()
};

// Notes which vertices have a contact force at the start of the step.
inline void RodStep::flagContactForces() {
  for (int i = 0; i < n; ++i) {
    const real3 force = state3(b.contact, i);
    has_force_[i] = anyTrue(!(abs(force.x) + abs(force.y) + abs(force.z) <= lit(0)));  // also if NaN
  }
}

// Displacement of vertex i in this substep without forces, docs/solver.md (4). Precondition: jump_ is set.
inline real3 RodStep::ownShift(int i) const { return madd(state3(b.velocity, i), lit(h * keep_), jump_); }
// Displacement of vertex i to its inertial point: ownShift() with the vertex's air drag factor. Pinned vertices ride on
// their bones.
inline real3 RodStep::inertialShift(int i, const real3& own, const RootFrame& root, double time) const {
  const real3 shift = grooming_.on() ? madd(state3(b.velocity, i), grooming_.keep(i) * lit(h), jump_) : own;
  if (!b.pinned) return shift;
  return select(weight(i) > lit(0), shift, heldPoint(b, root, i, time) - state3(b.position, i));
}

// Sweep 1, root to tip, docs/solver.md (3) to (8), (23): root motion, inertial points, tangents at the time blend of
// old and inertial edges, parallel transport of frames. Queues the contact queries.
inline void RodStep::predict(const RootFrame& root, double time) {
  const StepScope scope{StepPart::kPredict};
  root_ = root;
  const real3 x0 = state3(b.position, 0);
  const real3 tangent_new = frameTangent(root.rotation);
  tangent_old_ = frameTangent(frame_);
  swing_ = tangent_new - tangent_old_;
  inner_frame_ = multiply(rotationBetween(tangent_new, tangent_old_), root.rotation);
  jump_ = root.position - madd(state3(b.velocity, 0), lit(h), x0);
  if (damped_) root_spin_ = spinBetween(frame_, inner_frame_);
  real3 before = x0, shift_in = root.position - x0;
  set3(kShift, 0, shift_in);
  real3 unit_before = tangent_old_;
  for (int e = 0; e < ne; ++e) {
    const real3 x = state3(b.position, e + 1), own = ownShift(e + 1), shift = inertialShift(e + 1, own, root, time);
    set3(kShift, e + 1, shift);
    if (among_bodies_) {
      const StepScope contact{StepPart::kContact};
      near_.queueContactQuery(e + 1, x + own, x);
      has_normal_[e + 1] = false;
      if (has_force_[e + 1]) store3(state3(b.contact, e + 1) * lit(time2_), b.contact, e + 1);
    }
    const real3 old = x - before, advance = shift - shift_in;
    const real3 edge = old + advance;
    const real il = inverseLength(e);
    const real3 unit = old * il;
    const real kept =
        min(keptTension(state(b.tension, 0, e) * lit(time2_), advance * il, bend(e), il, lit(time2_)), max_tension_);
    store(kept, b.tension + at(0, e));
    const real kappa = select(cut_unevenly_, stiffest_, stiffnessOf(bend(e), il, lit(time2_), freeWeight(e)));
    const real blend = timeBlend(advance * il, unit - unit_before, kappa, kinked_);
    set(kBlend, e, blend);
    const quat frame = state4(b.frame, e);
    const real3 tangent = frameTangent(frame), t = directionOr(madd(advance, lit(0) - blend, edge), tangent);
    set3(kTangent, e, t);
    setState4(b.frame, e, transportTo(frame, tangent, t));
    before = x;
    shift_in = shift;
    unit_before = unit;
  }
  near_.runContactQueries();
}

// Sweep 2, root to tip, docs/solver.md (9), (10): joint strains, stiffnesses and margins, and elimination of the twist
// system.
inline void RodStep::eliminateTwist() {
  const StepScope scope{StepPart::kTwist};
  quat inner = inner_frame_;
  real3 t_in = tangent_old_, shift_in = get3(kShift, 0);
  real3 turned_in = makeReal3(lit(0), lit(0), root_spin_);  // the swing of the root is in the forces
  real factor = lit(0), right = lit(0), diagonal = lit(0), lower = lit(0), torque_before = lit(0);
  for (int j = 0; j < ne; ++j) {
    const quat q = state4(b.frame, j);
    const real3 t = get3(kTangent, j);
    const real kb = bend(j), kt = twist(j), ahead_here = ahead(j);
    const real3 strain = jointStrain(inner, q);
    const real3 excess = strain - state3(b.rest_strain, j);
    const real c = dot(t_in, t);
    const real stiffness = bendMatrixStiffness(kb, c, madd(implicitShare(get(kBlend, j)), lit(time2_), ahead_here * lit(time2_)));
    set3(kStrain, j, strain);
    set(kStiffness, j, stiffness);
    set(kMargin, j, bendMatrixMargin(stiffness, c, excess, kinked_));

    real coupling = twistOfBending(strain, excess, kb), shear = torqueDifference(strain, excess, kb);
    if (damped_) {
      const real3 shift = get3(kShift, j + 1), turned = turningOf(q, (shift - shift_in) * inverseLength(j));
      const real3 gained = gainedStrain(strain, turned_in, turned);
      set3(kGained, j, gained);
      coupling = coupling + twistOfDamping(strain, kb, ahead_here);
      shear = shear + torqueDifference(strain, gained * ahead_here, kb);
      shift_in = shift;
      turned_in = turned;
    }
    const real own = kt + coupling, across = coupling - kt;
    if (j > 0) {  // row j - 1 is complete now
      const real r = madd(kt, excess.z, shear) - torque_before;
      const real pivot = inverse(max(diagonal + own - lower * factor, lit(1e-30)));
      right = (r - lower * right) * pivot;
      factor = across * pivot;
      set(kFactor1, j - 1, factor);
      set(kRight, j - 1, right);
      lower = across;
    }
    diagonal = own;
    inner = q;
    t_in = t;
    torque_before = madd(kt, excess.z, lit(0) - shear);
  }
  const real pivot = inverse(max(diagonal - lower * factor, lit(1e-30)));
  set(kRight, ne - 1, (lit(0) - torque_before - lower * right) * pivot);
  for (int j = ne; j < ne + 2; ++j) {
    set(kStiffness, j, lit(0));
    set(kMargin, j, lit(0));
  }
}

// Sweep 3, tip to root, docs/solver.md (11) to (14): substitution of twist, forces, and elimination of the bending
// system.
inline void RodStep::eliminateBending() {
  const StepScope scope{StepPart::kBend};
  const real3 lambda = fill3(p.gravity) * lit(time2_) + fill3(p.wind) * lit(h * (1 - keep_)) - jump_;
  real turn = get(kRight, ne - 1);
  quat outer = twistFrame(state4(b.frame, ne - 1), clamp(turn, lit(-1), lit(1)));
  real3 t = get3(kTangent, ne - 1), t_out = t, t_out2 = t;
  real3 moment_out = zero3(), force_out = zero3(), y1 = zero3(), y2 = zero3();
  // Of the rows of the next two vertices outwards, after elimination of the vertices farther out: inverse pivots and
  // row sums. In the whole matrix, rows sum to the masses, because a translation does not bend the strand. Pivots are
  // computed from row sums, which avoids cancellation between large stiffnesses.
  real id1 = lit(0), id2 = lit(0), sum1 = lit(0), sum2 = lit(0);
  real across = lit(0);                      // couples the vertex to the next one outwards, after elimination
  real second = lit(0), second_in = lit(0);  // couple the vertex, and the one inside it, to the next but one outwards
  for (int e = ne - 1; e >= 0; --e) {
    const real3 t_in = e > 0 ? get3(kTangent, e - 1) : t;
    const real turn_in = e > 0 ? get(kRight, e - 1) - get(kFactor1, e - 1) * turn : lit(0);
    const real phi = clamp(turn, lit(-1), lit(1)), phi_in = clamp(turn_in, lit(-1), lit(1));
    const quat inner = e > 0 ? twistFrame(state4(b.frame, e - 1), phi_in) : inner_frame_;
    setState4(b.frame, e, outer);
    const real kb = bend(e), il = inverseLength(e);
    const real3 untwisted = get3(kStrain, e), strain = twistedStrain(untwisted, phi_in, phi);
    real3 excess = strain - state3(b.rest_strain, e);
    if (damped_) excess = dampedExcess(excess, get3(kGained, e), untwisted, strain, ahead(e));
    const real3 moment = jointMoment(inner, strain, excess, kb, twist(e));
    const real kept = state(b.tension, 0, e);

    real3 force = cross(moment_out - moment, t) * (il * lit(time2_)) - t * kept;
    if (e == 0) force = force + swing_ * (get(kStiffness, 0) * il);
    const real m = mass(e + 1);
    const real3 way = b.acceleration != nullptr ? madd(accelerationOf(b, e + 1), lit(time2_), lambda) : lambda;
    real3 total = grooming_.on() ? grooming_.loadTowardsGoal(e + 1, way, root_, get3(kShift, e + 1)) + (force - force_out)
                                 : madd(way, select(weight(e + 1) > lit(0), m, lit(0)), force - force_out);
    if (among_bodies_ && has_force_[e + 1]) total = total + state3(b.contact, e + 1);

    const real il_in = e > 0 ? inverseLength(e - 1) : lit(0), il_out = e + 1 < ne ? inverseLength(e + 1) : lit(0);
    const real k0 = get(kStiffness, e), k1 = get(kStiffness, e + 1);
    const real edge = edgeMatrixStiffness(get(kMargin, e) + get(kMargin, e + 1), il, kept, get(kBlend, e));
    set(kSoftness, e + 1, curlSoftness(weight(e + 1), k1, il, t_in, t, t_out, t_out2, anchoring(e)));

    const real l1 = across * id1, l2 = second * id2;
    const real sum = m - l1 * sum1 - l2 * sum2;
    const real across_in = bendAcross(k0, k1, il_in, il, il_out) - edge - second_in * l1;
    const real second_in2 = bendAcrossTwo(k0, il_in, il);
    const real pivot = inverse(sum - across_in - second_in2);
    const real3 y = total - y1 * l1 - y2 * l2;
    set3(kStrain, e, y * pivot);
    set(kFactor1, e, l1);
    set(kFactor2, e, l2);
    set(kPivot, e, pivot);
    y2 = y1;
    y1 = y;
    id2 = id1;
    id1 = pivot;
    sum2 = sum1;
    sum1 = sum;
    across = across_in;
    second = second_in;
    second_in = second_in2;
    force_out = force;
    moment_out = moment;
    t_out2 = t_out;
    t_out = t;
    t = t_in;
    turn = turn_in;
    outer = inner;
  }
}

// Contact of vertex i on its own (by its mass alone), at `shift` from its old position. Returns the resulting shift.
inline real3 RodStep::collide(int i, const real3& shift) {
  const StepScope scope{StepPart::kContact};
  const real3 x = state3(b.position, i) + shift;
  near_.requeryIfMoved(i, x, state3(b.position, i), in_length_pass_);
  return near_.hasContactPlane(i) || has_force_[i] ? pressed(i, shift, x) : shift;
}

// collide() for a vertex that may touch a body. Stores the contact normal for the length solve, which must not push the
// vertex back in. Not inlined, so that sweeps of strands far from bodies stay small.
[[gnu::noinline]] inline real3 RodStep::pressed(int i, const real3& shift, const real3& x) {
  const real3 before = has_force_[i] ? state3(b.contact, i) : zero3();
  const mask pressed_before = dot(before, before) > lit(0);
  const real gap = near_.gap(i, x);
  recordContact(i, gap, pressed_before);
  const mask touches = in_length_pass_ && (gap < lit(0) || pressed_before) && weight(i) > lit(0);
  if (!anyTrue(touches)) return shift;
  const ContactPlane plane = near_.deepestPlane(i, x);
  real3 force = before;
  const real3 out =
      resolveContact(x, plane.carried, plane.normal, plane.gap, plane.friction, select(touches, weight(i), lit(1)), force);
  const mask presses = touches && (plane.gap < lit(0) || dot(force, force) > lit(0));
  store3(select(touches, force, before), b.contact, i);
  set3(kNormal, i, select(presses, plane.normal, normalAt(i)));
  has_force_[i] = has_normal_[i] = true;
  set(kSoftness, i, select(presses, lit(0), get(kSoftness, i)));
  return select(touches, out - state3(b.position, i), shift);
}

// Displacements by the tension increments, from root to tip, one vertex after another.
class RodStep::TensionShifts {
 public:
  explicit TensionShifts(const RodStep& step) : s_(step), pull_(step.get(kRight, 0)), t_(step.get3(kTangent, 0)) {}
  // Tension of edge e plus its increment.
  real tension(int e) const { return s_.state(s_.b.tension, 0, e) + pull_; }
  // Shift of the outer vertex of edge e after the tension increments on both sides. Call it once per edge, in order.
  real3 shifted(int e) {
    const real lambda_in = pull_;
    const real3 t_in = t_;
    const bool last = e + 1 == s_.ne;
    pull_ = last ? lit(0) : s_.get(kRight, e + 1);
    t_ = last ? zero3() : s_.get3(kTangent, e + 1);
    const real3 push = shiftByTensions(t_in, lambda_in, t_, pull_, s_.get(kSoftness, e + 1));
    return madd(s_.heldAt(e + 1, push), s_.weight(e + 1), s_.get3(kShift, e + 1));
  }

 private:
  const RodStep& s_;
  real pull_;  // increment of the edge after the current vertex
  real3 t_;
};

// From root to tip: sets the shift of the outer vertex of each edge e to shift(e), updates tangents, and eliminates the
// length system.
template <class Shift>
void RodStep::moveAndEliminateLengths(Shift shift) {
  real3 old_in = state3(b.position, 0), shift_in = get3(kShift, 0);
  real3 t_in = zero3(), normal_in = t_in, normal_in2 = t_in;
  real w_in = lit(0), w_in2 = lit(0);
  real own = lit(0), excess = lit(0), lower = lit(0), right = lit(0), factor = lit(0);
  // Eliminates row e and returns its inverse pivot. `own_out`: diagonal entry by its outer vertex.
  auto eliminate = [&](int e, const real& own_out) {
    real diagonal = own + own_out;
    if (among_bodies_) diagonal = diagonal + lengthHeld(t_in, normal_in2, w_in2, normal_in, w_in);
    const real pivot = inverse(max(diagonal - lower * factor, lengthPivot(w_in2, w_in)));
    right = (excess - lower * right) * pivot;
    set(kRight, e, right);
    set(kLengthPivot, e, pivot);
    return pivot;
  };
  for (int e = 0; e < ne; ++e) {
    const real3 t_before = get3(kTangent, e);
    const real3 shifted = shift(e);
    set3(kShift, e + 1, shifted);
    const real3 old = state3(b.position, e + 1), edge = (old - old_in) + (shifted - shift_in);
    const real3 t = directionOr(edge, t_before);
    set3(kTangent, e, t);
    if (e > 0) {
      const real soft = get(kSoftness, e), c = dot(t_in, t);
      real along_in = weightAlong(w_in, soft, c), along = along_in, across = lengthAcross(w_in, soft, c);
      if (hasNormal(e)) {
        along_in = along_in - weightHeld(t_in, t_in, normal_in, w_in);
        along = along - weightHeld(t, t, normal_in, w_in);
        across = across + weightHeld(t_in, t, normal_in, w_in);
      }
      const real pivot = eliminate(e - 1, along_in);
      lower = across;
      factor = lower * pivot;
      set(kLengthFactor, e, factor);  // of row e on row e - 1; the matrix is symmetric
      own = along;
    }
    w_in2 = w_in;
    w_in = weight(e + 1);
    excess = lengthResidualOf(e, dot(edge, t));
    old_in = old;
    shift_in = shifted;
    t_in = t;
    normal_in2 = normal_in;
    normal_in = normalAt(e + 1);
  }
  eliminate(ne - 1, hasNormal(ne) ? w_in - weightHeld(t_in, t_in, normal_in, w_in) : w_in);
}

// Substitution of the bending system from root to tip: displacements, one vertex after another.
class RodStep::BentMoves {
 public:
  explicit BentMoves(const RodStep& step) : s_(step) {}
  // Displacement of the outer vertex of edge e. Call it once per edge, in order.
  real3 next(int e) {
    const real3 d = s_.get3(kStrain, e) - d1_ * l1_in_ - d2_ * l2_in2_;
    l1_in_ = s_.get(kFactor1, e);
    l2_in2_ = l2_in_;
    l2_in_ = s_.get(kFactor2, e);
    d2_ = d1_;
    d1_ = d;
    return d;
  }

 private:
  const RodStep& s_;
  real3 d1_ = zero3(), d2_ = d1_;
  real l1_in_ = lit(0), l2_in_ = lit(0), l2_in2_ = lit(0);
};

// Sweep 4, root to tip, docs/solver.md (15), (16): displacements by forces, contact through the bending matrix, and
// elimination of the length system.
inline void RodStep::moveByForces() {
  const StepScope scope{StepPart::kMove};
  BentMoves moves(*this);
  real3 moved;
  auto byForces = [&](int e) {
    moved = moves.next(e);
    const real3 shift = get3(kShift, e + 1);
    return b.pinned ? select(weight(e + 1) > lit(0), shift + moved, shift) : shift + moved;
  };
  if (!among_bodies_) return moveAndEliminateLengths(byForces);
  for (int e = 0; e < ne; ++e) {
    const real3 shift = byForces(e);
    set3(kShift, e + 1, shift);
    findContact(e + 1, shift, moved);
  }
  if (anyTrue(in_contact_))
    pressThroughBending();
  else
    for (int i = 1; i < n; ++i) has_normal_[i] = false;
  moveAndEliminateLengths([&](int e) { return get3(kShift, e + 1); });
}

// Sweep 5, tip to root: substitution of the length system. Returns the greatest correction strain of each strand,
// docs/solver.md (20).
inline real RodStep::substituteLengths() {
  const StepScope scope{StepPart::kTensions};
  real lambda = get(kRight, ne - 1), most = lit(0);
  for (int e = ne - 1; e >= 0; --e) {
    set(kRight, e, lambda);
    most = max(most, correctionStrain(lambda, e > 0 ? weight(e) : lit(0), weight(e + 1), inverseLength(e)));
    if (e > 0) lambda = get(kRight, e - 1) - get(kLengthFactor, e) * lambda;
  }
  return most;
}

// Finds and applies the tension increments of strands with the dense metric, docs/solver.md (21), by preconditioned
// conjugate gradients (Shewchuk 1994, algorithm B3). Leaves no increments for applyTensions(), and softness 0, so that
// the second length pass is in the metric of the masses.
inline void RodStep::applyTensionsThroughBending(const mask& dense_metric) {
  const StepScope scope{StepPart::kTensions};
  real product = lit(0);  // residual . preconditioned residual
  real3 old_in = state3(b.position, 0), shift_in = get3(kShift, 0);
  for (int e = 0; e < ne; ++e) {
    const real3 old = state3(b.position, e + 1), shift = get3(kShift, e + 1);
    const real correction = get(kRight, e);
    const real3 edge = (old - old_in) + (shift - shift_in);
    const real excess = lengthResidualOf(e, dot(edge, get3(kTangent, e)));
    set(kResidual, e, excess);
    set(kConjugate, e, lit(0));
    set(kCorrection, e, correction);
    set(kRight, e, select(dense_metric, lit(0), correction));
    set(kSoftness, e + 1, select(dense_metric, lit(0), get(kSoftness, e + 1)));
    product = madd(excess, correction, product);
    old_in = old;
    shift_in = shift;
  }
  real kept = lit(0);  // share of the last search direction in the new one
  for (int iteration = 1;; ++iteration) {
    // Tip to root: the search direction, and elimination of bending under its tensions.
    real3 t_out = zero3(), y1 = zero3(), y2 = zero3();
    real lambda_out = lit(0);
    for (int e = ne - 1; e >= 0; --e) {
      const real lambda = madd(get(kConjugate, e), kept, get(kCorrection, e));
      set(kConjugate, e, lambda);
      const real3 t = get3(kTangent, e);
      const real3 push = heldAt(e + 1, shiftByTensions(t, lambda, t_out, lambda_out, lit(0)));
      const real3 y = select(weight(e + 1) > lit(0), push, zero3()) - y1 * get(kFactor1, e) - y2 * get(kFactor2, e);
      set3(kStrain, e, y * get(kPivot, e));
      y2 = y1;
      y1 = y;
      lambda_out = lambda;
      t_out = t;
    }
    // Root to tip: displacements by the direction, and how much they shorten the edges.
    BentMoves moves(*this);
    real3 moved_in = zero3();
    real curvature = lit(0);
    for (int e = 0; e < ne; ++e) {
      const real3 moved = select(weight(e + 1) > lit(0), heldAt(e + 1, moves.next(e)), zero3());
      set3(kStrain, e, moved);
      curvature = madd(get(kConjugate, e), dot(get3(kTangent, e), moved_in - moved), curvature);
      moved_in = moved;
    }
    // Root to tip: the step along the direction, and elimination of the tridiagonal preconditioner.
    const real step = conjugateStep(product, curvature);
    moved_in = zero3();
    real y = lit(0);
    for (int e = 0; e < ne; ++e) {
      const real3 moved = get3(kStrain, e), shift = get3(kShift, e + 1);
      const real tension = state(b.tension, 0, e);
      set3(kShift, e + 1, select(dense_metric, madd(moved, step, shift), shift));
      store(select(dense_metric, madd(get(kConjugate, e), step, tension), tension), b.tension + at(0, e));
      const real residual = get(kResidual, e) - step * dot(get3(kTangent, e), moved_in - moved);
      set(kResidual, e, residual);
      y = e > 0 ? residual - get(kLengthFactor, e) * y : residual;
      set(kCorrection, e, y * get(kLengthPivot, e));
      moved_in = moved;
    }
    if (iteration == kTensionIterations) return;
    // Tip to root: substitution of the preconditioner.
    real correction = lit(0), next = lit(0);
    for (int e = ne - 1; e >= 0; --e) {
      correction = e + 1 < ne ? get(kCorrection, e) - get(kLengthFactor, e + 1) * correction : get(kCorrection, e);
      set(kCorrection, e, correction);
      next = madd(get(kResidual, e), correction, next);
    }
    kept = conjugateStep(next, product);
    product = next;
  }
}

// Second length pass: applies the tension increments of the strands in in_length_pass_, resolves their contacts, and eliminates
// their length system again. The systems of all other strands come out unchanged.
inline void RodStep::applyTensions() {
  const StepScope scope{StepPart::kSecondLengthPass};
  TensionShifts tensions(*this);
  moveAndEliminateLengths([&](int e) {
    store(select(in_length_pass_, tensions.tension(e), state(b.tension, 0, e)), b.tension + at(0, e));
    const real3 shift = select(in_length_pass_, tensions.shifted(e), get3(kShift, e + 1));
    return among_bodies_ ? collide(e + 1, shift) : shift;
  });
}

// Sweep 6, root to tip, docs/solver.md (19), (22): displacements by the last tension increments, exact lengths,
// penetration resolution, velocities. If some strand overshoots, returns the greatest vertex speed of each strand, m/s,
// without displacements by penetration resolution.
inline real RodStep::finish(bool any_overshot) {
  const StepScope scope{StepPart::kVelocities};
  if (b.pinned) shareMissing();
  const real inverse_h = lit(1 / h);
  real3 old_in = state3(b.position, 0), pulled_in = get3(kShift, 0), shift = pulled_in, inner = root_.position;
  real3 turned = zero3();  // m, displacement of the vertex by penetration resolution
  real way2 = lit(0);
  store3(shift * inverse_h, b.velocity, 0);
  store3(inner, b.position, 0);
  TensionShifts tensions(*this);
  for (int e = 0; e < ne; ++e) {
    store(tensions.tension(e) * lit(1 / time2_), b.tension + at(0, e));
    const real3 old = state3(b.position, e + 1), pulled = tensions.shifted(e), advance = pulled - pulled_in;
    real3 exact = advance + missingLength((old - old_in) + advance, get3(kTangent, e), lengthOf(e));
    if (b.pinned) exact = exact + get3(kShared, e);
    shift = select(weight(e + 1) > lit(0), shift + exact, pulled);
    if (among_bodies_) {
      const real3 kept = resolvePenetration(e + 1, shift, inner);
      if (any_overshot) {
        turned = select(weight(e + 1) > lit(0), turned, zero3());
        const real3 went = shift - turned;
        way2 = max(way2, dot(went, went));
        turned = turned + (kept - shift);
      }
      shift = kept;
      if (has_force_[e + 1]) store3(state3(b.contact, e + 1) * lit(1 / time2_), b.contact, e + 1);
    }
    if (any_overshot && !among_bodies_) way2 = max(way2, dot(shift, shift));
    inner = old + shift;
    store3(shift * inverse_h, b.velocity, e + 1);
    store3(inner, b.position, e + 1);
    old_in = old;
    pulled_in = pulled;
  }
  return sqrt(way2) * inverse_h;
}

// Finds which strands are kinked, and their correction limits, from their bends at rest and their stiffness; as
// restBends() of core/strand_model.h.
inline void RodStep::computeBendTraits() {
  real bends = lit(0), changes = lit(0), second_changes = lit(0);
  real3 before = zero3(), change_before = before;
  for (int j = 1; j < ne; ++j) {
    const real3 strain = state3(b.rest_strain, j), change = strain - before, second = change - change_before;
    bends = bends + dot(strain, strain);
    if (j > 1) changes = changes + dot(change, change);
    if (j > 2) second_changes = second_changes + dot(second, second);
    before = strain;
    change_before = change;
  }
  const mask uneven = bendsUnevenly(bends, changes, second_changes, lit(ne - 1));
  kinked_ = isKinked(uneven, stiffest_);
  correction_limit_ = correctionLimit(uneven || isSharp(bends, lit(ne - 1)), stiffest_);
}

// Upper bound of the acceleration of vertex i by air and external forces, without gravity, m/s^2. `wind`: that by wind
// for an air drag factor of 1.
inline real RodStep::airAccelerationBound(int i, const real& wind) const {
  real driven = groomingFactor(b, kAirDragScale, i) * wind;
  if (b.acceleration != nullptr) {
    const real3 own = accelerationOf(b, i);
    driven = driven + sqrt(dot(own, own));
  }
  return driven;
}

// Runs once per step, before its first substep.
inline void RodStep::computeTraits() {
  mask seen_free = maskNone();
  between_pins_ = seen_free;
  real length = lit(0), hung = lit(0), shortest = lengthOf(0), driven = lit(0);
  const real wind = lit(p.air_drag * p.wind.norm());
  stiffest_ = lit(0);
  for (int e = 0; e < ne; ++e) {
    const real il = inverseLength(e);
    stiffest_ = max(stiffest_, stiffnessOf(bend(e), il, lit(time2_), ownWeight(e + 1)));
    length = length + lengthOf(e);
    shortest = min(shortest, lengthOf(e));
    driven = max(driven, airAccelerationBound(e + 1, wind));
    const mask is_free = weight(e + 1) > lit(0);
    between_pins_ = between_pins_ || (seen_free && !is_free);
    seen_free = seen_free || is_free;
    hung = hung + select(is_free, ownMass(e + 1), lit(0));
  }
  computeBendTraits();
  cut_unevenly_ = isCutUnevenly(shortest, length * lit(1.0 / ne));
  const real taut = maxTautness();
  taut_ = isTaut(taut);
  max_tension_ = tensionBound(hung, length, taut * (lit(p.gravity.norm()) + driven), lit(time2_));
}

// Greatest tautness() between any two pins of a strand, for the pin positions at the end of the step; 1 if nothing
// hangs between pins.
inline real RodStep::maxTautness() const {
  real most = lit(1), length = lit(0);  // since the last pin
  if (!b.pinned) return most;
  real3 pin = end_.position;
  mask follows_pin = maskAll();
  for (int e = 0; e < ne; ++e) {
    length = length + lengthOf(e);
    const mask pinned = !(weight(e + 1) > lit(0));
    const real3 held = heldPoint(b, end_, e + 1, 1), span = held - pin;
    most = select(pinned && !follows_pin, max(most, tautness(sqrt(dot(span, span)), length)), most);
    pin = select(pinned, held, pin);
    length = select(pinned, lit(0), length);
    follows_pin = pinned;
  }
  return most;
}

// Distributes what exact lengths miss at a pin over the edges since the last pin, in proportion to their rest lengths.
// With all of it on the last edge, a taut strand that was shaken stayed crumpled, and that edge became as long as all
// others together.
[[gnu::noinline]] inline void RodStep::shareMissing() {
  real3 old_in = state3(b.position, 0), pulled_in = get3(kShift, 0), shift = pulled_in;
  real length = lit(0);  // since the last pin
  TensionShifts tensions(*this);
  for (int e = 0; e < ne; ++e) {
    const real3 old = state3(b.position, e + 1), pulled = tensions.shifted(e), advance = pulled - pulled_in;
    shift = shift + advance + missingLength((old - old_in) + advance, get3(kTangent, e), lengthOf(e));
    length = length + lengthOf(e);
    const mask pinned = !(weight(e + 1) > lit(0));
    set3(kShared, e, select(pinned, (pulled - shift) * inverse(max(length, lit(1e-9))), zero3()));
    shift = select(pinned, pulled, shift);
    length = select(pinned, lit(0), length);
    old_in = old;
    pulled_in = pulled;
  }
  real3 per_length = zero3();
  for (int e = ne - 1; e >= 0; --e) {
    per_length = select(weight(e + 1) > lit(0), per_length, get3(kShared, e));
    set3(kShared, e, per_length * lengthOf(e));
  }
}

// Finds and applies the tension increments of `strands`. Like applyTensionsThroughBending(), it leaves no increments
// for applyTensions(), and softness 0.
inline void RodStep::eliminateTensions(const mask& strands) {
  const StepScope scope{StepPart::kTensions};
  static_assert(sizeof(TensionRow) == kTensionPlanes * kLanes * sizeof(Scalar));
  TensionRow* const rows = reinterpret_cast<TensionRow*>(scratch_ + rodScratch(n, kLanes));
  OuterTensions outside = noOuterTensions();
  for (int e = ne - 1; e >= 0; --e) {
    const mask moves = weight(e + 1) > lit(0), moves_in = lit(e) > lit(0) && weight(e) > lit(0);
    const real3 t = get3(kTangent, e);
    const real3 edge = (state3(b.position, e + 1) - state3(b.position, e)) + (get3(kShift, e + 1) - get3(kShift, e));
    rows[e] = eliminateTension(outside, moves, get(kPivot, e), e > 0 ? get(kFactor1, e - 1) : lit(0),
                               e > 1 ? get(kFactor2, e - 2) : lit(0), select(moves, t, zero3()), select(moves_in, t, zero3()),
                               lengthResidualOf(e, dot(edge, t)), normalAt(e + 1));
  }
  real3 near = zero3(), far = zero3();  // shifts of the next two vertices inwards
  real lambda = firstTension(outside);
  for (int e = 0; e < ne; ++e) {
    const real3 moved = shiftOf(rows[e], near, far, lambda), before = get3(kShift, e + 1);
    const real tension = state(b.tension, 0, e);
    store(select(strands, tension + lambda, tension), b.tension + at(0, e));
    set3(kShift, e + 1, select(strands, before + moved, before));
    set(kRight, e, select(strands, lit(0), get(kRight, e)));
    set(kSoftness, e + 1, select(strands, lit(0), get(kSoftness, e + 1)));
    lambda = tensionOf(rows[e], near, far, lambda);
    far = near;
    near = moved;
  }
}

// Greatest speed per strand of its vertices, root and pins and of the bodies beside it, m/s. Call it before the substep
// stores new velocities.
[[gnu::noinline]] inline real RodStep::fastest() const {
  const StepScope scope{StepPart::kVelocities};
  const real3 root = get3(kShift, 0);
  real way2 = dot(root, root), speed2 = lit(0);
  for (int i = 1; i < n; ++i) {
    const real3 v = state3(b.velocity, i), x = state3(b.position, i), shift = get3(kShift, i);
    speed2 = max(speed2, dot(v, v));
    const real beside2 = among_bodies_ ? near_.carried2(i, x + shift, x) : lit(0);
    way2 = max(way2, select(weight(i) > lit(0), beside2, dot(shift, shift)));
  }
  return sqrt(max(speed2, way2 * lit(1 / (h * h))));
}
// Multiplies the velocities of free vertices by `part`. Call it after the substep has stored them.
[[gnu::noinline]] inline void RodStep::clampVelocities(const real& part) {
  const StepScope scope{StepPart::kVelocities};
  for (int i = 1; i < n; ++i) store3(state3(b.velocity, i) * select(weight(i) > lit(0), part, lit(1)), b.velocity, i);
}

#include "core/rod_contact.inl"

inline void stepRod(const Block& b, const StepInput& input, Scalar* scratch) { RodStep(b, input, scratch).run(); }

inline void stepBlock(const Block& b, const StepInput& input, Scalar* scratch) {
  if (input.parameters->solver == SolverKind::kRod)
    stepRod(b, input, scratch);
  else
    stepGaussSeidel(b, input, scratch);
}
