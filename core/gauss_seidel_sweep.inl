// One step of a block of strands by position based dynamics after Yuksel and Tariq 2010, "Advanced Techniques in
// Real-time Hair Rendering and Simulation", chapter 3. Included after core/near_bodies.inl. Here is only the order of
// constraints along the strand; kernels/strand.h and kernels/contact.h have the formulas.

inline const Scalar* pbdRow(const Block& b, PbdPlane plane, int i) {
  return b.pbd + (static_cast<size_t>(i) * kPbdPlanes + plane) * kLanes;
}
inline real inverseMass(const Block& b, int i) { return load(pbdRow(b, kInverseMass, i)); }
inline real3 restEdge(const Block& b, int i) {
  const Scalar* row = pbdRow(b, kRestEdge, i);
  return {load(row), load(row + kLanes), load(row + 2 * kLanes)};
}

// scratch: 6 planes of the block's vertices (positions at the start of the substep, edge targets).
inline void stepGaussSeidel(const Block& b, const StepInput& input, Scalar* scratch) {
  const Parameters& p = *input.parameters;
  const int n = b.vertices;
  const double h = p.time_step / p.substeps;
  const real3 gravity = fill3(p.gravity), wind = fill3(p.wind);
  const DragStep drag(p.air_drag, h);
  const double strength_root = 1 - std::exp(-p.shape_rate * h / p.iterations);
  const double strength_tip = 1 - std::exp(-p.shape_rate_tip * h / p.iterations);
  NearBodies near(b, input);
  const Grooming grooming(b, input, scratch);
  const RootFrame root_begin = loadRoot(b, 0), root_end = loadRoot(b, kRootPlanes / 2);
  const real3 forward = makeReal3(lit(0), lit(0), lit(1));
  Scalar* start = scratch;
  Scalar* target = scratch + at(3, 0);

  for (int substep = 0; substep < p.substeps; ++substep) {
    const double time = (substep + 1.0) / p.substeps;
    near.place(input, time);
    const RootFrame root{madd(root_end.position - root_begin.position, lit(time), root_begin.position),
                         interpolateRotation(root_begin.rotation, root_end.rotation, lit(time))};
    near.placeRoots(root.position);

    for (int i = 0; i < n; ++i) {  // predict; pinned vertices ride on the root frame or their bone
      const StepScope scope{StepPart::kPredict};
      const real3 x = load3(b.position, i);
      store3(x, start, i);
      const real3 pulled = b.acceleration != nullptr ? gravity + accelerationOf(b, i) : gravity;
      const real keep = grooming.on() ? grooming.keep(i) : lit(drag.keep),
                 time2 = grooming.on() ? grooming.time2(i) : lit(drag.time2);
      real3 free = predictPosition(x, load3(b.velocity, i), pulled, wind, keep, lit(h), time2);
      const real3 held = heldPoint(b, root, i, time);
      if (grooming.on()) free = drawnToGoal(free, held, grooming.rate(i), time2);
      store3(select(inverseMass(b, i) < lit(0.5), held, free), b.position, i);
    }

    for (int iteration = 0; iteration < p.iterations; ++iteration) {
      quat frame = root.rotation;  // Bishop frame of the edge before edge i, which carries its rest edge
      const real3 root_tangent = rotate(frame, forward);
      real3 tangent = root_tangent;
      real3 x = load3(b.position, 0);
      for (int i = 0; i + 1 < n; ++i) {
        const StepScope scope{StepPart::kBend};
        store3(rotate(frame, restEdge(b, i)), target, i);
        const real3 next_x = load3(b.position, i + 1);
        const real3 next_tangent = normalizeOrZero(next_x - x);
        frame = multiply(transportFrame(tangent, next_tangent), frame);
        tangent = next_tangent;
        x = next_x;
      }
      for (int color = 0; color < 3; ++color) {  // constraints of one colour share no vertex
        const StepScope scope{StepPart::kBend};
        for (int i = color; i + 1 < n; i += 3) {
          const double along = n > 2 ? static_cast<double>(i) / (n - 2) : 0.0;
          real3 a = load3(b.position, i), c = load3(b.position, i + 1);
          real3 before = a - root_tangent;  // the root frame acts as an edge before the first one
          if (i > 0) before = load3(b.position, i - 1);
          solveAngular(before, a, c, i > 0 ? inverseMass(b, i - 1) : lit(0), inverseMass(b, i), inverseMass(b, i + 1),
                       load3(target, i), lit(strength_root + along * (strength_tip - strength_root)));
          if (i > 0) store3(before, b.position, i - 1);
          store3(a, b.position, i);
          store3(c, b.position, i + 1);
        }
      }
      for (int color = 0; color < 2; ++color) {
        const StepScope scope{StepPart::kMove};
        for (int i = color; i + 1 < n; i += 2) {
          real3 a = load3(b.position, i), c = load3(b.position, i + 1);
          solveDistance(a, c, inverseMass(b, i), inverseMass(b, i + 1), load(b.rest_length + at(0, i)));
          store3(a, b.position, i);
          store3(c, b.position, i + 1);
        }
      }
      if (b.grooming != nullptr) {
        const StepScope scope{StepPart::kMove};
        const real3 anchor = load3(b.position, 0);
        for (int i = 1; i < n; ++i) {
          const real3 free = load3(b.position, i);
          const real3 held = tethered(free, anchor, groomingFactor(b, kTether, i));
          store3(select(inverseMass(b, i) > lit(0.5), held, free), b.position, i);
        }
      }
      if (near.size() > 0) {
        const StepScope scope{StepPart::kContact};
        for (int i = 0; i < n; ++i) {
          const real3 reached = load3(b.position, i);
          const ContactPlane plane = near.nearest(i, reached, load3(start, i));
          const mask touches = plane.gap < lit(0) && inverseMass(b, i) > lit(0.5);
          if (!anyTrue(touches)) continue;
          real3 force = zero3();
          const real3 out = resolveContact(reached, plane.carried, plane.normal, plane.gap, plane.friction, lit(1), force);
          store3(select(touches, out, reached), b.position, i);
        }
      }
    }

    const StepScope scope{StepPart::kVelocities};
    for (int i = 0; i < n; ++i) store3((load3(b.position, i) - load3(start, i)) * lit(1 / h), b.velocity, i);
  }
}
