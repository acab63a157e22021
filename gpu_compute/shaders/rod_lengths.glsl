// Part of rod.comp: the length system, which finds the tension increments that restore rest lengths.

// Constraint residual of the edge of slot p, m: its excess length; 0 if both ends are pinned, and for padding.
float lengthResidualOf(int p, float edge_length) {
  float excess = edge_length - restLength(p);
#if PINNED
  excess = lengthResidual(excess, p > 0 ? weight(max(p - 1, 0)) : hasBefore(1) ? weight_in : 0.0, weight(p));
#endif
  return select(isEdge(p), excess, 0.0);
}

// Assembles the tridiagonal length system.
void lengthRows(out float own_diagonal[PER_THREAD], out float lower[PER_THREAD], out float pivot[PER_THREAD]) {
  vec3 t_in = tangent_in;
#if BODIES
  vec3 n_in = normal_in;
#endif
  float w_in = select(hasBefore(1), weight_in, 0.0), soft_in = softness_in, c_in = dot(t_in, tangent[0]);
  for (int p = 0; p < PER_THREAD; ++p) {
    float c = dot(tangent[p], p < kLast ? tangent[min(p + 1, kLast)] : tangent_out);
    float own = weightAlong(w_in, soft_in, c_in) + weightAlong(weight(p), softness[p], c);
    float across = lengthAcross(w_in, soft_in, c_in);
#if BODIES
    own += lengthHeld(tangent[p], n_in, w_in, normals[p], weight(p)) - weightHeld(tangent[p], tangent[p], n_in, w_in) -
           weightHeld(tangent[p], tangent[p], normals[p], weight(p));
    across += weightHeld(tangent[p], t_in, n_in, w_in);
    n_in = normals[p];
#endif
    own_diagonal[p] = select(isEdge(p), own, 1.0);
    lower[p] = select(isEdge(p) && (p > 0 || hasBefore(1)), across, 0.0);
    pivot[p] = lengthPivot(w_in, weight(p));
    t_in = tangent[p];
    w_in = weight(p);
    soft_in = softness[p];
    c_in = c;
  }
}

// Tension increments of one Newton step towards the rest lengths.
void solveLengths(RootMotion root) {
  for (int p = 1; p < PER_THREAD; ++p) {
    vec3 edge_now = newEdge(p);
    tangent[p] = directionOr(edge_now, tangent[p]);
    lambda[p] = lengthResidualOf(p, dot(edge_now, tangent[p]));
  }
  vec3 first = oldEdge(0) + shift[0];  // the first edge, without the displacement of its inner vertex
  send_a(vec4(shift[kLast], softness[kLast]));
  send_b(vec4(tangent[kLast], first.x));
#if BODIES
  send_c(vec4(normals[kLast], first.y));
#else
  send_c(vec4(0, 0, 0, first.y));
#endif
  send_d(first.z);
  exchangeBarrier();
  shift_in = received_a(before(1)).xyz;
  softness_in = received_a(before(1)).w;
  tangent_in = received_b(before(1)).xyz;
#if BODIES
  normal_in = received_c(before(1)).xyz;
#endif
  vec3 first_out = vec3(received_b(after(1)).w, received_c(after(1)).w, received_d(after(1)));
  swapBank();
  shift_in = select(hasBefore(1), shift_in, root.position - x_in);
  softness_in = select(hasBefore(1), softness_in, 0.0);
#if BODIES
  normal_in = select(hasBefore(1), normal_in, vec3(0));
#endif
  tangent[0] = directionOr(newEdge(0), tangent[0]);
  lambda[0] = lengthResidualOf(0, dot(newEdge(0), tangent[0]));
  tangent_out = select(hasAfter(1), directionOr(first_out - shift[kLast], tangent[kLast]), tangent[kLast]);

  float slack[PER_THREAD], lower[PER_THREAD], pivot[PER_THREAD];
  lengthRows(slack, lower, pivot);
  diagonalToSlack(slack, lower);
  lambda_in = solveTridiagonal(slack, lower, pivot, lambda);
  send_d(lambda[0]);
  exchangeBarrier();
  lambda_out = select(hasAfter(1), received_d(after(1)), 0.0);
  swapBank();
}

// Greatest correction strain of this invocation's edges.
float maxCorrectionStrain() {
  float greatest = 0.0, w_in = select(hasBefore(1), weight_in, 0.0);
  for (int p = 0; p < PER_THREAD; ++p) {
    greatest = max(greatest, select(isEdge(p), correctionStrain(lambda[p], w_in, weight(p), inverseLength(p)), 0.0));
    w_in = weight(p);
  }
  return greatest;
}

// Projects a push on a vertex to the contact plane; unchanged without contact.
vec3 held(vec3 push, vec3 normal) {
#if BODIES
  return alongSurface(push, normal);
#else
  return push;
#endif
}

// Push of the tension increments on the vertex of slot p, in the metric with softness `soft`.
vec3 tensionPush(int p, float soft) {
  vec3 t_out = p < kLast ? tangent[min(p + 1, kLast)] : tangent_out;
  return held(shiftByTensions(tangent[p], lambda[p], t_out, p < kLast ? lambda[min(p + 1, kLast)] : lambda_out, soft), NORMAL(p));
}
