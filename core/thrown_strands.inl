// The speeds of strands that are thrown: thrownBy() in kernels/rod.h. Included in core/rod_sweep.inl.

// Of vertices, their root and what is beside them, before the substep gives new speeds, m/s.
[[gnu::noinline]] inline real RodStep::fastest() const {
  const real3 root = get3(kShift, 0);
  real way2 = dot(root, root), speed2 = lit(0);
  for (int i = 1; i < n; ++i) {
    const real3 v = state3(b.velocity, i), x = state3(b.position, i);
    speed2 = max(speed2, dot(v, v));
    way2 = max(way2, near_.carried2(i, x + get3(kShift, i), x));
  }
  return sqrt(max(speed2, way2 * lit(1 / (h * h))));
}
// After it has.
[[gnu::noinline]] inline void RodStep::slowDown(const real& part) {
  for (int i = 1; i < n; ++i) store3(state3(b.velocity, i) * part, b.velocity, i);
}
