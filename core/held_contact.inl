// Contact of strands that bodies press, while their vertices are where forces have moved them: through the bending matrix, so that what
// holds one vertex holds its strand, and its force is what that takes. Included in core/rod_sweep.inl.

// Of a vertex that some lane has near a body, and of the elimination of the bending matrix with those held that are.
struct RodStep::HeldRow {
  real3 push;              // m, from where it is to where it is to be held
  real3 force;             // that the body has pressed it with when the substep began
  real3 load;              // on one that is not held, in place of that
  real3 reaction;          // to what holds it
  real3 moved, right;      // its way without those farther in; its right-hand side
  real gives, own, across, second;  // how it gives way; its own stiffness, and what couples it to the next two inwards
  real held;               // 1, else 0
  real3 rubs;              // friction that is kept
  real follows, friction;
};

inline RodStep::HeldRow& RodStep::heldRow(int i) const {
  static_assert(sizeof(HeldRow) <= kPullPlanes * kLanes * sizeof(Scalar));
  return reinterpret_cast<HeldRow*>(scratch_ + rodScratch(n, kLanes))[i - 1];
}

// Notes what a body is to vertex i, shifted so, of which forces have just moved it by `moved`.
inline void RodStep::touch(int i, const real3& shift, const real3& moved) {
  const StepScope scope{StepPart::kContact};
  const real3 x = state3(b.position, i) + shift;
  near_.lookOn(i, x, state3(b.position, i), again_);
  if (near_.sees(i) || forced_[i]) touched(i, x, moved);
}

// The same of a vertex that one may be near. In a body, or pressed before, it is held at first; near one it may be later, or a step would
// depend on which side of the surface rounding has put it. By itself, so that the sweep stays small.
[[gnu::noinline]] inline void RodStep::touched(int i, const real3& x, const real3& moved) {
  const real3 zero = makeReal3(lit(0), lit(0), lit(0)), before = forced_[i] ? state3(b.contact, i) : zero;
  const mask pressed_before = dot(before, before) > lit(0);
  const real gap = near_.gap(i, x);
  noteMeeting(i, gap, pressed_before);
  const mask near = (gap < contactReach() || pressed_before) && weight(i) > lit(0);
  if (!anyTrue(near)) return;
  const Touch touch = near_.touch(i, x);
  const mask touches = near && (touch.gap < lit(0) || pressed_before), held = touches && touch.gap < contactReach();
  HeldRow& row = heldRow(i);
  row.push = heldPlace(x, touch.carried, moved, touch.normal, touch.gap, touch.friction, select(near, weight(i), lit(1)), before,
                       row.follows, row.rubs) - x;
  row.force = before;
  row.load = select(touches && !held, zero - before, zero);
  row.held = select(held, lit(1), lit(0));
  row.follows = select(held, row.follows, lit(0));
  row.friction = touch.friction;
  set3(kNormal, i, select(near, touch.normal, zero));
  forced_[i] = faces_[i] = true;
  touches_ = touches_ || touches;
}

// The strands that touch bodies, bent by what holds them, who pulls at a body let go; their contact forces.
[[gnu::noinline]] inline void RodStep::pressThroughBending() {
  const StepScope scope{StepPart::kContact};
  const real3 zero = makeReal3(lit(0), lit(0), lit(0));
  auto isHeld = [&](int i) { return faces_[i] ? heldRow(i).held > lit(0) : lit(0) > lit(0); };
  mask changed = lit(0) < lit(1);
  for (int round = 0; round < kHoldRounds && anyTrue(changed); ++round) {
    // From tip to root. Those farther out, and A without its own elimination of them (see OuterPulls in kernels/stiff_pulls.h), leave this of
    // a vertex, what couples it to the next one, and that.
    real near = lit(0), between = lit(0), far = lit(0);
    real3 right = zero, right_far = zero;
    for (int e = ne - 1; e >= 0; --e) {
      HeldRow& row = heldRow(e + 1);
      const mask held = isHeld(e + 1), fixed = held || !(weight(e + 1) > lit(0));
      const real alone = get(kPivot, e), pivot = inverse(alone);
      const real first = e > 0 ? pivot * get(kFactor1, e - 1) : lit(0);
      row.second = e > 1 ? pivot * get(kFactor2, e - 2) : lit(0);
      row.across = first + between;
      row.own = pivot + near;
      row.gives = select(fixed, lit(0), inverse(row.own));
      row.right = faces_[e + 1] ? right + row.load : right;
      row.moved = row.right * row.gives;
      if (faces_[e + 1]) row.moved = select(held, row.push, row.moved);
      const real less = select(fixed, alone, alone * row.gives * near);  // than in A alone does it give way
      near = far + first * first * less - (first + row.across) * between * row.gives;
      between = row.second * (first * less - between * row.gives);
      far = row.second * row.second * less;
      right = right_far - row.moved * row.across;
      right_far = zero - row.moved * row.second;
    }
    // From root to tip: how far they move, and what holds those that are held.
    real3 moved_in = zero, moved_in2 = zero;
    changed = lit(0) > lit(0);
    for (int e = 0; e < ne; ++e) {
      HeldRow& row = heldRow(e + 1);
      const real3 pull_in = moved_in * row.across + moved_in2 * row.second;
      row.moved = row.moved - pull_in * row.gives;
      moved_in2 = moved_in;
      moved_in = row.moved;
      if (!faces_[e + 1]) continue;
      const mask held = isHeld(e + 1);
      const real3 normal = get3(kNormal, e + 1);
      row.reaction = select(held, row.moved * row.own + pull_in - row.right, zero);
      const mask goes = held && letsGo(row.force, row.reaction, normal);
      const mask comes = !held && isPushed(row.push, row.moved, normal);
      row.held = select(goes, lit(0), select(comes, lit(1), row.held));
      row.load = select(goes, zero - row.force, select(comes, zero, row.load));
      changed = changed || goes || comes;
    }
  }
  for (int i = 1; i < n; ++i) {
    const HeldRow& row = heldRow(i);
    set3(kShift, i, get3(kShift, i) + select(touches_, row.moved, zero));
    if (!faces_[i]) continue;
    const real3 normal = get3(kNormal, i), force = heldForce(row.force, row.reaction, row.follows, row.rubs, normal, row.friction);
    const mask held = row.held > lit(0);
    store3(select(held, force, row.load + row.force), b.contact, i);
    set3(kNormal, i, select(held, normal, zero));
    set(kSoftness, i, select(held, lit(0), get(kSoftness, i)));
  }
}
