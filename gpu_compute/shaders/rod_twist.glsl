// Part of rod.comp: bending and twist of a strand by material frames; rod_straight.glsl does without frames (STRAIGHT).

// Of the edge before slot 0, in the current substep.
vec4 frame_in;
vec3 turned_in;  // see edgeTurning()

// Rotation of the edge of slot p as vertices move to the inertial points, in its frame, radians; without twist.
vec3 edgeTurning(int p) { return turningOf(frame[p], edgeShift(p) * inverseLength(p)); }

// predictEdge(), and parallel transport of the edge's frame to the new tangent.
float carryEdge(int p, vec3 unit_in) {
  vec3 own = frameTangent(frame[p]);
  float blend = predictEdge(p, unit_in, own);
  frame[p] = transportTo(frame[p], own, tangent[p]);
  return blend;
}

// Predicts every edge from the inertial points.
void predictEdges(RootMotion root, out float blend[PER_THREAD]) {
  for (int p = 1; p < PER_THREAD; ++p) blend[p] = carryEdge(p, oldEdge(p - 1) * inverseLength(p - 1));
#if DAMPED
  vec3 turned = edgeTurning(kLast);
#else
  const vec3 turned = vec3(0);
#endif
  send_a(frame[kLast]);
  send_b(vec4(tangent[kLast], turned.x));
  send_c(vec4(oldEdge(kLast) * inverseLength(kLast), turned.y));
  exchangeBarrier();
  frame_in = received_a(before(1));
  vec4 b = received_b(before(1)), c = received_c(before(1));
  swapBank();
  tangent_in = b.xyz;
  vec3 unit_in = c.xyz;
  frame_in = select(hasBefore(1), frame_in, root.inner_frame);
  tangent_in = select(hasBefore(1), tangent_in, root.tangent_old);
  unit_in = select(hasBefore(1), unit_in, root.tangent_old);
#if DAMPED
  turned_in = select(hasBefore(1), vec3(b.w, c.w, 0), vec3(0, 0, root.spin));  // edgeForce() has the root's swing
#endif
  blend[0] = carryEdge(0, unit_in);
}

// Stiffness of joints and edges in the bending matrix. Then twists the frames to torque equilibrium (tridiagonal system),
// and computes the moments of joints.
void solveJoints(RootMotion root, float blend[PER_THREAD]) {
  vec3 strain[PER_THREAD];
  float margin[PER_THREAD + 1];
  float twist_diagonal[PER_THREAD], lower[PER_THREAD], turn[PER_THREAD];
  float own_first, torque_first;  // part of joint 0 in the last row of the invocation before
#if DAMPED
  vec3 gained[PER_THREAD], turned_before = turned_in;
  const float ahead = DAMPING_TIME * settings.per_substep;
#endif
  vec4 inner = frame_in;
  vec3 t_in = tangent_in;
  for (int p = 0; p < PER_THREAD; ++p) {
    strain[p] = jointStrain(inner, frame[p]);
    vec3 excess = strain[p] - rest_strain[p];
    float c = dot(t_in, tangent[p]);
    float time2 = settings.time2 * madd(DAMPING_TIME_AT(p), settings.per_substep, implicitShare(blend[p]));
    stiffness[p] = bendMatrixStiffness(bends[p], c, time2);
    margin[p] = bendMatrixMargin(stiffness[p], c, excess, kinked);
    float coupling = twistOfBending(strain[p], excess, bends[p]), shear = torqueDifference(strain[p], excess, bends[p]);
#if DAMPED
    vec3 turned = edgeTurning(p);
    gained[p] = gainedStrain(strain[p], turned_before, turned);
    coupling += twistOfDamping(strain[p], bends[p], DAMPING_SUBSTEPS_AT(p));
    shear += torqueDifference(strain[p], gained[p] * DAMPING_SUBSTEPS_AT(p), bends[p]);
    turned_before = turned;
#endif
    float own = twist(p) + coupling, torque = madd(twist(p), excess.z, shear);
    twist_diagonal[p] = own;
    lower[p] = coupling - twist(p);
    turn[p] = shear - twist(p) * excess.z;
    if (p > 0) {
      twist_diagonal[p - 1] += own;
      turn[p - 1] += torque;
    } else {
      own_first = own;
      torque_first = torque;
    }
    inner = frame[p];
    t_in = tangent[p];
  }
  lower[0] = select(hasBefore(1), lower[0], 0.0);

  send_a(vec4(stiffness[0], stiffness[1], margin[0], 0));
  send_b(vec4(tangent[0], own_first));
  send_c(vec4(tangent[1], torque_first));
  exchangeBarrier();
  vec3 a = select(hasAfter(1), received_a(after(1)).xyz, vec3(0));
  vec4 b = received_b(after(1)), c = received_c(after(1));
  swapBank();
  vec3 tangent_out2 = c.xyz;
  tangent_out = b.xyz;
  stiffness[PER_THREAD] = a.x;
  stiffness[PER_THREAD + 1] = a.y;
  margin[PER_THREAD] = a.z;
  twist_diagonal[kLast] += select(hasAfter(1), b.w, 0.0);
  turn[kLast] += select(hasAfter(1), c.w, 0.0);
  softenVertices(margin, blend, tangent_out2);
  for (int p = 0; p < PER_THREAD; ++p) {
    twist_diagonal[p] = select(isEdge(p), twist_diagonal[p], 1.0);
    lower[p] = select(isEdge(p), lower[p], 0.0);
    turn[p] = select(isEdge(p), turn[p], 0.0);
  }

  float turn_in = clamp(solveChain(twist_diagonal, lower, turn), -1.0, 1.0);
  inner = twistFrame(frame_in, turn_in);
  for (int p = 0; p < PER_THREAD; ++p) {
    turn[p] = clamp(turn[p], -1.0, 1.0);
    vec3 untwisted = strain[p];
    strain[p] = twistedStrain(untwisted, turn_in, turn[p]);
    vec3 excess = strain[p] - rest_strain[p];
#if DAMPED
    excess = dampedExcess(excess, gained[p], untwisted, strain[p], DAMPING_SUBSTEPS_AT(p));
#endif
    moment[p] = jointMoment(inner, strain[p], excess, bends[p], twist(p));
    inner = frame[p] = twistFrame(frame[p], turn[p]);
    turn_in = turn[p];
  }
}
