// Kernel text: see kernels/README.md. Goal pull and tethers of a vertex.

// The goal pull is an undamped spring from a vertex to its goal: its position in the rest shape as the root carries it.
// Acceleration rate^2 (goal - x), rate in 1/s, at the end of the substep (implicit Euler). goalStiffness() is added to
// the vertex's mass in a linear system for its displacement, and goalPull() replaces acceleration x mass. `time2`: s^2,
// displacement by an acceleration of 1 m/s^2 (DragStep::time2).
FN real goalStiffness(IN(real) mass, IN(real) rate, IN(real) time2) { return mass * rate * rate * time2; }
// Right-hand side (m x mass) of a vertex. `lack`: vector to its goal; `way`: displacement without the pull; both m.
// `mass` includes the stiffness.
FN real3 goalPull(IN(real3) way, IN(real) mass, IN(real) stiffness, IN(real3) lack) {
  return madd(lack - way, stiffness, way * mass);
}
// Position after the same pull on a vertex without other forces, in place of x.
FN real3 drawnToGoal(IN(real3) x, IN(real3) goal, IN(real) rate, IN(real) time2) {
  real stiffness = goalStiffness(lit(1), rate, time2);
  return madd(goal - x, stiffness * inverse(lit(1) + stiffness), x);
}

// Tether: keeps x within `longest` (m) of its root, as a rope does (Kim, Chentanez, Mueller-Fischer 2012, "Long Range
// Attachments"). A few sweeps of constraints between neighbours do not carry the root's tension to the tip.
FN real3 tethered(IN(real3) x, IN(real3) root, IN(real) longest) {
  real3 away = x - root;
  real l2 = dot(away, away);
  mask taut = l2 > longest * longest;
  return select(taut, madd(away, longest * inverseSqrt(select(taut, l2, lit(1))), root), x);
}
