// Part of rod.comp: bending and twist of strands that are straight at rest, without material frames (STRAIGHT). The result
// is that of rod_twist.glsl with twist in equilibrium. Requires kernels/rod.h.

// The tangent of the edge before slot p.
vec3 tangentBefore(int p) { return p > 0 ? tangent[max(p - 1, 0)] : tangent_in; }

#if DAMPED
vec3 swing[PER_THREAD], swing_in;  // change of tangents as vertices move to the inertial points
void computeEdgeSwing(int p) { swing[p] = alongSurface(edgeShift(p) * inverseLength(p), tangent[p]); }
#endif

// Predicts every edge from the inertial points; see predictEdge(). An edge without length gets the root's tangent, not its
// last one: only stored state may pass between substeps, or a strand would depend on the others of its workgroup.
void predictEdges(RootMotion root, out float blend[PER_THREAD]) {
  for (int p = 1; p < PER_THREAD; ++p) blend[p] = predictEdge(p, oldEdge(p - 1) * inverseLength(p - 1), root.tangent_old);
#if DAMPED
  computeEdgeSwing(kLast);
  const vec3 last = swing[kLast];
  send_d(last.z);
#else
  const vec3 last = vec3(0);
#endif
  send_a(vec4(tangent[kLast], last.x));
  send_b(vec4(oldEdge(kLast) * inverseLength(kLast), last.y));
  exchangeBarrier();
  const vec4 a = received_a(before(1)), b = received_b(before(1));
#if DAMPED
  swing_in = vec3(a.w, b.w, received_d(before(1)));
  swing_in = select(hasBefore(1), swing_in, vec3(0));  // edgeForce() has the root's swing
#endif
  swapBank();
  tangent_in = select(hasBefore(1), a.xyz, root.tangent_old);
  blend[0] = predictEdge(0, select(hasBefore(1), b.xyz, root.tangent_old), root.tangent_old);
#if DAMPED
  for (int p = 0; p < kLast; ++p) computeEdgeSwing(p);
#endif
}

#if DAMPED
// Exclusive scans: sums over the strand's invocations before this one, and over those after it.
float sumBefore(float value) {
  float sum = value;
  for (int doubling = 0; doubling < OPAQUE_COUNT(kReductionRounds); ++doubling) {
    send_d(sum);
    exchangeBarrier();
    const float other = received_d(before(1 << doubling));
    swapBank();
    sum += select(hasBefore(1 << doubling), other, 0.0);
  }
  return sum - value;
}
float sumAfter(float value) {
  float sum = value;
  for (int doubling = 0; doubling < OPAQUE_COUNT(kReductionRounds); ++doubling) {
    send_d(sum);
    exchangeBarrier();
    const float other = received_d(after(1 << doubling));
    swapBank();
    sum += select(hasAfter(1 << doubling), other, 0.0);
  }
  return sum - value;
}

// Moments of joints with internal damping. A scan from root to tip gives the spin that keeps edges free of twist, and so
// the gain of strains; a scan from tip to root sums the torques of damping.
void computeMoments(vec3 strain[PER_THREAD], float spin_of_root) {
  const float ahead = DAMPING_TIME * settings.per_substep;
  float spin[PER_THREAD], torque[PER_THREAD], sum = 0.0;
  vec3 gain[PER_THREAD];
  for (int p = 0; p < PER_THREAD; ++p) {
    sum += straightSpin(tangentBefore(p), tangent[p], p > 0 ? swing[max(p - 1, 0)] : swing_in, swing[p]);
    spin[p] = sum;
  }
  float spin_in = spin_of_root + sumBefore(sum);
  sum = 0.0;
  for (int p = 0; p < PER_THREAD; ++p) {
    const float mean = spin_in + 0.5 * (spin[p] + (p > 0 ? spin[max(p - 1, 0)] : 0.0));
    gain[p] = straightGain(strain[p], tangentBefore(p), tangent[p], p > 0 ? swing[max(p - 1, 0)] : swing_in, swing[p], mean);
    torque[p] = straightTorque(strain[p], gain[p], bends[p] * DAMPING_SUBSTEPS_AT(p));
    sum += torque[p];
  }
  float beyond = sumAfter(sum);
  for (int p = kLast; p >= 0; --p) {
    moment[p] =
        straightMoment(strain[p], gain[p], tangentBefore(p), bends[p], bends[p] * DAMPING_SUBSTEPS_AT(p), torque[p], beyond);
    beyond += torque[p];
  }
}
#else
void computeMoments(vec3 strain[PER_THREAD], float spin_of_root) {
  for (int p = 0; p < PER_THREAD; ++p) moment[p] = strain[p] * bends[p];
}
#endif

// Stiffness of joints and edges in the bending matrix, and the moments of joints.
void solveJoints(RootMotion root, float blend[PER_THREAD]) {
  vec3 strain[PER_THREAD];
  float margin[PER_THREAD + 1];
  for (int p = 0; p < PER_THREAD; ++p) {
    strain[p] = straightStrain(tangentBefore(p), tangent[p]);
    const float c = dot(tangentBefore(p), tangent[p]);
#if DAMPED
    const float time2 = settings.time2 * madd(DAMPING_TIME_AT(p), settings.per_substep, implicitShare(blend[p]));
#else
    const float time2 = settings.time2 * implicitShare(blend[p]);
#endif
    stiffness[p] = bendMatrixStiffness(bends[p], c, time2);
    margin[p] = bendMatrixMargin(stiffness[p], c, strain[p], kinked);
  }
  send_a(vec4(tangent[0], stiffness[0]));
  send_b(vec4(tangent[1], stiffness[1]));
  send_d(margin[0]);
  exchangeBarrier();
  const vec4 a = received_a(after(1)), b = received_b(after(1));
  margin[PER_THREAD] = received_d(after(1));
  margin[PER_THREAD] = select(hasAfter(1), margin[PER_THREAD], 0.0);
  swapBank();
  tangent_out = a.xyz;
  stiffness[PER_THREAD] = select(hasAfter(1), a.w, 0.0);
  stiffness[PER_THREAD + 1] = select(hasAfter(1), b.w, 0.0);
  softenVertices(margin, blend, b.xyz);
  computeMoments(strain, root.spin);
}
