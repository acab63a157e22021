// One step of a block of strands as inextensible rods: docs/solver.md. Included after core/near_bodies.inl. Linearised at the
// inertial point, with direct solves along the strand: twist (tridiagonal), bending (one pentadiagonal matrix for x, y, z),
// lengths and tensions (tridiagonal). Each solve eliminates in one direction and substitutes in the other, so that they merge
// into six sweeps. Violent motion takes more, for its tensions act through the bending matrix, and has its lengths solved again;
// so have strands that a body is near.

// Scratch, [row][plane][lane], `vertices` + 2 rows. Row e is edge e or joint e, row i vertex i. Vertices are told by their shifts
// since the substep began, in small numbers: what is lost where positions are rounded would be taken for motion, and strands at
// rest would walk at random on it.
enum RodScratch : int {
  kShift = 0,         // 3
  kTangent = 3,       // 3, later of the lengths
  kStrain = 6,        // 3, of a joint, later the right-hand sides of bending
  kShared = kStrain,  // 3, of an edge: its share of what exact lengths leave between pins, m
  kNormal = 9,        // 3, of the contact at a vertex
  kGained = 12,       // 3, strain that internal damping adds, per substep of the damping time
  kResidual = kGained,     // excess lengths that the pulls of violent motion leave
  kConjugate,              // the direction of these pulls
  kCorrection,             // what the tridiagonal system makes of the residual
  kFactor1 = 15,      // elimination factors: of twist, later of bending
  kFactor2 = 16,
  kBlend = kFactor2,  // of an edge, until the elimination of bending
  kPivot = 17,        // inverse pivots of bending
  kRight = 18,        // right-hand sides of twist, later of lengths, then pulls
  kSoftness = 19,     // of a vertex
  kStiffness = 20,    // K of a joint
  kLengthFactor = kStiffness,
  kMargin = 21,       // G of a joint
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
    findTraits();
    if (among_bodies_) {
      noteForces();
      near_.measureRooms(in, scratch_ + solverScratch(n, kLanes) + groomingScratch(n, kLanes));
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
      again_ = lit(0) < lit(1);
      meets_ = touches_ = !again_;
      nearness_ = lit(0);
      moveByForces();
      const real most = substituteLengths();
      const mask violent = isViolent(most, borne_) && !taut_;
      const mask eliminated = isEliminated(stiffest_, most, borne_, touches_) || taut_;
      if (anyTrue(violent && !eliminated)) pullThroughBending(violent && !eliminated);
      if (anyTrue(eliminated)) pullByElimination(eliminated);
      again_ = violent || meets_;
      if (anyTrue(again_)) {
        moveByPulls();
        substituteLengths();
      }
      const real thrown_by = thrownBy(most, select(between_pins_, lit(1), nearness_));
      const bool any_thrown = anyTrue(thrown_by > lit(0));
      const real before = any_thrown ? fastest() : lit(0);
      const real speed = finish(any_thrown);
      if (any_thrown) slowDown(slowed(speed, before, thrown_by, between_pins_));
      frame_ = root.rotation;
    }
    if (!among_bodies_ && !in.primitives.empty())
      for (int i = 0; i < n; ++i) store3(makeReal3(lit(0), lit(0), lit(0)), b.contact, i);
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
  real3 state3(const Rows& rows, int i) const { return load3(rows, i); }
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
  real inverseLength(int e) const { return load(sizeOf(b, kInverseLength, e)); }
  real bend(int j) const { return state(b.bend, 0, j); }
  real twist(int j) const { return state(b.twist, 0, j); }
  // Damping time over the substep.
  real ahead(int j) const { return b.grooming == nullptr ? ahead_ : ahead_ * groomingFactor(b, kDampingScale, j); }
  real ownMass(int i) const { return load(sizeOf(b, kMass, i)); }
  real ownWeight(int i) const { return load(sizeOf(b, kWeight, i)); }
  real mass(int i) const { return grooming_.on() ? grooming_.mass(i) : ownMass(i); }
  real weight(int i) const { return grooming_.on() ? grooming_.weight(i) : ownWeight(i); }
  // Of the outer vertex of edge e or, where that is pinned, of the inner one: else the last edge before a pin would have another time
  // blend than those before it, and tremble.
  real freeWeight(int e) const {
    const real outer = weight(e + 1);
    return b.pinned && e > 0 ? select(outer > lit(0), outer, weight(e)) : outer;
  }
  // Of edge e, where it is anchored; else 0.
  real anchoring(int e) const {
    if (e > 0 && !b.pinned) return lit(0);
    const real anchored = edgeAnchoring(get(kStiffness, e), get(kMargin, e), get(kMargin, e + 1));
    return e > 0 ? select(weight(e) > lit(0), lit(0), anchored) : anchored;
  }

  void findTraits();
  void findBends();
  real drivenByAir(int i, const real& wind) const;
  real mostTautness() const;
  void predict(const RootFrame& root, double time);
  real3 ownShift(int i) const;
  real3 inertialShift(int i, const real3& own, const RootFrame& root, double time) const;
  void eliminateTwist();
  void eliminateBending();
  void moveByForces();
  void moveByPulls();
  template <class Shift>
  void moveAndEliminateLengths(Shift shift);
  void touch(int i, const real3& shift, const real3& moved);
  void touched(int i, const real3& x, const real3& moved);
  void pressThroughBending();
  struct HeldRow;
  HeldRow& heldRow(int i) const;
  real substituteLengths();
  void pullThroughBending(const mask& violent);
  void pullByElimination(const mask& strands);
  class BentMoves;
  class Pulls;
  real fastest() const;
  real finish(bool any_thrown);
  void shareMissing();
  void slowDown(const real& part);
  real3 collide(int i, const real3& shift);
  real3 pressed(int i, const real3& shift, const real3& x);
  real3 keptOut(int i, const real3& shift, const real3& inner);
  real3 turnedOutOfBodies(int i, const real3& placed, const real3& inner, const mask& lanes);
  bool faces(int i) const { return among_bodies_ && faces_[i]; }
  real3 normalAt(int i) const { return faces(i) ? get3(kNormal, i) : makeReal3(lit(0), lit(0), lit(0)); }
  // What contact leaves of a push on vertex i.
  real3 heldAt(int i, const real3& push) const { return faces(i) ? alongSurface(push, get3(kNormal, i)) : push; }
  // What the pull of edge e is to mend: of taut strands nothing more than elimination has.
  real toMend(int e, const real& length) const {
    const real excess = length - lengthOf(e);
    if (!b.pinned) return excess;
    return select(again_ || !taut_, excessToMend(excess, e > 0 ? weight(e) : lit(0), weight(e + 1)), lit(0));
  }
  void noteForces();
  void noteMeeting(int i, const real& gap, const mask& pressed) {
    meets_ = meets_ || gap < contactReach() || pressed;
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
  real ahead_;  // damping time over the substep, without factors of joints
  real root_spin_ = lit(0);  // radians, of the root about its tangent in this substep
  RootFrame begin_, end_;
  quat frame_;          // of the root after the last substep

  RootFrame root_;      // at the end of this substep
  quat inner_frame_;    // of the root, without the swing of this substep
  real3 tangent_old_, swing_;  // root tangent before the substep, and how it changes
  real3 jump_;          // m, unexpected motion of the root
  // Of a vertex among bodies: some lane may have a contact force, and in this substep a normal. Most have none.
  bool forced_[kMaxVerticesPerStrand], faces_[kMaxVerticesPerStrand];
  mask kinked_, cut_unevenly_;  // the strands that are, see isKinked(), isCutUnevenly()
  mask between_pins_, taut_;    // those with a free vertex before one that is pinned, and those that are taut there, see isTaut()
  real stiffest_;  // the greatest kappa of a strand, see stiffnessOf()
  real borne_;     // see violenceBorne()
  mask again_;  // the strands that have their lengths solved now: all, then those that need it again
  mask meets_;  // those with a vertex that a body is near in this substep, or has pressed
  real nearness_;  // of the nearest body to any of its vertices in this substep
  mask touches_;  // those with a vertex that a body presses, or has
  real most_tension_;   // that is taken over from one substep to the next
};

// Which vertices bodies pressed when the step began.
inline void RodStep::noteForces() {
  for (int i = 0; i < n; ++i) {
    const real3 force = state3(b.contact, i);
    forced_[i] = anyTrue(!(abs(force.x) + abs(force.y) + abs(force.z) <= lit(0)));  // also where it is not a number
  }
}

// How far vertex i would go by itself in this substep, whose jump_ is known.
inline real3 RodStep::ownShift(int i) const { return madd(state3(b.velocity, i), lit(h * keep_), jump_); }
// `own` of it with the air drag of its own, to its inertial point; pinned ones ride on their bones.
inline real3 RodStep::inertialShift(int i, const real3& own, const RootFrame& root, double time) const {
  const real3 shift = grooming_.on() ? madd(state3(b.velocity, i), grooming_.keep(i) * lit(h), jump_) : own;
  if (!b.pinned) return shift;
  return select(weight(i) > lit(0), shift, heldPoint(b, root, i, time) - state3(b.position, i));
}

// Root motion, inertial point, tangents between the old edges and the inertial ones, frames carried along with them.
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
      near_.lookAhead(e + 1, x + own, x);
      faces_[e + 1] = false;
      if (forced_[e + 1]) store3(state3(b.contact, e + 1) * lit(time2_), b.contact, e + 1);
    }
    const real3 old = x - before, advance = shift - shift_in;
    const real3 edge = old + advance;
    const real il = inverseLength(e);
    const real3 unit = old * il;
    const real kept = min(keptTension(state(b.tension, 0, e) * lit(time2_), advance * il, bend(e), il, lit(time2_)),
                          most_tension_);
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
  near_.lookAround();
}

// Joint strains, and the elimination of the twist system from root to tip.
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

// Twist substituted, forces, and the elimination of the bending system from tip to root.
inline void RodStep::eliminateBending() {
  const StepScope scope{StepPart::kBend};
  const real3 zero = makeReal3(lit(0), lit(0), lit(0));
  const real3 pull = fill3(p.gravity) * lit(time2_) + fill3(p.wind) * lit(h * (1 - keep_)) - jump_;
  real turn = get(kRight, ne - 1);
  quat outer = twistFrame(state4(b.frame, ne - 1), clamp(turn, lit(-1), lit(1)));
  real3 t = get3(kTangent, ne - 1), t_out = t, t_out2 = t;
  real3 moment_out = zero, force_out = zero, y1 = zero, y2 = zero;
  // Of the rows of the next two vertices outwards, without those still farther out: inverse pivots, and what the rows sum up to. In the
  // matrix they sum up to the masses: moved as a whole, a strand is not bent. Pivots follow from sums, and not by taking from large
  // stiffnesses other large ones.
  real id1 = lit(0), id2 = lit(0), sum1 = lit(0), sum2 = lit(0);
  real across = lit(0);                      // couples the vertex to the next one outwards, without those farther out
  real second = lit(0), second_in = lit(0);  // couple it, and the one inside it, to the next but one outwards
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
    const real3 way = b.acceleration != nullptr ? madd(accelerationOf(b, e + 1), lit(time2_), pull) : pull;
    real3 total = grooming_.on() ? grooming_.pull(e + 1, way, root_, get3(kShift, e + 1)) + (force - force_out)
                                 : madd(way, select(weight(e + 1) > lit(0), m, lit(0)), force - force_out);
    if (among_bodies_ && forced_[e + 1]) total = total + state3(b.contact, e + 1);

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

// Contact of vertex i, shifted so, by itself. Gives its shift.
inline real3 RodStep::collide(int i, const real3& shift) {
  const StepScope scope{StepPart::kContact};
  const real3 x = state3(b.position, i) + shift;
  near_.lookOn(i, x, state3(b.position, i), again_);
  return near_.sees(i) || forced_[i] ? pressed(i, shift, x) : shift;
}

// The same of a vertex that may touch something; the normal is kept for the length solve, which must not push it back in. By
// itself, as keptOut(), so that sweeps of hair that is near no body stay small.
[[gnu::noinline]] inline real3 RodStep::pressed(int i, const real3& shift, const real3& x) {
  const real3 before = forced_[i] ? state3(b.contact, i) : makeReal3(lit(0), lit(0), lit(0));
  const mask pressed_before = dot(before, before) > lit(0);
  const real gap = near_.gap(i, x);
  noteMeeting(i, gap, pressed_before);
  const mask touches = again_ && (gap < lit(0) || pressed_before) && weight(i) > lit(0);
  if (!anyTrue(touches)) return shift;
  const Touch touch = near_.touch(i, x);
  real3 force = before;
  const real3 out = resolveContact(x, touch.carried, touch.normal, touch.gap, touch.friction, select(touches, weight(i), lit(1)), force);
  const mask presses = touches && (touch.gap < lit(0) || dot(force, force) > lit(0));
  store3(select(touches, force, before), b.contact, i);
  set3(kNormal, i, select(presses, touch.normal, normalAt(i)));
  forced_[i] = faces_[i] = true;
  set(kSoftness, i, select(presses, lit(0), get(kSoftness, i)));
  return select(touches, out - state3(b.position, i), shift);
}

// The pulls from root to tip, one vertex after another.
class RodStep::Pulls {
 public:
  explicit Pulls(const RodStep& step) : s_(step), pull_(step.get(kRight, 0)), t_(step.get3(kTangent, 0)) {}
  // The tension of edge e with its pull.
  real tension(int e) const { return s_.state(s_.b.tension, 0, e) + pull_; }
  // The shift that the pulls on both its sides leave the outer vertex of edge e with.
  real3 shifted(int e) {
    const real pull_in = pull_;
    const real3 t_in = t_;
    const bool last = e + 1 == s_.ne;
    pull_ = last ? lit(0) : s_.get(kRight, e + 1);
    t_ = last ? makeReal3(lit(0), lit(0), lit(0)) : s_.get3(kTangent, e + 1);
    const real3 push = pushOfPulls(t_in, pull_in, t_, pull_, s_.get(kSoftness, e + 1));
    return madd(s_.heldAt(e + 1, push), s_.weight(e + 1), s_.get3(kShift, e + 1));
  }

 private:
  const RodStep& s_;
  real pull_;  // of the edge after the vertex last asked for
  real3 t_;
};

// From root to tip: every vertex shifted by shift(e) in all, edge e before it, and the elimination of the length system.
template <class Shift>
void RodStep::moveAndEliminateLengths(Shift shift) {
  real3 old_in = state3(b.position, 0), shift_in = get3(kShift, 0);
  real3 t_in = makeReal3(lit(0), lit(0), lit(0)), normal_in = t_in, normal_in2 = t_in;
  real w_in = lit(0), w_in2 = lit(0);
  real own = lit(0), excess = lit(0), lower = lit(0), right = lit(0), factor = lit(0);
  // Row e with `own_out`, what its outer vertex has on its diagonal; gives its inverse pivot.
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
      if (faces(e)) {
        along_in = along_in - weightHeld(t_in, t_in, normal_in, w_in);
        along = along - weightHeld(t, t, normal_in, w_in);
        across = across + weightHeld(t_in, t, normal_in, w_in);
      }
      const real pivot = eliminate(e - 1, along_in);
      lower = across;
      factor = lower * pivot;
      set(kLengthFactor, e, factor);  // of row e on row e - 1; symmetric
      own = along;
    }
    w_in2 = w_in;
    w_in = weight(e + 1);
    excess = toMend(e, dot(edge, t));
    old_in = old;
    shift_in = shifted;
    t_in = t;
    normal_in2 = normal_in;
    normal_in = normalAt(e + 1);
  }
  eliminate(ne - 1, faces(ne) ? w_in - weightHeld(t_in, t_in, normal_in, w_in) : w_in);
}

// The bending system substituted from root to tip: what it moves one vertex after another.
class RodStep::BentMoves {
 public:
  explicit BentMoves(const RodStep& step) : s_(step) {}
  // The outer vertex of edge e.
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
  real3 d1_ = makeReal3(lit(0), lit(0), lit(0)), d2_ = d1_;
  real l1_in_ = lit(0), l2_in_ = lit(0), l2_in2_ = lit(0);
};

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
    touch(e + 1, shift, moved);
  }
  if (anyTrue(touches_)) pressThroughBending();
  else for (int i = 1; i < n; ++i) faces_[i] = false;
  moveAndEliminateLengths([&](int e) { return get3(kShift, e + 1); });
}

// The length system substituted from tip to root; gives the strand's violence.
inline real RodStep::substituteLengths() {
  const StepScope scope{StepPart::kPulls};
  real pull = get(kRight, ne - 1), most = lit(0);
  for (int e = ne - 1; e >= 0; --e) {
    set(kRight, e, pull);
    most = max(most, violence(pull, e > 0 ? weight(e) : lit(0), weight(e + 1), inverseLength(e)));
    if (e > 0) pull = get(kRight, e - 1) - get(kLengthFactor, e) * pull;
  }
  return most;
}

// The pulls of violent motion, and what they move, found by conjugate gradients. Leaves none for moveByPulls(), and the
// second length system in the metric of the masses.
inline void RodStep::pullThroughBending(const mask& violent) {
  const StepScope scope{StepPart::kPulls};
  const real3 zero = makeReal3(lit(0), lit(0), lit(0));
  real product = lit(0);  // residual x correction
  real3 old_in = state3(b.position, 0), shift_in = get3(kShift, 0);
  for (int e = 0; e < ne; ++e) {
    const real3 old = state3(b.position, e + 1), shift = get3(kShift, e + 1);
    const real correction = get(kRight, e);
    const real3 edge = (old - old_in) + (shift - shift_in);
    const real excess = toMend(e, dot(edge, get3(kTangent, e)));
    set(kResidual, e, excess);
    set(kConjugate, e, lit(0));
    set(kCorrection, e, correction);
    set(kRight, e, select(violent, lit(0), correction));
    set(kSoftness, e + 1, select(violent, lit(0), get(kSoftness, e + 1)));
    product = madd(excess, correction, product);
    old_in = old;
    shift_in = shift;
  }
  real kept = lit(0);  // of the last direction
  for (int iteration = 1;; ++iteration) {
    // Tip to root: the direction, and the elimination of bending under its pulls.
    real3 t_out = zero, y1 = zero, y2 = zero;
    real pull_out = lit(0);
    for (int e = ne - 1; e >= 0; --e) {
      const real pull = madd(get(kConjugate, e), kept, get(kCorrection, e));
      set(kConjugate, e, pull);
      const real3 t = get3(kTangent, e);
      const real3 push = heldAt(e + 1, pushOfPulls(t, pull, t_out, pull_out, lit(0)));
      const real3 y = select(weight(e + 1) > lit(0), push, zero) - y1 * get(kFactor1, e) - y2 * get(kFactor2, e);
      set3(kStrain, e, y * get(kPivot, e));
      y2 = y1;
      y1 = y;
      pull_out = pull;
      t_out = t;
    }
    // Root to tip: what they move, and by how much that shortens the edges.
    BentMoves moves(*this);
    real3 moved_in = zero;
    real curvature = lit(0);
    for (int e = 0; e < ne; ++e) {
      const real3 moved = select(weight(e + 1) > lit(0), heldAt(e + 1, moves.next(e)), zero);
      set3(kStrain, e, moved);
      curvature = madd(get(kConjugate, e), dot(get3(kTangent, e), moved_in - moved), curvature);
      moved_in = moved;
    }
    // Root to tip: the step along the direction, and the elimination of the tridiagonal system.
    const real step = conjugateStep(product, curvature);
    moved_in = zero;
    real y = lit(0);
    for (int e = 0; e < ne; ++e) {
      const real3 moved = get3(kStrain, e), shift = get3(kShift, e + 1);
      const real tension = state(b.tension, 0, e);
      set3(kShift, e + 1, select(violent, madd(moved, step, shift), shift));
      store(select(violent, madd(get(kConjugate, e), step, tension), tension), b.tension + at(0, e));
      const real residual = get(kResidual, e) - step * dot(get3(kTangent, e), moved_in - moved);
      set(kResidual, e, residual);
      y = e > 0 ? residual - get(kLengthFactor, e) * y : residual;
      set(kCorrection, e, y * get(kLengthPivot, e));
      moved_in = moved;
    }
    if (iteration == kPullIterations) return;
    // Tip to root: its substitution.
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

// Every vertex moved by its pulls, of those who have their lengths solved again. The others' system comes out as it was.
inline void RodStep::moveByPulls() {
  const StepScope scope{StepPart::kAgain};
  Pulls pulls(*this);
  moveAndEliminateLengths([&](int e) {
    store(select(again_, pulls.tension(e), state(b.tension, 0, e)), b.tension + at(0, e));
    const real3 shift = select(again_, pulls.shifted(e), get3(kShift, e + 1));
    return among_bodies_ ? collide(e + 1, shift) : shift;
  });
}

// What the last pulls move, exact lengths, velocities. Where some strand is thrown, gives the speed of the fastest vertices as
// lengths alone have left them, which nothing has turned out of bodies yet.
inline real RodStep::finish(bool any_thrown) {
  const StepScope scope{StepPart::kVelocities};
  if (b.pinned) shareMissing();
  const real inverse_h = lit(1 / h);
  real3 old_in = state3(b.position, 0), pulled_in = get3(kShift, 0), shift = pulled_in, inner = root_.position;
  const real3 zero = makeReal3(lit(0), lit(0), lit(0));
  real3 turned = zero;  // m, by how much that has moved the vertex
  real way2 = lit(0);
  store3(shift * inverse_h, b.velocity, 0);
  store3(inner, b.position, 0);
  Pulls pulls(*this);
  for (int e = 0; e < ne; ++e) {
    store(pulls.tension(e) * lit(1 / time2_), b.tension + at(0, e));
    const real3 old = state3(b.position, e + 1), pulled = pulls.shifted(e), advance = pulled - pulled_in;
    real3 exact = advance + missingLength((old - old_in) + advance, get3(kTangent, e), lengthOf(e));
    if (b.pinned) exact = exact + get3(kShared, e);
    shift = select(weight(e + 1) > lit(0), shift + exact, pulled);
    if (among_bodies_) {
      const real3 kept = keptOut(e + 1, shift, inner);
      if (any_thrown) {
        turned = select(weight(e + 1) > lit(0), turned, zero);
        const real3 went = shift - turned;
        way2 = max(way2, dot(went, went));
        turned = turned + (kept - shift);
      }
      shift = kept;
      if (forced_[e + 1]) store3(state3(b.contact, e + 1) * lit(1 / time2_), b.contact, e + 1);
    }
    if (any_thrown && !among_bodies_) way2 = max(way2, dot(shift, shift));
    inner = old + shift;
    store3(shift * inverse_h, b.velocity, e + 1);
    store3(inner, b.position, e + 1);
    old_in = old;
    pulled_in = pulled;
  }
  return sqrt(way2) * inverse_h;
}

#include "core/rod_traits.inl"
#include "core/held_contact.inl"
#include "core/kept_out.inl"
#include "core/pinned_lengths.inl"
#include "core/stiff_pulls.inl"
#include "core/thrown_strands.inl"

inline void stepRod(const Block& b, const StepInput& input, Scalar* scratch) { RodStep(b, input, scratch).run(); }

inline void stepBlock(const Block& b, const StepInput& input, Scalar* scratch) {
  if (input.parameters->solver == SolverKind::kRod) stepRod(b, input, scratch);
  else stepGaussSeidel(b, input, scratch);
}
