// Bodies near the strands of a block, and contact queries in full vectors. Included after core/strand_sweep.inl.

// Batches contact queries of arbitrary rows and lanes of a block into full SIMD vectors: only a few lanes of a row need
// a query, and a query costs the same for one lane as for all. The result for a vertex does not depend on the other
// lanes.
class ContactQueryBatch {
 public:
  struct Query {
    real3 x, x_start;     // m, query point, and position at the start of the substep
    real way, travelled;  // m, relative travel between the two, and travel before, see NearBodies
    real others;          // m, least separation bound of the bodies that need no query
    real clear;           // m, clearance
  };

  int count() const { return count_; }
  /// Adds the query of row i in `lanes`. Precondition: count() < kLanes.
  void add(int i, const Query& query, const mask& lanes) {
    const real columns[kColumns] = {query.x.x,
                                    query.x.y,
                                    query.x.z,
                                    query.x_start.x,
                                    query.x_start.y,
                                    query.x_start.z,
                                    query.way,
                                    query.travelled,
                                    query.others,
                                    query.clear,
                                    lit(static_cast<double>(i) * kLanes) + laneNumbers()};
    const Packing together = packing(lanes);
    for (int c = 0; c < kColumns; ++c) compressStore(columns[c], together, columns_[c] + count_);
    count_ += std::popcount(laneBits(lanes));
  }
  /// Removes up to kLanes queries and returns their number. `numbers`: per query, row x kLanes + lane.
  int take(Query& query, uint32_t* numbers) {
    real columns[kColumns];
    for (int c = 0; c < kColumns; ++c) {
      columns[c] = load(columns_[c]);
      store(load(columns_[c] + kLanes), columns_[c]);
    }
    query = {{columns[0], columns[1], columns[2]},
             {columns[3], columns[4], columns[5]},
             columns[6],
             columns[7],
             columns[8],
             columns[9]};
    storeAsInt(columns[kColumns - 1], numbers);
    const int taken = std::min(count_, kLanes);
    count_ -= taken;
    return taken;
  }

 private:
  static constexpr int kColumns = 11;
  alignas(64) Scalar columns_[kColumns][2 * kLanes] = {};
  int count_ = 0;
};

// Bodies that the strands of a block may touch in a step, and the contact queries of their vertices. The broad phase
// lists bodies per neighbourhood by the reach of strands; this class keeps those near the block's present positions.
class NearBodies {
 public:
  NearBodies(const Block& b, const StepInput& input) : block_(b), bodies_(input.primitives) {
    if (input.near != nullptr) listed_ = input.near->of(b.neighbourhood);
    is_listed_ = input.near != nullptr;
    if (candidates() == 0) return;
    const StepScope scope{StepPart::kContact};
    all_ = !movesByVelocity(b, input) || b.bone_pins != nullptr;  // bones may move strands anywhere
    const Box box = reach(b, input);
    middle_ = box.center();
    radius_ = 0.5f * box.sizes().norm();
    if (all_) return;
    for (size_t i = 0; i < candidates(); ++i) {
      if (!mayReach(bodies_[candidate(i)], box)) continue;
      if (count_ == kMax) {  // then all candidates are taken
        all_ = true;
        break;
      }
      near_[count_++] = candidate(i);
    }
  }
  /// Number of bodies that the block may touch.
  size_t size() const { return all_ ? candidates() : count_; }

  /// Places the bodies at the end of a substep. Call it at the start of each substep. `time`: as in bodyAt().
  void place(const StepInput& input, double time) {
    const StepScope scope{StepPart::kContact};
    for (size_t i = 0; i < placedBodies(); ++i) placed_[i] = place(i, input, time);
    input_ = &input;
    time_ = time;
    groupMotions();
  }
  /// Sets the positions of the roots at the end of the substep, and finds the bodies that cover some of them. Call it
  /// after place().
  void placeRoots(const real3& roots) {
    if (size() == 0) return;
    const StepScope scope{StepPart::kContact};
    const real way = relativeTravel(roots, load3(block_.position, 0));
    roots_ = roots;
    covered_ = 0;
    for (size_t k = 0; k < placedBodies(); ++k) {
      const Scalar left = known_roots_ ? root_bounds_[k] + reduceMin(-way) : Scalar(-1);
      root_bounds_[k] = left;
      if (left >= 0) continue;
      const real depths = rootDepths(placed_[k]), room = depthForExitArc(firstEdge()) - depths;
      root_bounds_[k] = reduceMin(select(room > lit(-1e9), room, lit(-1e9)));
      if (root_bounds_[k] >= 0) continue;
      covered_ |= uint32_t{1} << k;
      store(depths, root_depths_[k]);
    }
    known_roots_ = true;
  }
  /// Contact plane of the nearest of all bodies for vertex `v`; see closestContact(). Used by gauss_seidel.
  ContactPlane nearest(int v, const real3& x, const real3& x_start) const {
    const real clear = clearance(v), reach = contactReach();
    ContactPlane nearest = noContact(x, reach);
    auto visit = [&](const SubstepBody& body, const Scalar* root_depths) {
      const real own_clear = root_depths != nullptr ? clearanceInReach(clear, load(root_depths), arcLength(v)) : clear;
      ContactPlane own = noContact(x, reach);
      closestContact(body, x, x_start, own_clear, reach, maskAll(), own);
      nearest = chosen(own.gap < nearest.gap, own, nearest);
    };
    forBodies((uint32_t{1} << placedBodies()) - 1, visit);
    nearest.friction = nearest.friction * groomingFactor(block_, kFrictionScale, v);
    return nearest;
  }

  // Contact queries of the rod. Once per substep, each vertex queries the bodies from where it would go without forces.
  // It keeps the contact planes of the two nearest bodies; the passes of the substep read only this contact cache. A
  // vertex far from its query point queries again.
  //
  // Separation bounds: a vertex that was at some distance from a body needs no query of it until it has travelled that
  // far, as seen from any body. Each vertex stores its travel since the start of the step and the least bound over all
  // bodies: a lower limit of (gap + travel) at some earlier time. Each row also stores the bound of every placed body
  // at the start of the step. Bounds skip queries without changing any result. Queries are batched into full SIMD
  // vectors (ContactQueryBatch).

  /// Initialises bounds and travel. Call it at the start of a step, before queueContactQuery(). `rows`: memory for
  /// contactScratch() numbers.
  void initSeparationBounds(const StepInput& input, Scalar* rows) {
    const StepScope scope{StepPart::kContact};
    rows_ = rows;
    separation_bounds_ = rows + static_cast<size_t>(kContactPlanes) * block_.vertices * kLanes;
    for (size_t k = 0; k < placedBodies(); ++k) placed_[k] = place(k, input, 0);
    const real pressed = lit(input.parameters->hair_radius);
    real own[kPlacedBodies];
    for (int i = 1; i < block_.vertices; ++i) {
      const real3 x = load3(block_.position, i);
      const real edge = length(x - load3(block_.position, i - 1));
      real nearest = lit(1e9);
      for (size_t k = 0; k < placedBodies(); ++k) {
        // Far from a body, the bound of the previous vertex less the edge is accurate enough.
        if (i > 1) own[k] = own[k] - edge;
        if (i > 1 && !anyTrue(!(own[k] > lit(kFarOff)))) {
          separationBound(i, k) = static_cast<Scalar>(kFarOff);
        } else {
          own[k] = distanceLowerBound(placed_[k], x) - pressed;
          // A NaN lane must not hide the bodies of the other lanes.
          separationBound(i, k) = reduceMin(select(own[k] > lit(-1e9), own[k], lit(-1e9)));
        }
        nearest = min(nearest, own[k]);
      }
      for (size_t k = placedBodies(); k < kPlacedBodies; ++k) separationBound(i, k) = static_cast<Scalar>(1e9);
      store(size() > kPlacedBodies ? lit(-1e9) : nearest, row(kNearest, i));
      store(lit(0), row(kTravelled, i));
    }
  }
  /// Queues the query of vertex i, which is at x_start and would go to x. Call it at the start of a substep;
  /// runContactQueries() must follow.
  void queueContactQuery(int i, const real3& x, const real3& x_start) {
    planes_[i] = 0;
    queueQuery(i, x, x_start, maskAll());
    if (queries_.count() >= kLanes) queryContacts();
  }
  /// Runs all queued queries.
  void runContactQueries() {
    const StepScope scope{StepPart::kContact};
    while (queries_.count() > 0) queryContacts();
  }
  /// Within the substep: queries again for vertex i, now at x, in those of `lanes` whose cache is stale.
  void requeryIfMoved(int i, const real3& x, const real3& x_start, const mask& lanes) {
    requery(i, x, x_start, lanes, maskNone());
  }
  /// At the end of the substep: as requeryIfMoved(), and also in those of `lanes` that are nearer to a plane than
  /// requeryMargin(). Returns the lanes that have queried, in which penetration must be resolved.
  mask requeryIfMovedOrNear(int i, const real3& x, const real3& x_start, const mask& lanes) {
    const mask near = planes_[i] > 0 ? lanes && gap(i, x) < requeryMargin() : maskNone();
    return requery(i, x, x_start, lanes, near);
  }
  /// Relative travel: upper bound of the distance from x_start to x as seen from any body, m.
  real relativeTravel(const real3& x, const real3& x_start) const {
    real most = lit(0);
    for (size_t m = 0; m < motions_; ++m) {
      const Motion& motion = motion_[m];
      auto along = [&](int c) {
        const Scalar* turn = motion.turn[c];
        return madd(x_start.x, lit(turn[0]), madd(x_start.y, lit(turn[1]), madd(x_start.z, lit(turn[2]), lit(motion.shift[c]))));
      };
      const real3 way = x - x_start - makeReal3(along(0), along(1), along(2));
      most = max(most, length(way) + lit(motion.slack));
    }
    return most;
  }
  /// Adds `way`, m, to the travel of vertex i since the start of the step.
  void addTravel(int i, const real& way) { store(load(row(kTravelled, i)) + way, row(kTravelled, i)); }
  bool hasContactPlane(int i) const { return planes_[i] > 0; }
  /// Gap of vertex i at x to its nearest contact plane, m, at most contactReach().
  real gap(int i, const real3& x) const {
    real nearest = contactReach();
    for (int n = 0; n < planes_[i]; ++n) nearest = min(dot(get3(kNormal + n * kPlaneRows, i), x) - get(offsetOf(n), i), nearest);
    return nearest;
  }
  /// Contact plane number n of vertex i at x, without the strand's friction factor.
  ContactPlane plane(int n, int i, const real3& x) const {
    const int at = n * kPlaneRows;
    const real3 normal = get3(kNormal + at, i);
    return {dot(normal, x) - get(kOffset + at, i), normal, get3(kCarried + at, i), get(kFriction + at, i)};
  }
  /// Square of the greatest distance by which nearby bodies carry a point from x_start in this substep, m^2, for vertex
  /// i at x. Each distance is weighted by the body's nearness().
  real carried2(int i, const real3& x, const real3& x_start) const {
    real most = lit(0);
    for (int n = 0; n < planes_[i]; ++n) {
      const ContactPlane own = plane(n, i, x);
      const real near = nearness(own.gap);
      const real3 way = (own.carried - x_start) * near;
      most = select(near > lit(0), max(most, dot(way, way)), most);
    }
    return most;
  }
  /// Lanes in which vertex i has two contact planes.
  mask hasTwoContactPlanes(int i) const {
    if (planes_[i] < 2) return maskNone();
    return min(get(offsetOf(0), i), get(offsetOf(1), i)) > lit(kNoPlane);
  }
  /// Deepest contact plane of vertex i at x, with the strand's friction factor.
  ContactPlane deepestPlane(int i, const real3& x) const {
    ContactPlane nearest = noContact(x, contactReach());
    for (int n = 0; n < planes_[i]; ++n) {
      const ContactPlane own = plane(n, i, x);
      nearest = chosen(own.gap < nearest.gap, own, nearest);
    }
    nearest.friction = nearest.friction * groomingFactor(block_, kFrictionScale, i);
    return nearest;
  }

 private:
  static constexpr size_t kMax = 64;
  static constexpr double kFarOff = 0.01;      // m, more than most vertices travel in a step
  static_assert(kPlacedBodies % kLanes == 0);  // bounds are read as vectors

  const MovingPrimitive& body(size_t i) const { return bodies_[all_ ? candidate(i) : near_[i]]; }
  size_t placedBodies() const { return std::min<size_t>(size(), kPlacedBodies); }
  size_t candidates() const { return is_listed_ ? listed_.size() : bodies_.size(); }
  uint32_t candidate(size_t i) const { return is_listed_ ? listed_[i] : static_cast<uint32_t>(i); }

  // Clearance of vertex v from every body, m.
  real clearance(int v) const {
    const real radius = lit(input_->parameters->hair_radius);
    return block_.rest_distance == nullptr ? radius : min(radius, load(block_.rest_distance + size_t(v) * kLanes));
  }

  // A body that covers a root more deeply than at rest keeps vertices near that root inside it (clearanceInReach). The
  // depths of a placed body are recomputed only in substeps in which it may have reached a root.

  real firstEdge() const { return load(block_.rest_length + at(0, 0)); }
  // Depth of the roots in a body beyond their clearance, m. For roots outside the body the result is at most 0 and a
  // lower bound.
  real rootDepths(const SubstepBody& body) const {
    const real clear = clearance(0);
    if (body.kind != PrimitiveKind::kPlane) {
      const real room = length(roots_ - spread(body.middle)) - lit(body.ball);
      if (!anyTrue(room < clear)) return clear - room;
    }
    return clear - surfaceAt(body, roots_, noClearance(), maskAll()).distance;
  }
  // Arc length of vertex i from its root, m.
  real arcLength(int i) const {
    real sum = lit(0);
    for (int e = 0; e < i; ++e) sum = sum + load(block_.rest_length + at(0, e));
    return sum;
  }
  // clearanceInReach() of the vertices `numbers` (row x kLanes + lane), of `lanes`, for a body with these root depths.
  [[gnu::noinline]] real clearInReach(const real& clear, const Scalar* root_depths, const uint32_t* numbers,
                                      const mask& lanes) const {
    alignas(64) Scalar depths[kLanes] = {}, arcs[kLanes] = {};
    forLanes(lanes, [&](int lane) {
      const size_t i = numbers[lane] / kLanes, strand = numbers[lane] % kLanes;
      depths[lane] = root_depths[strand];
      for (size_t e = 0; e < i; ++e) arcs[lane] += block_.rest_length[at(0, static_cast<int>(e)) + strand];
    });
    return clearanceInReach(clear, load(depths), load(arcs));
  }
  // Calls work(body, root depths) for the placed bodies of the bit mask `placed` and for all bodies that are not
  // placed. Depths are null if they change nothing.
  template <class Work>
  void forBodies(uint32_t placed, const Work& work) const {
    for (; placed != 0; placed &= placed - 1) {
      const int k = std::countr_zero(placed);
      work(placed_[k], (covered_ >> k & 1) != 0 ? root_depths_[k] : nullptr);
    }
    for (size_t k = placedBodies(); k < size(); ++k) {
      const SubstepBody body = place(k, *input_, time_);
      alignas(64) Scalar depths[kLanes];
      const real own = rootDepths(body);
      store(own, depths);
      work(body, anyTrue(exitArcLength(own) > firstEdge()) ? depths : nullptr);
    }
  }

  SubstepBody place(size_t i, const StepInput& input, double time) const {
    const Parameters& p = *input.parameters;
    const uint32_t* words = input.shapes != nullptr ? input.shapes->words.data() : nullptr;
    return bodyAt(body(i), words, time, 1.0 / p.substeps, static_cast<double>(p.time_step) / p.substeps, p.hair_radius);
  }

  // Rows of the contact cache. kTravelled: travel since the start of the step; kNearest: least separation bound;
  // kQueryPoint: newest query point. Per plane: normal, normal . point of the plane, ContactPlane::carried, friction.
  enum ContactRow : int {
    kTravelled,
    kNearest,
    kQueryPoint,
    kPlanes = kQueryPoint + 3,
    kNormal = kPlanes,
    kOffset = kNormal + 3,
    kCarried,
    kFriction = kCarried + 3,
    kPlanesEnd
  };
  static constexpr int kPlaneRows = kPlanesEnd - kPlanes, kMaxPlanes = 2;
  static_assert(kPlanes + kMaxPlanes * kPlaneRows == kContactPlanes);
  Scalar* row(int plane, int i) const { return rows_ + (static_cast<size_t>(i) * kContactPlanes + plane) * kLanes; }
  real get(int plane, int i) const { return load(row(plane, i)); }
  real3 get3(int plane, int i) const { return {get(plane, i), get(plane + 1, i), get(plane + 2, i)}; }
  static constexpr int offsetOf(int n) { return kOffset + n * kPlaneRows; }  // of plane number n
  static constexpr double kNoPlane = -1e9;                                   // m, offset of a plane that does not exist
  // Separation bound of body k at the start of the step for row i: the least of all lanes.
  Scalar& separationBound(int i, size_t k) const { return separation_bounds_[static_cast<size_t>(i) * kPlacedBodies + k]; }
  // Queries again in those lanes of `those` that are far from their query point, and in `others`. Returns these lanes.
  mask requery(int i, const real3& x, const real3& x_start, const mask& those, const mask& others) {
    const real3 off = x - get3(kQueryPoint, i);
    const mask lanes = those && (dot(off, off) > queryReach() * queryReach() || others);
    if (anyTrue(lanes)) {
      for (int n = 0; n < planes_[i]; ++n) store(select(lanes, lit(kNoPlane), get(offsetOf(n), i)), row(offsetOf(n), i));
      queueQuery(i, x, x_start, lanes);
      runContactQueries();
    }
    return lanes;
  }
  // Queues the query of vertex i from x in `lanes`, unless separation bounds exclude every body.
  void queueQuery(int i, const real3& x, const real3& x_start, const mask& lanes) {
    const real way = relativeTravel(x, x_start), travelled = get(kTravelled, i), nearest = get(kNearest, i);
    const real3 from = select(lanes, x, get3(kQueryPoint, i));
    store(from.x, row(kQueryPoint, i));
    store(from.y, row(kQueryPoint + 1, i));
    store(from.z, row(kQueryPoint + 2, i));
    const real ahead = travelled + way + reachAlong(way);
    const mask may_see = lanes && ahead >= nearest;
    if (!anyTrue(may_see)) return;
    const Scalar farthest = -reduceMin(select(may_see, -ahead, lit(0)));
    real others = lit(1e9);  // least bound of the bodies that no lane of the row has to query
    uint32_t near = 0;
    for (int k = 0; k < kPlacedBodies; k += kLanes) {
      const real bounds = load(&separationBound(i, k));
      const mask may_be_seen = bounds <= lit(farthest);
      near |= laneBits(may_be_seen) << k;
      others = min(others, select(may_be_seen, others, bounds));
    }
    queried_bodies_ |= near;
    queries_.add(i, {x, x_start, way, travelled, max(nearest, lit(reduceMin(others))), clearance(i)}, may_see);
  }
  static real reachAlong(const real& way) { return madd(way, lit(0.5), queryReach()); }

  // Runs one vector of queued queries. Not inlined, so that sweeps of strands far from bodies stay small.
  [[gnu::noinline]] void queryContacts() {
    ContactQueryBatch::Query at;
    alignas(64) uint32_t numbers[kLanes];
    const int count = queries_.take(at, numbers);
    const mask lanes = firstLanes(count);
    const real reach = reachAlong(at.way);
    ContactPlane first = noContact(at.x, reach), second = first;
    real nearest = at.others;
    auto visit = [&](const SubstepBody& body, const Scalar* root_depths) {
      ContactPlane own = noContact(at.x, reach);
      real clear = at.clear;
      if (root_depths != nullptr) clear = clearInReach(clear, root_depths, numbers, lanes);
      real gap = closestContact(body, at.x, at.x_start, clear, reach, lanes, own);
      if (root_depths != nullptr) gap = gap - (at.clear - clear);  // the root may leave it
      if (anyTrue(own.gap < second.gap)) {
        const mask nearer = own.gap < first.gap;
        second = chosen(nearer, first, chosen(own.gap < second.gap, own, second));
        first = chosen(nearer, own, first);
      }
      nearest = min(nearest, gap + at.travelled - at.way);  // the gap is at x, to which it has not travelled yet
    };
    forBodies(queried_bodies_, visit);
    if (queries_.count() == 0) queried_bodies_ = 0;
    const real rows[1] = {size() > kPlacedBodies ? lit(-1e9) : nearest};  // bodies that are not placed have no bound
    scatter(rows, kNearest, numbers, lanes);
    const mask sees_one = lanes && first.gap < reach, sees_two = lanes && second.gap < reach;
    const real room = pinch(first.gap, first.normal, second.gap, second.normal);
    first.gap = first.gap + room;
    second.gap = second.gap + room;
    storePlane(0, first, at.x, numbers, sees_one);
    storePlane(1, second, at.x, numbers, sees_two);
  }
  // Stores contact plane number n of the vertices `numbers`, of `lanes`.
  void storePlane(int n, const ContactPlane& plane, const real3& x, const uint32_t* numbers, const mask& lanes) {
    if (!anyTrue(lanes)) return;
    forLanes(lanes, [&](int lane) {
      const uint32_t i = numbers[lane] / kLanes;
      if (planes_[i] > n) return;
      planes_[i] = static_cast<uint8_t>(n + 1);
      // Other lanes have no plane n: clear the rows, whose old contents would be taken for a normal.
      for (int c = 0; c < 3; ++c) store(lit(0), row(kNormal + n * kPlaneRows + c, static_cast<int>(i)));
      store(lit(kNoPlane), row(offsetOf(n), static_cast<int>(i)));
    });
    const real rows[kPlaneRows] = {plane.normal.x,  plane.normal.y,  plane.normal.z,  dot(plane.normal, x) - plane.gap,
                                   plane.carried.x, plane.carried.y, plane.carried.z, plane.friction};
    scatter(rows, kPlanes + n * kPlaneRows, numbers, lanes);
  }
  // Writes values to the rows from `plane` on of the vertices `numbers`, of `lanes`.
  template <size_t kRows>
  void scatter(const real (&values)[kRows], int plane, const uint32_t* numbers, const mask& lanes) {
    alignas(64) Scalar columns[kRows][kLanes];
    for (size_t c = 0; c < kRows; ++c) store(values[c], columns[c]);
    forLanes(lanes, [&](int lane) {
      Scalar* to = row(plane, static_cast<int>(numbers[lane] / kLanes)) + numbers[lane] % kLanes;
      for (size_t c = 0; c < kRows; ++c) to[c * kLanes] = columns[c][lane];
    });
  }

  // Displacement field of a body in a substep: turn x point + shift, with an error of at most `slack` (m) where the
  // strands are.
  struct Motion {
    Scalar turn[3][3], shift[3], slack;
  };
  Motion motionOf(const SubstepBody& body, Scalar substeps) const {
    const Scalar(&w)[3] = body.turn;
    const Scalar w2 = w[0] * w[0] + w[1] * w[1] + w[2] * w[2];
    Motion out;
    Scalar off2 = 0;
    for (int r = 0; r < 3; ++r) {  // as carriedBy() has it
      const int s = (r + 1) % 3, t = (r + 2) % 3;
      for (int c = 0; c < 3; ++c) out.turn[r][c] = w[r] * w[c] / 2;
      out.turn[r][r] -= w2 / 2;
      out.turn[r][s] -= w[t];
      out.turn[r][t] += w[s];
      const Scalar off = static_cast<Scalar>(middle_[r]) - body.a[r];
      off2 += off * off;
    }
    for (int r = 0; r < 3; ++r) {
      out.shift[r] = body.a_motion[r];
      for (int c = 0; c < 3; ++c) out.shift[r] -= out.turn[r][c] * (body.a[c] - body.a_motion[c]);
    }
    // Third-order terms: what carriedBy() omits, and the uneven speed of interpolateRotation().
    const Scalar turn = std::sqrt(w2) * substeps;
    out.slack = turn * turn * turn / 60 * (std::sqrt(off2) + static_cast<Scalar>(radius_));
    if (isBent(body)) out.slack += movingBendOf(body).shift * body.part;
    return out;
  }
  // Upper bound of the difference of two displacement fields, m, where the strands are.
  Scalar difference(const Motion& a, const Motion& b) const {
    Scalar turn2 = 0, shift2 = 0;
    for (int r = 0; r < 3; ++r) {
      Scalar shift = a.shift[r] - b.shift[r];
      for (int c = 0; c < 3; ++c) {
        const Scalar turn = a.turn[r][c] - b.turn[r][c];
        shift += turn * static_cast<Scalar>(middle_[c]);
        turn2 += turn * turn;
      }
      shift2 += shift * shift;
    }
    return std::sqrt(shift2) + std::sqrt(turn2) * static_cast<Scalar>(radius_);
  }
  // Collects the motions of the placed bodies; bodies with nearly equal motions share one.
  void groupMotions() {
    constexpr Scalar kMotionTolerance = static_cast<Scalar>(1e-4);  // m
    motions_ = 0;
    for (size_t k = 0; k < placedBodies(); ++k) {
      const Motion own = motionOf(placed_[k], static_cast<Scalar>(input_->parameters->substeps));
      Motion* known = nullptr;
      for (size_t m = 0; m < motions_ && known == nullptr; ++m)
        if (difference(motion_[m], own) < kMotionTolerance) known = &motion_[m];
      if (known != nullptr)
        known->slack = std::max(known->slack, own.slack + difference(*known, own));
      else
        motion_[motions_++] = own;
    }
  }

  // Whether strands move only as their velocities say: no edge is stretched or deviates from its frame, as after an
  // upload of another state. False for gauss_seidel, which does not keep lengths.
  static bool movesByVelocity(const Block& b, const StepInput& input) {
    if (input.parameters->solver != SolverKind::kRod) return false;
    for (int e = 0; e + 1 < b.vertices; ++e) {
      const real3 edge = load3(b.position, e + 1) - load3(b.position, e);
      const real length = load(b.rest_length + at(0, e));
      const quat frame = {load(b.frame + at(0, e)), load(b.frame + at(1, e)), load(b.frame + at(2, e)), load(b.frame + at(3, e))};
      const real along = dot(edge, frameTangent(frame));
      const mask off = along < length * lit(0.9) || dot(edge, edge) > length * length * lit(1.02);
      if (anyTrue(off)) return false;
    }
    return true;
  }

  // Box that holds all vertices in the step: twice as far from their positions as their speeds, forces and root motion
  // say.
  static Box reach(const Block& b, const StepInput& input) {
    real3 low = load3(b.position, 0), high = low;
    real speed2 = lit(0), length = lit(0), pushed2 = lit(0);
    for (int i = 0; i < b.vertices; ++i) {
      const real3 x = load3(b.position, i), v = load3(b.velocity, i);
      low = {min(low.x, x.x), min(low.y, x.y), min(low.z, x.z)};
      high = {max(high.x, x.x), max(high.y, x.y), max(high.z, x.z)};
      speed2 = max(speed2, dot(v, v));
      length = length + load(b.rest_length + at(0, i));
      if (b.acceleration != nullptr) pushed2 = max(pushed2, dot(accelerationOf(b, i), accelerationOf(b, i)));
    }
    const RootFrame begin = loadRoot(b, 0), end = loadRoot(b, kRootPlanes / 2);
    const real3 moved = end.position - begin.position;
    const quat p = begin.rotation, q = end.rotation;
    const real cosine = min(abs(madd(p.x, q.x, madd(p.y, q.y, madd(p.z, q.z, p.w * q.w)))), lit(1));
    const Parameters& parameters = *input.parameters;
    const double dt = parameters.time_step;
    const double pulled = parameters.gravity.norm() + 2 * parameters.air_drag * parameters.wind.norm();  // m/s^2
    const double blown = b.grooming != nullptr ? parameters.wind.norm() * dt : 0;                        // m, with any drag
    // Fraction of the distance to their goals, which is at most twice their length plus the root's displacement.
    const double drawn = std::min(1.0, 0.5 * std::pow(parameters.goal_rate * dt, 2));
    // 4 sqrt(1 - cosine) is an upper bound of the rotation angle.
    const real swung = sqrt(lit(1) - cosine) * lit(4) * length;
    real far = lit(2) * (sqrt(speed2) * lit(dt) + sqrt(dot(moved, moved)) + swung + length * lit(2 * drawn) +
                         lit(0.5 * dt * dt * pulled + blown));
    if (b.acceleration != nullptr) far = madd(sqrt(pushed2), lit(dt * dt), far);
    low = {low.x - far, low.y - far, low.z - far};
    high = {high.x + far, high.y + far, high.z + far};

    alignas(64) Scalar lanes[6][kMaxLanes];
    const real bounds[6] = {low.x, low.y, low.z, high.x, high.y, high.z};
    for (int k = 0; k < 6; ++k) store(bounds[k], lanes[k]);
    Box box;
    for (int lane = 0; lane < kLanes; ++lane)
      for (int corner = 0; corner < 6; corner += 3)
        box.extend(Vec3(static_cast<float>(lanes[corner][lane]), static_cast<float>(lanes[corner + 1][lane]),
                        static_cast<float>(lanes[corner + 2][lane])));
    const float radius = parameters.hair_radius + kQueryReach;
    box.min().array() -= radius;
    box.max().array() += radius;
    return box;
  }

  static bool mayReach(const MovingPrimitive& body, const Box& box) {
    if (body.kind == static_cast<uint32_t>(PrimitiveKind::kPlane)) {
      auto below = [&](const Vec3& point, const Vec3& normal) {
        return (box.center() - point).dot(normal) < 0.5f * box.sizes().dot(normal.cwiseAbs());
      };
      return below(Vec3(body.a_begin), Vec3(body.b_begin)) || below(Vec3(body.a_end), Vec3(body.b_end));
    }
    return box.intersects(sweptBox(body));
  }

  const Block& block_;
  std::span<const MovingPrimitive> bodies_;
  std::span<const uint32_t> listed_;
  bool is_listed_ = false;
  uint32_t near_[kMax];
  size_t count_ = 0;
  bool all_ = false;
  SubstepBody placed_[kPlacedBodies];
  Motion motion_[kPlacedBodies];
  size_t motions_ = 0;
  Vec3 middle_ = Vec3::Zero();  // m, centre of a box that holds the strands throughout the step
  float radius_ = 0;            // m, radius of its bounding ball
  real3 roots_ = zero3();
  uint32_t covered_ = 0;  // bit mask of placed bodies that cover some root; root_depths_ has the depths of these
  alignas(64) Scalar root_depths_[kPlacedBodies][kLanes];
  Scalar root_bounds_[kPlacedBodies];  // m, separation bound of the roots from covering, per placed body
  bool known_roots_ = false;
  Scalar *rows_ = nullptr, *separation_bounds_ = nullptr;
  ContactQueryBatch queries_;
  uint32_t queried_bodies_ = 0;            // bit mask of placed bodies that some queued query needs
  uint8_t planes_[kMaxVerticesPerStrand];  // contact planes that any lane of the vertex has in this substep
  const StepInput* input_ = nullptr;
  double time_ = 0;
};
