// Contact of the rod; members of RodStep, included in core/rod_sweep.inl.
//
// Contact of pressed strands is solved through the bending matrix after forces have moved the vertices. Holding one
// vertex on a surface moves the other vertices of its strand, and the reaction at the held vertex is the change of its
// contact force. pressThroughBending() solves the complementarity problem of the substep (Moreau) by an active-set
// iteration; the law is in kernels/contact.h.
//
// Penetration resolution moves vertices out of bodies that exact lengths have pushed into them: it rotates their edges
// about the inner ends.

// Row of a vertex that some lane has near a body, in the elimination of the bending matrix with held vertices
// prescribed. Forces are in units of length x mass.
struct RodStep::HeldRow {
  real3 push;          // m, from the vertex to its position on the surface (positionOnSurface)
  real3 force;         // contact force at the start of the substep
  real3 load;          // change of that force if the vertex is not held
  real3 reaction;      // change of that force if it is held
  real3 moved, right;  // displacement without that of vertices farther in; right-hand side
  real compliance, own, across,
      second;           // inverse diagonal, 0 if prescribed; diagonal; couplings to the next two vertices inwards
  real held;            // 1 if held, otherwise 0
  real3 kept_friction;  // friction that is kept, see positionOnSurface()
  real follows, friction;
};

inline RodStep::HeldRow& RodStep::heldRow(int i) const {
  static_assert(sizeof(HeldRow) <= kTensionPlanes * kLanes * sizeof(Scalar));
  return reinterpret_cast<HeldRow*>(scratch_ + rodScratch(n, kLanes))[i - 1];
}

// Finds the contact of vertex i after `shift`, of which forces in this substep gave `moved`.
inline void RodStep::findContact(int i, const real3& shift, const real3& moved) {
  const StepScope scope{StepPart::kContact};
  const real3 x = state3(b.position, i) + shift;
  near_.requeryIfMoved(i, x, state3(b.position, i), in_length_pass_);
  if (near_.hasContactPlane(i) || has_force_[i]) holdAtContact(i, x, moved);
}

// findContact() for a vertex that may be near a body. A vertex inside a body, or pressed before, starts as held. One
// that is only near gets a row, too, and may become held; otherwise rounding at the surface would decide the result of
// a step. Not inlined, so that the sweep stays small.
[[gnu::noinline]] inline void RodStep::holdAtContact(int i, const real3& x, const real3& moved) {
  const real3 before = has_force_[i] ? state3(b.contact, i) : zero3();
  const mask pressed_before = dot(before, before) > lit(0);
  const real gap = near_.gap(i, x);
  recordContact(i, gap, pressed_before);
  const mask near = (gap < contactReach() || pressed_before) && weight(i) > lit(0);
  if (!anyTrue(near)) return;
  const ContactPlane plane = near_.deepestPlane(i, x);
  const mask touches = near && (plane.gap < lit(0) || pressed_before), held = touches && plane.gap < contactReach();
  HeldRow& row = heldRow(i);
  row.push = positionOnSurface(x, plane.carried, moved, plane.normal, plane.gap, plane.friction, select(near, weight(i), lit(1)),
                               before, row.follows, row.kept_friction) -
             x;
  row.force = before;
  row.load = select(touches && !held, -before, zero3());
  row.held = select(held, lit(1), lit(0));
  row.follows = select(held, row.follows, lit(0));
  row.friction = plane.friction;
  set3(kNormal, i, select(near, plane.normal, zero3()));
  has_force_[i] = has_normal_[i] = true;
  in_contact_ = in_contact_ || touches;
}

// Active-set iteration, docs/solver.md (26) to (28): solves the bending system with held vertices prescribed, releases
// vertices that would pull at a body, and holds vertices that penetrate, until nothing changes. Then applies the
// displacements and stores the contact forces.
[[gnu::noinline]] inline void RodStep::pressThroughBending() {
  const StepScope scope{StepPart::kContact};
  auto isHeld = [&](int i) { return has_normal_[i] ? heldRow(i).held > lit(0) : maskNone(); };
  mask changed = maskAll();
  for (int round = 0; round < kActiveSetIterations && anyTrue(changed); ++round) {
    // Tip to root. `near`, `between`, `far`: what the vertices farther out change, against the elimination of A alone,
    // on this vertex's diagonal, on its coupling to the next vertex inwards and on that one's diagonal. The elimination
    // of A itself is not repeated (see OuterTensions in kernels/stiff_tensions.h).
    real near = lit(0), between = lit(0), far = lit(0);
    real3 right = zero3(), right_far = zero3();
    for (int e = ne - 1; e >= 0; --e) {
      HeldRow& row = heldRow(e + 1);
      const mask held = isHeld(e + 1), fixed = held || !(weight(e + 1) > lit(0));
      const real alone = get(kPivot, e), pivot = inverse(alone);
      const real first = e > 0 ? pivot * get(kFactor1, e - 1) : lit(0);
      row.second = e > 1 ? pivot * get(kFactor2, e - 2) : lit(0);
      row.across = first + between;
      row.own = pivot + near;
      row.compliance = select(fixed, lit(0), inverse(row.own));
      row.right = has_normal_[e + 1] ? right + row.load : right;
      row.moved = row.right * row.compliance;
      if (has_normal_[e + 1]) row.moved = select(held, row.push, row.moved);
      const real less = select(fixed, alone, alone * row.compliance * near);  // compliance that the vertex lacks against A alone
      near = far + first * first * less - (first + row.across) * between * row.compliance;
      between = row.second * (first * less - between * row.compliance);
      far = row.second * row.second * less;
      right = right_far - row.moved * row.across;
      right_far = zero3() - row.moved * row.second;
    }
    // Root to tip: displacements, and the reactions at held vertices.
    real3 moved_in = zero3(), moved_in2 = zero3();
    changed = maskNone();
    for (int e = 0; e < ne; ++e) {
      HeldRow& row = heldRow(e + 1);
      const real3 coupled_in = moved_in * row.across + moved_in2 * row.second;
      row.moved = row.moved - coupled_in * row.compliance;
      moved_in2 = moved_in;
      moved_in = row.moved;
      if (!has_normal_[e + 1]) continue;
      const mask held = isHeld(e + 1);
      const real3 normal = get3(kNormal, e + 1);
      row.reaction = select(held, row.moved * row.own + coupled_in - row.right, zero3());
      const mask goes = held && isReleased(row.force, row.reaction, normal);
      const mask comes = !held && becomesHeld(row.push, row.moved, normal);
      row.held = select(goes, lit(0), select(comes, lit(1), row.held));
      row.load = select(goes, -row.force, select(comes, zero3(), row.load));
      changed = changed || goes || comes;
    }
  }
  for (int i = 1; i < n; ++i) {
    const HeldRow& row = heldRow(i);
    set3(kShift, i, get3(kShift, i) + select(in_contact_, row.moved, zero3()));
    if (!has_normal_[i]) continue;
    const real3 normal = get3(kNormal, i),
                force = heldForce(row.force, row.reaction, row.follows, row.kept_friction, normal, row.friction);
    const mask held = row.held > lit(0);
    store3(select(held, force, row.load + row.force), b.contact, i);
    set3(kNormal, i, select(held, normal, zero3()));
    set(kSoftness, i, select(held, lit(0), get(kSoftness, i)));
  }
}

// Moves vertex i out of bodies after exact lengths gave it `shift`; its edge starts at `inner`. Returns its new shift
// and updates its travel. Bodies are checked only if the last tension increments and exact lengths moved the vertex by
// more than contactSlack().
inline real3 RodStep::resolvePenetration(int i, const real3& shift, const real3& inner) {
  const StepScope scope{StepPart::kContact};
  const real3 before = state3(b.position, i), placed = before + shift, off = shift - get3(kShift, i);
  const mask moved = dot(off, off) > contactSlack() * contactSlack() && weight(i) > lit(0);
  real3 x = placed, out = shift;
  if (anyTrue(moved)) {
    const mask looks = near_.requeryIfMovedOrNear(i, placed, before, moved);
    if (anyTrue(looks)) {
      x = rotatedOutOfBodies(i, placed, inner, looks);
      const real3 turned = x - placed;
      out = select(dot(turned, turned) > lit(0), x - before, shift);
    }
  }
  near_.addTravel(i, near_.relativeTravel(x, before));
  return out;
}
// Candidate positions of vertex i in `lanes`: two rotations towards the surface, one out of the body, and one into the
// crease of two planes. Returns the least deep one, because in a crease all but the last may turn the vertex out of one
// body into the other.
[[gnu::noinline]] inline real3 RodStep::rotatedOutOfBodies(int i, const real3& placed, const real3& inner, const mask& lanes) {
  real3 x = placed, best = placed;
  real least = lit(-1e9);
  for (int round = 0;; ++round) {
    const ContactPlane plane = near_.deepestPlane(i, x);
    best = select(plane.gap > least, x, best);
    least = max(least, plane.gap);
    const mask deep = lanes && plane.gap < -contactSlack();
    if (round == 4 || !anyTrue(deep)) return best;
    const real edge = lengthOf(i - 1);
    if (round == 3) {
      const mask two = deep && near_.hasTwoContactPlanes(i);
      if (!anyTrue(two)) return best;
      const ContactPlane one = near_.plane(0, i, best), other = near_.plane(1, i, best);
      x = select(
          two, rotatedIntoCrease(best, inner, one.carried, one.normal, one.gap, other.carried, other.normal, other.gap, edge), x);
      continue;
    }
    const real3 turned =
        round < 2 ? rotatedTowardsPlane(x, inner, plane.normal, plane.gap, edge)
                  : rotatedOntoPlane(x, inner, plane.normal, gapToRemove(x, inner, plane.carried, plane.normal, plane.gap), edge);
    x = select(deep, turned, x);
  }
}
