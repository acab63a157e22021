// Tension increments of stiff strands with large correction strains and of taut strands, by elimination along the
// strands of a block (kernels/stiff_tensions.h). Included in core/rod_sweep.inl.

// Finds and applies the tension increments of `strands`. Like applyTensionsThroughBending(), it leaves no increments
// for applyTensions(), and softness 0.
inline void RodStep::eliminateTensions(const mask& strands) {
  const StepScope scope{StepPart::kTensions};
  static_assert(sizeof(TensionRow) == kTensionPlanes * kLanes * sizeof(Scalar));
  TensionRow* const rows = reinterpret_cast<TensionRow*>(scratch_ + rodScratch(n, kLanes));
  const real3 zero = makeReal3(lit(0), lit(0), lit(0));
  OuterTensions outside = noOuterTensions();
  for (int e = ne - 1; e >= 0; --e) {
    const mask moves = weight(e + 1) > lit(0), moves_in = lit(e) > lit(0) && weight(e) > lit(0);
    const real3 t = get3(kTangent, e);
    const real3 edge = (state3(b.position, e + 1) - state3(b.position, e)) + (get3(kShift, e + 1) - get3(kShift, e));
    rows[e] = eliminateTension(outside, moves, get(kPivot, e), e > 0 ? get(kFactor1, e - 1) : lit(0),
                               e > 1 ? get(kFactor2, e - 2) : lit(0), select(moves, t, zero), select(moves_in, t, zero),
                               lengthResidualOf(e, dot(edge, t)), normalAt(e + 1));
  }
  real3 near = zero, far = zero;  // shifts of the next two vertices inwards
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
