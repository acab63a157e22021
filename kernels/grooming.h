// Kernel text: see kernels/README.md. What grooming adds to the motion of a vertex.

// The goal pull is a spring without damping from a vertex to its place in the rest shape as the root carries it:
// acceleration rate^2 (goal - x), rate in 1/s, at the end of the substep (implicit Euler). It adds this to the vertex's
// mass in a linear system for its displacement, and goalPull() stands in the place of acceleration x mass. `time2`: of an
// acceleration, how far it takes a vertex in the substep, s^2.
FN real goalStiffness(IN(real) mass, IN(real) rate, IN(real) time2) { return mass * rate * rate * time2; }
// Right-hand side (m x mass) of a vertex that is `lack` from its goal and would go on by `way` without the pull. `mass` has the
// stiffness added.
FN real3 goalPull(IN(real3) way, IN(real) mass, IN(real) stiffness, IN(real3) lack) {
  return madd(lack - way, stiffness, way * mass);
}
// The same pull on a vertex that nothing else holds: where it ends up instead of at x.
FN real3 drawnToGoal(IN(real3) x, IN(real3) goal, IN(real) rate, IN(real) time2) {
  real stiffness = goalStiffness(lit(1), rate, time2);
  return madd(goal - x, stiffness * inverse(lit(1) + stiffness), x);
}

// A tether holds x within `longest` of its root, as a rope would (Kim, Chentanez, Mueller-Fischer 2012, "Long
// Range Attachments"): few sweeps of constraints between neighbours do not carry the root's pull to the tip.
FN real3 tethered(IN(real3) x, IN(real3) root, IN(real) longest) {
  real3 away = x - root;
  real l2 = dot(away, away);
  mask taut = l2 > longest * longest;
  return select(taut, madd(away, longest * inverseSqrt(select(taut, l2, lit(1))), root), x);
}
