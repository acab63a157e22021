// Kernel text (see kernels/README.md): every kernel behind one signature, so that each instantiation can run all of them.
struct KernelInput {
  real v[16];
};
struct KernelOutput {
  real v[9];
};

LANE_FN real3 in3(LANE_IN(KernelInput) i, int at) { return makeReal3(i.v[at], i.v[at + 1], i.v[at + 2]); }
LANE_FN quat in4(LANE_IN(KernelInput) i, int at) { return makeQuat(i.v[at], i.v[at + 1], i.v[at + 2], i.v[at + 3]); }
LANE_FN void out3(LANE_INOUT(KernelOutput) o, int at, LANE_IN(real3) value) {
  o.v[at] = value.x;
  o.v[at + 1] = value.y;
  o.v[at + 2] = value.z;
}
LANE_FN void out4(LANE_INOUT(KernelOutput) o, LANE_IN(quat) value) {
  o.v[0] = value.x;
  o.v[1] = value.y;
  o.v[2] = value.z;
  o.v[3] = value.w;
}

// Kernel numbers are those of tests/conformance/kernel_conformance.h.
LANE_FN KernelOutput runKernel(int kernel, LANE_IN(KernelInput) i) {
  KernelOutput o;
  for (int c = 0; c < 9; ++c) o.v[c] = lit(0);
  if (kernel == 0) {
    real3 a = in3(i, 0);
    real3 b = in3(i, 3);
    solveDistance(a, b, i.v[6], i.v[7], i.v[8]);
    out3(o, 0, a);
    out3(o, 3, b);
  } else if (kernel == 1) {
    real3 a = in3(i, 0);
    real3 b = in3(i, 3);
    real3 p = in3(i, 6);
    solveAngular(p, a, b, i.v[9], i.v[10], i.v[11], in3(i, 12), i.v[15]);
    out3(o, 0, a);
    out3(o, 3, b);
    out3(o, 6, p);
  } else if (kernel == 2) {
    out4(o, rotationBetween(in3(i, 0), in3(i, 3)));
  } else if (kernel == 3) {
    out3(o, 0, rotate(in4(i, 0), in3(i, 4)));
  } else if (kernel == 4) {
    out4(o, interpolateRotation(in4(i, 0), in4(i, 4), i.v[8]));
  } else if (kernel == 5) {
    real3 normal;
    o.v[0] = sphereDistance(in3(i, 0), in3(i, 3), i.v[6], normal);
    out3(o, 1, normal);
  } else if (kernel == 6) {
    real3 normal;
    real along;
    o.v[0] = capsuleDistance(in3(i, 0), in3(i, 3), in3(i, 6), i.v[9], normal, along);
    out3(o, 1, normal);
    o.v[4] = along;
  } else if (kernel == 7) {
    real3 normal;
    o.v[0] = planeDistance(in3(i, 0), in3(i, 3), in3(i, 6), normal);
    out3(o, 1, normal);
  } else if (kernel == 8) {
    real3 force = madd(in3(i, 9), i.v[15], in3(i, 6));
    out3(o, 0, resolveContact(in3(i, 0), in3(i, 3), in3(i, 9), i.v[12], i.v[13], i.v[14], force));
    out3(o, 3, force);
  } else if (kernel == 9) {
    out3(o, 0, predictPosition(in3(i, 0), in3(i, 3), in3(i, 6), in3(i, 9), i.v[12], i.v[13], i.v[14]));
  } else if (kernel == 10) {
    out3(o, 0, normalizeOrZero(in3(i, 0)));
  } else if (kernel == 11) {
    out3(o, 0, carriedBy(in3(i, 0), in3(i, 3), in3(i, 6), in3(i, 9)));
  } else if (kernel == 12) {
    out4(o, multiply(in4(i, 0), in4(i, 4)));
  } else if (kernel == 13) {
    FieldPlace place = fieldPlace(in3(i, 0), in3(i, 3), i.v[6], in3(i, 7));
    o.v[0] = place.brick;
    o.v[1] = place.corner;
    o.v[2] = place.first_sample;
    out3(o, 3, place.in_cell);
    out3(o, 6, place.outside);
  } else if (kernel == 14) {
    real3 gradient;
    o.v[0] = trilinear(i.v[0], i.v[1], i.v[2], i.v[3], i.v[4], i.v[5], i.v[6], i.v[7], in3(i, 8), gradient);
    out3(o, 1, gradient);
  } else if (kernel == 15) {
    o.v[0] = farDistance(i.v[0], in3(i, 1), i.v[4], i.v[5], i.v[6]);
  } else if (kernel == 16) {
    real3 normal;
    o.v[0] = distanceOutsideGrid(in3(i, 0), i.v[3], normal);
    out3(o, 1, normal);
  } else if (kernel == 17) {
    real stiffness = goalStiffness(i.v[9], i.v[10], i.v[11]);
    out3(o, 0, goalPull(in3(i, 0), i.v[9] + stiffness, stiffness, in3(i, 3)));
  } else if (kernel == 18) {
    out3(o, 0, drawnToGoal(in3(i, 0), in3(i, 3), i.v[6], i.v[7]));
  } else if (kernel == 19) {
    out3(o, 0, tethered(in3(i, 0), in3(i, 3), i.v[6]));
  } else if (kernel == 20) {
    GridPlace place = gridPlace(in3(i, 0), makeReal3(i.v[3], i.v[3], i.v[3]));
    out3(o, 0, place.low);
    out3(o, 3, place.part);
  } else if (kernel == 21) {
    o.v[0] = interpolated(i.v[0], i.v[1], i.v[2], i.v[3], i.v[4], i.v[5], i.v[6], i.v[7], in3(i, 8));
  } else if (kernel == 22) {
    o.v[0] = splatWeight(in3(i, 0), i.v[3], i.v[4], i.v[5]);
  } else if (kernel == 23) {
    o.v[0] = macCormack(i.v[0], i.v[1], i.v[2], i.v[3], i.v[4]);
  } else if (kernel == 24) {
    o.v[0] = crowding(i.v[0], i.v[1], i.v[2]);
  } else if (kernel == 25) {
    out3(o, 0, slipDragLoss(in3(i, 0), in3(i, 3), i.v[6], i.v[7]));
  } else if (kernel == 26) {
    o.v[0] = heldCrowding(i.v[0], i.v[1], i.v[2], i.v[3], i.v[4], i.v[5]);
  } else if (kernel == 27) {
    real3 normal;
    real along;
    o.v[0] = taperedCapsuleDistance(in3(i, 0), in3(i, 3), in3(i, 6), i.v[9], i.v[10], normal, along);
    out3(o, 1, normal);
    o.v[4] = along;
  } else if (kernel == 28) {
    real3 normal;
    o.v[0] = boxDistance(in3(i, 0), in3(i, 3), normal);
    out3(o, 1, normal);
  } else if (kernel == 29) {
    real3 normal;
    o.v[0] = ellipsoidDistance(in3(i, 0), in3(i, 3), normal);
    out3(o, 1, normal);
  } else if (kernel == 30) {
    real nearest = i.v[7];
    real3 normal = in3(i, 8);
    convexPlane(in3(i, 0), in3(i, 3), i.v[6], nearest, normal);
    o.v[0] = nearest;
    out3(o, 1, normal);
  } else if (kernel == 31) {
    FieldPlace place = fieldPlace(in3(i, 8), zero3(), lit(0.01), makeReal3(lit(1), lit(1), lit(1)));
    FieldCorners at;
    at.v000 = i.v[0];
    at.v100 = i.v[1];
    at.v010 = i.v[2];
    at.v110 = i.v[3];
    at.v001 = i.v[4];
    at.v101 = i.v[5];
    at.v011 = i.v[6];
    at.v111 = i.v[7];
    at.side = i.v[11];
    real3 normal;
    o.v[0] = fieldDistance(place, at, lit(0.01), i.v[12], i.v[13], i.v[14], normal);
    out3(o, 1, normal);
  } else if (kernel == 32) {
    o.v[0] = blurred(i.v[0], i.v[1], i.v[2]);
  } else if (kernel == 33) {
    o.v[0] = largestCrowding(i.v[0], i.v[1]);
  } else if (kernel == 34) {
    o.v[0] = pushAlong(i.v[0], i.v[1], i.v[2], i.v[3], i.v[4], i.v[5]);
  } else if (kernel == 35) {
    Bend bend;
    bend.one = in3(i, 3) * lit(0.1);
    bend.x = in3(i, 4);
    bend.y = in3(i, 5);
    bend.z = in3(i, 6);
    bend.xx = in3(i, 7);
    bend.yy = in3(i, 8);
    bend.zz = in3(i, 9);
    bend.xy = in3(i, 10);
    bend.yz = in3(i, 11);
    bend.zx = in3(i, 12);
    bend.reach = makeReal3(i.v[15], i.v[15], i.v[15]);
    Bend before = bend;
    before.one = bend.x * lit(0.1);
    out3(o, 0, bendShift(bend, in3(i, 0)));
    out3(o, 3, bentGradient(bend, in3(i, 0), in3(i, 12)));
    out3(o, 6, carriedByBend(before, bend, in3(i, 0)));
  } else if (kernel == 36) {
    real3 gradient = in3(i, 2);
    o.v[0] = bentDistance(i.v[0], i.v[1], gradient);
    out3(o, 1, gradient);
  } else if (kernel == 37) {
    o.v[0] = gapToRemove(in3(i, 0), in3(i, 3), in3(i, 6), in3(i, 9), i.v[12]);
  } else if (kernel == 38) {
    real3 kept_friction;
    real follows;
    out3(o, 0,
         positionOnSurface(in3(i, 0), in3(i, 3), in3(i, 6), in3(i, 9), i.v[12], i.v[13], i.v[14],
                           madd(in3(i, 9), i.v[15], in3(i, 6)), follows, kept_friction));
    o.v[3] = follows;
    out3(o, 4, kept_friction);
  } else if (kernel == 39) {
    out3(o, 0, heldForce(in3(i, 0), in3(i, 3), i.v[12], in3(i, 6), in3(i, 9), i.v[13]));
  } else if (kernel == 40) {
    real3 t = directionOfPiece(in3(i, 7));
    real slip = i.v[10] * i.v[6];
    out3(o, 0,
         draggedAmong(in3(i, 0), in3(i, 3), i.v[6], makeReal3(t.x * t.x, t.y * t.y, t.z * t.z) * slip,
                      makeReal3(t.y * t.z, t.x * t.z, t.x * t.y) * slip));
    out3(o, 3, t);
  } else if (kernel == 41) {
    real3 a = in3(i, 0);
    out3(o, 0, -a);
    out3(o, 3, select(maskAll(), a, zero3()));
    out3(o, 6, select(maskNone(), a, zero3()));
  }
  return o;
}
