// Vertices that exact lengths have put into bodies, turned out of them about the inner ends of their edges. Included in core/rod_sweep.inl.

// Vertex i once more, shifted by making lengths exact, its edge from `inner` on: held to the side of the bodies it was on.
// Gives its shift.
inline real3 RodStep::keptOut(int i, const real3& shift, const real3& inner) {
  const StepScope scope{StepPart::kContact};
  const real3 before = state3(b.position, i), placed = before + shift, off = shift - get3(kShift, i);
  const mask moved = dot(off, off) > contactSlack() * contactSlack() && weight(i) > lit(0);
  real3 x = placed, out = shift;
  if (anyTrue(moved)) {
    const mask looks = near_.lookBack(i, placed, before, moved);
    if (anyTrue(looks)) {
      x = turnedOutOfBodies(i, placed, inner, looks);
      const real3 turned = x - placed;
      out = select(dot(turned, turned) > lit(0), x - before, shift);
    }
  }
  near_.goOn(i, near_.wayAlong(x, before));
  return out;
}
// The same of lanes that have looked again: of its turns the one that leaves it least deep, for in a crease all but the last may
// turn it out of one side into the other.
[[gnu::noinline]] inline real3 RodStep::turnedOutOfBodies(int i, const real3& placed, const real3& inner, const mask& lanes) {
  real3 x = placed, best = placed;
  real least = lit(-1e9);
  for (int round = 0;; ++round) {
    const Touch touch = near_.touch(i, x);
    best = select(touch.gap > least, x, best);
    least = max(least, touch.gap);
    const mask deep = lanes && touch.gap < lit(0) - contactSlack();
    if (round == 4 || !anyTrue(deep)) return best;
    const real edge = lengthOf(i - 1);
    if (round == 3) {
      const mask two = deep && near_.seesTwo(i);
      if (!anyTrue(two)) return best;
      const Touch one = near_.plane(0, i, best), other = near_.plane(1, i, best);
      x = select(two, turnedIntoCrease(best, inner, one.carried, one.normal, one.gap, other.carried, other.normal,
                                       other.gap, edge), x);
      continue;
    }
    const real3 turned =
        round < 2 ? turnedTowards(x, inner, touch.normal, touch.gap, edge)
                  : turnedOut(x, inner, touch.normal, lastTurn(x, inner, touch.carried, touch.normal, touch.gap), edge);
    x = select(deep, turned, x);
  }
}
