// Strands between pins: tautness and exact lengths. Included in core/rod_sweep.inl.

// Greatest tautness() between any two pins of a strand, for the pin positions at the end of the step; 1 if nothing
// hangs between pins.
inline real RodStep::mostTautness() const {
  real most = lit(1), length = lit(0);  // since the last pin
  if (!b.pinned) return most;
  real3 pin = end_.position;
  mask follows_pin = lit(0) < lit(1);
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
  const real3 zero = makeReal3(lit(0), lit(0), lit(0));
  TensionShifts tensions(*this);
  for (int e = 0; e < ne; ++e) {
    const real3 old = state3(b.position, e + 1), pulled = tensions.shifted(e), advance = pulled - pulled_in;
    shift = shift + advance + missingLength((old - old_in) + advance, get3(kTangent, e), lengthOf(e));
    length = length + lengthOf(e);
    const mask pinned = !(weight(e + 1) > lit(0));
    set3(kShared, e, select(pinned, (pulled - shift) * inverse(max(length, lit(1e-9))), zero));
    shift = select(pinned, pulled, shift);
    length = select(pinned, lit(0), length);
    old_in = old;
    pulled_in = pulled;
  }
  real3 per_length = zero;
  for (int e = ne - 1; e >= 0; --e) {
    per_length = select(weight(e + 1) > lit(0), per_length, get3(kShared, e));
    set3(kShared, e, per_length * lengthOf(e));
  }
}
