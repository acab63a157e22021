// Velocity clamp of strands that overshoot: see overshoot() and velocityClamp() in kernels/rod.h. Included in
// core/rod_sweep.inl.

// Greatest speed per strand of its vertices, root and pins and of the bodies beside it, m/s. Call it before the substep
// stores new velocities.
[[gnu::noinline]] inline real RodStep::fastest() const {
  const StepScope scope{StepPart::kVelocities};
  const real3 root = get3(kShift, 0);
  real way2 = dot(root, root), speed2 = lit(0);
  for (int i = 1; i < n; ++i) {
    const real3 v = state3(b.velocity, i), x = state3(b.position, i), shift = get3(kShift, i);
    speed2 = max(speed2, dot(v, v));
    const real beside2 = among_bodies_ ? near_.carried2(i, x + shift, x) : lit(0);
    way2 = max(way2, select(weight(i) > lit(0), beside2, dot(shift, shift)));
  }
  return sqrt(max(speed2, way2 * lit(1 / (h * h))));
}
// Multiplies the velocities of free vertices by `part`. Call it after the substep has stored them.
[[gnu::noinline]] inline void RodStep::clampVelocities(const real& part) {
  const StepScope scope{StepPart::kVelocities};
  for (int i = 1; i < n; ++i) store3(state3(b.velocity, i) * select(weight(i) > lit(0), part, lit(1)), b.velocity, i);
}
