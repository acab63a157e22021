// Kernel text: see kernels/README.md. Requires kernels/rotation.h.
//
// Position based dynamics of strands (Yuksel and Tariq 2010, "Advanced Techniques in Real-time Hair Rendering and
// Simulation", chapter 3): Verlet prediction, angular constraints towards the rest shape in the parent edge's frame,
// and distance constraints, in batches that share no vertex. Then the grooming constraints of a vertex: goal pull,
// which the rod has, too, and tether.

// Position after `dt` seconds without constraints. keep = exp(-drag dt) is the share of the velocity that air drag
// leaves; wind replaces the rest. `time2`: displacement by an acceleration of 1 m/s^2, m (DragStep::time2).
LANE_FN real3 predictPosition(LANE_IN(real3) x, LANE_IN(real3) v, LANE_IN(real3) gravity, LANE_IN(real3) wind, LANE_IN(real) keep,
                              LANE_IN(real) dt, LANE_IN(real) time2) {
  real3 blown = madd(v, keep, wind * (lit(1) - keep));
  return madd(gravity, time2, madd(blown, dt, x));
}

// Distance constraint |b - a| = rest between neighbours with inverse masses wa, wb (relative, 0 if pinned). Moves each
// vertex by its share. Does nothing if both are pinned or coincide.
LANE_FN void solveDistance(LANE_INOUT(real3) a, LANE_INOUT(real3) b, LANE_IN(real) wa, LANE_IN(real) wb, LANE_IN(real) rest) {
  real3 edge = b - a;
  real l = length(edge);
  real w = wa + wb;
  mask idle = (l < lit(1e-12)) || (w < lit(1e-12));
  real scale = select(idle, lit(0), (l - rest) / (select(idle, lit(1), l * w)));
  a = madd(edge, scale * wa, a);
  b = madd(edge, lit(0) - scale * wb, b);
}

// Angular constraint on the edge a-b: moves it by the fraction `strength`, 0 to 1, towards `target`. That is the rest
// edge (m) as the frame of the parent edge p-a carries it. The correction that rotates a-b rotates p-a in the opposite
// direction: a step down the gradient of |target - (b - a)|^2 with a target that rotates with p-a. Without this
// reaction the constraint feeds energy to curled hair at rest until it flutters. wp, wa, wb: inverse masses (relative,
// 0 if pinned).
LANE_FN void solveAngular(LANE_INOUT(real3) p, LANE_INOUT(real3) a, LANE_INOUT(real3) b, LANE_IN(real) wp, LANE_IN(real) wa,
                          LANE_IN(real) wb, LANE_IN(real3) target, LANE_IN(real) strength) {
  real3 delta = target - (b - a);
  real3 parent = a - p;
  real3 reaction = cross(parent, cross(target, delta));  // times 1 / |parent|^2
  real l2 = dot(parent, parent);
  real w = madd(wa + wb, l2, (wp + wa) * dot(target, target));
  mask idle = w < lit(1e-24);
  real turn = select(idle, lit(0), strength / select(idle, lit(1), w));
  real move = turn * l2;
  p = madd(reaction, lit(0) - turn * wp, p);
  a = madd(madd(reaction, turn, delta * (lit(0) - move)), wa, a);
  b = madd(delta, move * wb, b);
}

// Rotation without twist that carries a frame from an edge of unit direction `from` to its neighbour of unit direction
// `to` (Bishop 1975). Frames along a strand are products of these from the root outwards.
LANE_FN quat transportFrame(LANE_IN(real3) from, LANE_IN(real3) to) { return rotationBetween(from, to); }

// The goal pull is an undamped spring from a vertex to its goal: its position in the rest shape as the root carries it.
// Acceleration rate^2 (goal - x), rate in 1/s, at the end of the substep (implicit Euler). goalStiffness() is added to
// the vertex's mass in a linear system for its displacement, and goalPull() replaces acceleration x mass. `time2`: s^2,
// displacement by an acceleration of 1 m/s^2 (DragStep::time2).
LANE_FN real goalStiffness(LANE_IN(real) mass, LANE_IN(real) rate, LANE_IN(real) time2) { return mass * rate * rate * time2; }
// Right-hand side (m x mass) of a vertex. `lack`: vector to its goal; `way`: displacement without the pull; both m.
// `mass` includes the stiffness.
LANE_FN real3 goalPull(LANE_IN(real3) way, LANE_IN(real) mass, LANE_IN(real) stiffness, LANE_IN(real3) lack) {
  return madd(lack - way, stiffness, way * mass);
}
// Position after the same pull on a vertex without other forces, in place of x.
LANE_FN real3 drawnToGoal(LANE_IN(real3) x, LANE_IN(real3) goal, LANE_IN(real) rate, LANE_IN(real) time2) {
  real stiffness = goalStiffness(lit(1), rate, time2);
  return madd(goal - x, stiffness * inverse(lit(1) + stiffness), x);
}

// Tether: keeps x within `longest` (m) of its root, as a rope does (Kim, Chentanez, Mueller-Fischer 2012, "Long Range
// Attachments"). A few sweeps of constraints between neighbours do not carry the root's tension to the tip.
LANE_FN real3 tethered(LANE_IN(real3) x, LANE_IN(real3) root, LANE_IN(real) longest) {
  real3 away = x - root;
  real l2 = dot(away, away);
  mask taut = l2 > longest * longest;
  return select(taut, madd(away, longest * inverseSqrt(select(taut, l2, lit(1))), root), x);
}
