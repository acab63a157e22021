// Properties of the strands of a block that stay constant during a step: stiffness, rest bends, edge lengths, driving
// forces. Included in core/rod_sweep.inl.

// Finds which strands are kinked, and their correction limits, from their bends at rest and their stiffness; as
// restBends() of core/strand_model.h.
inline void RodStep::findBends() {
  real bends = lit(0), changes = lit(0), second_changes = lit(0);
  real3 before = makeReal3(lit(0), lit(0), lit(0)), change_before = before;
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
inline real RodStep::drivenByAir(int i, const real& wind) const {
  real driven = groomingFactor(b, kAirDragScale, i) * wind;
  if (b.acceleration != nullptr) {
    const real3 own = accelerationOf(b, i);
    driven = driven + sqrt(dot(own, own));
  }
  return driven;
}

// Runs once per step, before its first substep.
inline void RodStep::findTraits() {
  mask seen_free = lit(1) < lit(0);
  between_pins_ = seen_free;
  real length = lit(0), hung = lit(0), shortest = lengthOf(0), driven = lit(0);
  const real wind = lit(p.air_drag * p.wind.norm());
  stiffest_ = lit(0);
  for (int e = 0; e < ne; ++e) {
    const real il = inverseLength(e);
    stiffest_ = max(stiffest_, stiffnessOf(bend(e), il, lit(time2_), ownWeight(e + 1)));
    length = length + lengthOf(e);
    shortest = min(shortest, lengthOf(e));
    driven = max(driven, drivenByAir(e + 1, wind));
    const mask is_free = weight(e + 1) > lit(0);
    between_pins_ = between_pins_ || (seen_free && !is_free);
    seen_free = seen_free || is_free;
    hung = hung + select(is_free, ownMass(e + 1), lit(0));
  }
  findBends();
  cut_unevenly_ = isCutUnevenly(shortest, length * lit(1.0 / ne));
  const real taut = mostTautness();
  taut_ = isTaut(taut);
  most_tension_ = tensionBound(hung, length, taut * (lit(p.gravity.norm()) + driven), lit(time2_));
}
