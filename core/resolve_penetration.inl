// Penetration resolution: vertices that exact lengths have pushed into bodies are moved out by rotating their edges
// about the inner ends. Included in core/rod_sweep.inl.

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
    const mask deep = lanes && plane.gap < lit(0) - contactSlack();
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
