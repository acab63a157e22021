// The pulls of stiff strands in very violent motion and of taut ones: kernels/stiff_pulls.h along the strands of a block. Included in core/rod_sweep.inl.

// The same as pullThroughBending().
inline void RodStep::pullByElimination(const mask& strands) {
  const StepScope scope{StepPart::kPulls};
  static_assert(sizeof(PullRow) == kPullPlanes * kLanes * sizeof(Scalar));
  PullRow* const rows = reinterpret_cast<PullRow*>(scratch_ + rodScratch(n, kLanes));
  const real3 zero = makeReal3(lit(0), lit(0), lit(0));
  OuterPulls outside = noOuterPulls();
  for (int e = ne - 1; e >= 0; --e) {
    const mask moves = weight(e + 1) > lit(0), moves_in = lit(e) > lit(0) && weight(e) > lit(0);
    const real3 t = get3(kTangent, e);
    const real3 edge = (state3(b.position, e + 1) - state3(b.position, e)) + (get3(kShift, e + 1) - get3(kShift, e));
    rows[e] = eliminatePull(outside, moves, get(kPivot, e), e > 0 ? get(kFactor1, e - 1) : lit(0),
                            e > 1 ? get(kFactor2, e - 2) : lit(0), select(moves, t, zero), select(moves_in, t, zero),
                            toMend(e, dot(edge, t)), normalAt(e + 1));
  }
  real3 near = zero, far = zero;  // shifts of the next two vertices inwards
  real pull = firstPull(outside);
  for (int e = 0; e < ne; ++e) {
    const real3 moved = shiftOf(rows[e], near, far, pull), before = get3(kShift, e + 1);
    const real tension = state(b.tension, 0, e);
    store(select(strands, tension + pull, tension), b.tension + at(0, e));
    set3(kShift, e + 1, select(strands, before + moved, before));
    set(kRight, e, select(strands, lit(0), get(kRight, e)));
    set(kSoftness, e + 1, select(strands, lit(0), get(kSoftness, e + 1)));
    pull = pullOf(rows[e], near, far, pull);
    far = near;
    near = moved;
  }
}
