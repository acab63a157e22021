// The bodies that the strands of a block may touch in a step: of those that the broad phase has listed for its neighbourhood by
// how far strands reach, the ones near where its strands are now. Included after core/strand_sweep.inl.
class NearBodies {
 public:
  NearBodies(const Block& b, const StepInput& input) : block_(b), bodies_(input.primitives) {
    if (input.near != nullptr) listed_ = input.near->of(b.neighbourhood);
    is_listed_ = input.near != nullptr;
    if (candidates() == 0) return;
    const StepScope scope{StepPart::kContact};
    all_ = !calm(b, input) || b.bone_pins != nullptr;  // a bone may pull strands anywhere
    const Box box = reach(b, input);
    middle_ = box.center();
    radius_ = 0.5f * box.sizes().norm();
    if (all_) return;
    for (size_t i = 0; i < candidates(); ++i) {
      if (!meets(bodies_[candidate(i)], box)) continue;
      if (count_ == kMost) {  // then all are taken
        all_ = true;
        break;
      }
      near_[count_++] = candidate(i);
    }
  }
  size_t size() const { return all_ ? candidates() : count_; }

  /// To be called at the start of a substep. `time` as of bodyAt().
  void place(const StepInput& input, double time) {
    const StepScope scope{StepPart::kContact};
    for (size_t i = 0; i < kept(); ++i) placed_[i] = place(i, input, time);
    input_ = &input;
    time_ = time;
    noteMotions();
  }
  /// After that: where the roots are at the end of the substep.
  void placeRoots(const real3& roots) {
    if (size() == 0) return;
    const StepScope scope{StepPart::kContact};
    const real way = wayAlong(roots, load3(block_.position, 0));
    roots_ = roots;
    covered_ = 0;
    for (size_t k = 0; k < kept(); ++k) {
      const Scalar left = known_roots_ ? root_rooms_[k] + leastOf(lit(0) - way) : Scalar(-1);
      root_rooms_[k] = left;
      if (left >= 0) continue;
      const real depths = rootDepths(placed_[k]), room = depthOfWayOut(firstEdge()) - depths;
      root_rooms_[k] = leastOf(select(room > lit(-1e9), room, lit(-1e9)));
      if (root_rooms_[k] >= 0) continue;
      covered_ |= uint32_t{1} << k;
      store(depths, root_depths_[k]);
    }
    known_roots_ = true;
  }
  /// Of all bodies the nearest to vertex `v`; see meet().
  Touch nearest(int v, const real3& x, const real3& x_start) const {
    const real clear = clearance(v), reach = contactReach();
    const mask all = lit(0) < lit(1);
    Touch nearest = untouched(x, reach);
    auto lookAt = [&](const SubstepBody& body, const Scalar* root_depths) {
      const real own_clear = root_depths != nullptr ? clearanceInReach(clear, load(root_depths), arcLength(v)) : clear;
      Touch own = untouched(x, reach);
      meet(body, x, x_start, own_clear, reach, all, own);
      nearest = chosen(own.gap < nearest.gap, own, nearest);
    };
    forBodies((uint32_t{1} << kept()) - 1, lookAt);
    nearest.friction = nearest.friction * groomingFactor(block_, kFrictionScale, v);
    return nearest;
  }

  // The rod's vertices look at the bodies once a substep, from where they would go by themselves, and keep the planes along the
  // two nearest: all that it asks of them, but for those that come far from where they looked, who look again.
  // Rooms: a vertex that was some way off a body and has not gone as far since, seen from whatever body, need not look at it.
  // Of every vertex is kept how far it has gone since the start of the step, and a limit: a distance that is at most the least
  // gap at some time plus how far the vertex had gone then; of every row and body the limit of the step's start. Nothing comes
  // out otherwise for that. Those that have to look wait until they are a whole vector (core/waiting_looks.inl).

  /// To be called at the start of a step, for what follows. `rows`: contactScratch() numbers.
  void measureRooms(const StepInput& input, Scalar* rows) {
    const StepScope scope{StepPart::kContact};
    rows_ = rows;
    limits_ = rows + static_cast<size_t>(kContactPlanes) * block_.vertices * kLanes;
    for (size_t k = 0; k < kept(); ++k) placed_[k] = place(k, input, 0);
    const real pressed = lit(input.parameters->hair_radius);
    real own[kPlacedBodies];
    for (int i = 1; i < block_.vertices; ++i) {
      const real3 x = load3(block_.position, i);
      const real edge = length(x - load3(block_.position, i - 1));
      real nearest = lit(1e9);
      for (size_t k = 0; k < kept(); ++k) {
        // What is far off need not be known better than the vertex before tells.
        if (i > 1) own[k] = own[k] - edge;
        if (i > 1 && !anyTrue(!(own[k] > lit(kFarOff)))) {
          limit(i, k) = static_cast<Scalar>(kFarOff);
        } else {
          own[k] = leastDistance(placed_[k], x) - pressed;
          // A lane that is not a number must not hide the others' bodies.
          limit(i, k) = leastOf(select(own[k] > lit(-1e9), own[k], lit(-1e9)));
        }
        nearest = min(nearest, own[k]);
      }
      for (size_t k = kept(); k < kPlacedBodies; ++k) limit(i, k) = static_cast<Scalar>(1e9);
      store(size() > kPlacedBodies ? lit(-1e9) : nearest, row(kNearest, i));
      store(lit(0), row(kGone, i));
    }
  }
  /// At the start of a substep, for vertex i, which is at x_start and would go to x. To be followed by lookAround().
  void lookAhead(int i, const real3& x, const real3& x_start) {
    planes_[i] = 0;
    want(i, x, x_start, lit(0) < lit(1));
    if (waiting_.count() >= kLanes) look();
  }
  /// After the last of these: all have looked.
  void lookAround() {
    const StepScope scope{StepPart::kContact};
    while (waiting_.count() > 0) look();
  }
  /// In it, for vertex i of `lanes`, which has come to x.
  void lookOn(int i, const real3& x, const real3& x_start, const mask& lanes) {
    lookAgain(i, x, x_start, lanes, lit(0) < lit(0));
  }
  /// At its end, the same; of `lanes` those too that may be in a body. Gives which of them are to be held out of it.
  mask lookBack(int i, const real3& x, const real3& x_start, const mask& lanes) {
    const mask near = planes_[i] > 0 ? lanes && gap(i, x) < lookMargin() : lit(0) < lit(0);
    return lookAgain(i, x, x_start, lanes, near);
  }
  /// How far it is from x_start to x, at most, seen from whatever body.
  real wayAlong(const real3& x, const real3& x_start) const {
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
  /// In this substep it has gone so far.
  void goOn(int i, const real& way) { store(load(row(kGone, i)) + way, row(kGone, i)); }
  bool sees(int i) const { return planes_[i] > 0; }
  /// How far x is from what vertex i sees, m, at most contactReach().
  real gap(int i, const real3& x) const {
    real nearest = contactReach();
    for (int n = 0; n < planes_[i]; ++n) nearest = min(dot(get3(kNormal + n * kPlaneRows, i), x) - get(offsetOf(n), i), nearest);
    return nearest;
  }
  /// What plane number n of those that vertex i sees is to it at x, without the strand's factor of friction.
  Touch plane(int n, int i, const real3& x) const {
    const int at = n * kPlaneRows;
    const real3 normal = get3(kNormal + at, i);
    return {dot(normal, x) - get(kOffset + at, i), normal, get3(kCarried + at, i), get(kFriction + at, i)};
  }
  /// The square of how far what is near vertex i at x takes a point that was at x_start in this substep, m^2; less
  /// of what is less near.
  real carried2(int i, const real3& x, const real3& x_start) const {
    real most = lit(0);
    for (int n = 0; n < planes_[i]; ++n) {
      const Touch own = plane(n, i, x);
      const real near = nearness(own.gap);
      const real3 way = (own.carried - x_start) * near;
      most = select(near > lit(0), max(most, dot(way, way)), most);
    }
    return most;
  }
  /// Lanes in which vertex i sees two planes.
  mask seesTwo(int i) const {
    if (planes_[i] < 2) return lit(0) < lit(0);
    return min(get(offsetOf(0), i), get(offsetOf(1), i)) > lit(kNoPlane);
  }
  /// What the bodies that vertex i sees are to it at x.
  Touch touch(int i, const real3& x) const {
    Touch nearest = untouched(x, contactReach());
    for (int n = 0; n < planes_[i]; ++n) {
      const Touch own = plane(n, i, x);
      nearest = chosen(own.gap < nearest.gap, own, nearest);
    }
    nearest.friction = nearest.friction * groomingFactor(block_, kFrictionScale, i);
    return nearest;
  }

 private:
  static constexpr size_t kMost = 64;
  static constexpr double kFarOff = 0.01;       // m, more than most vertices go in a step
  static_assert(kPlacedBodies % kLanes == 0);  // limits are read by vectors

  const MovingPrimitive& body(size_t i) const { return bodies_[all_ ? candidate(i) : near_[i]]; }
  size_t kept() const { return std::min<size_t>(size(), kPlacedBodies); }
  size_t candidates() const { return is_listed_ ? listed_.size() : bodies_.size(); }
  uint32_t candidate(size_t i) const { return is_listed_ ? listed_[i] : static_cast<uint32_t>(i); }

  // How far from every body vertex v must be.
  real clearance(int v) const {
    const real radius = lit(input_->parameters->hair_radius);
    return block_.rest_distance == nullptr ? radius : min(radius, load(block_.rest_distance + size_t(v) * kLanes));
  }

  // Roots that a body covers, deeper than they are at rest, hold vertices near them in it (clearanceInReach). Of a placed body
  // that is known anew in the substeps in which it may have come over some of them.

  real firstEdge() const { return load(block_.rest_length + at(0, 0)); }
  // How much deeper in the body roots are than their clearance asks, m; of those that are in none at most 0, and at least that.
  real rootDepths(const SubstepBody& body) const {
    const real clear = clearance(0);
    if (body.kind != PrimitiveKind::kPlane) {
      const real room = length(roots_ - spread(body.middle)) - lit(body.ball);
      if (!anyTrue(room < clear)) return clear - room;
    }
    return clear - surfaceAt(body, roots_, pushedByNothing(), lit(0) < lit(1)).distance;
  }
  // Of vertex i, from the root, m.
  real arcLength(int i) const {
    real sum = lit(0);
    for (int e = 0; e < i; ++e) sum = sum + load(block_.rest_length + at(0, e));
    return sum;
  }
  // `clear` of these vertices, of `lanes`, for a body in which their strands' roots are so deep.
  [[gnu::noinline]] real clearInReach(const real& clear, const Scalar* root_depths, const uint32_t* numbers, const mask& lanes) const {
    alignas(64) Scalar depths[kLanes] = {}, arcs[kLanes] = {};
    forLanes(lanes, [&](int lane) {
      const size_t i = numbers[lane] / kLanes, strand = numbers[lane] % kLanes;
      depths[lane] = root_depths[strand];
      for (size_t e = 0; e < i; ++e) arcs[lane] += block_.rest_length[at(0, static_cast<int>(e)) + strand];
    });
    return clearanceInReach(clear, load(depths), load(arcs));
  }
  // Calls work(body, depths of the roots) for placed bodies, as bits, and for all others; without depths where nothing comes of them.
  template <class Work>
  void forBodies(uint32_t placed, const Work& work) const {
    for (; placed != 0; placed &= placed - 1) {
      const int k = std::countr_zero(placed);
      work(placed_[k], (covered_ >> k & 1) != 0 ? root_depths_[k] : nullptr);
    }
    for (size_t k = kept(); k < size(); ++k) {
      const SubstepBody body = place(k, *input_, time_);
      alignas(64) Scalar depths[kLanes];
      const real own = rootDepths(body);
      store(own, depths);
      work(body, anyTrue(wayOutOf(own) > firstEdge()) ? depths : nullptr);
    }
  }

  SubstepBody place(size_t i, const StepInput& input, double time) const {
    const Parameters& p = *input.parameters;
    const uint32_t* words = input.shapes != nullptr ? input.shapes->words.data() : nullptr;
    return bodyAt(body(i), words, time, 1.0 / p.substeps, static_cast<double>(p.time_step) / p.substeps, p.hair_radius);
  }

  // kNearest: the least limit; kLookedFrom: where it looked last. Of a plane its normal, what that makes of its points,
  // Touch::carried and friction.
  enum ContactRow : int {
    kGone, kNearest, kLookedFrom, kPlanes = kLookedFrom + 3,
    kNormal = kPlanes, kOffset = kNormal + 3, kCarried, kFriction = kCarried + 3, kPlanesEnd
  };
  static constexpr int kPlaneRows = kPlanesEnd - kPlanes, kMostPlanes = 2;
  static_assert(kPlanes + kMostPlanes * kPlaneRows == kContactPlanes);
  Scalar* row(int plane, int i) const { return rows_ + (static_cast<size_t>(i) * kContactPlanes + plane) * kLanes; }
  real get(int plane, int i) const { return load(row(plane, i)); }
  real3 get3(int plane, int i) const { return {get(plane, i), get(plane + 1, i), get(plane + 2, i)}; }
  static constexpr int offsetOf(int n) { return kOffset + n * kPlaneRows; }  // of plane number n
  static constexpr double kNoPlane = -1e9;                                   // m, the offset of a plane that is none
  // Of body k at the start of the step, the least of all lanes.
  Scalar& limit(int i, size_t k) const { return limits_[static_cast<size_t>(i) * kPlacedBodies + k]; }
  // Of `those`, who is far from where it has looked from, and `others` of them.
  mask lookAgain(int i, const real3& x, const real3& x_start, const mask& those, const mask& others) {
    const real3 off = x - get3(kLookedFrom, i);
    const mask lanes = those && (dot(off, off) > lookReach() * lookReach() || others);
    if (anyTrue(lanes)) {
      for (int n = 0; n < planes_[i]; ++n) store(select(lanes, lit(kNoPlane), get(offsetOf(n), i)), row(offsetOf(n), i));
      want(i, x, x_start, lanes);
      lookAround();
    }
    return lanes;
  }
  // Vertex i, of `lanes`, is to look from x. Those wait that may see something.
  void want(int i, const real3& x, const real3& x_start, const mask& lanes) {
    const real way = wayAlong(x, x_start), gone = get(kGone, i), nearest = get(kNearest, i);
    const real3 from = select(lanes, x, get3(kLookedFrom, i));
    store(from.x, row(kLookedFrom, i));
    store(from.y, row(kLookedFrom + 1, i));
    store(from.z, row(kLookedFrom + 2, i));
    const real ahead = gone + way + reachAlong(way);
    const mask may_see = lanes && ahead >= nearest;
    if (!anyTrue(may_see)) return;
    const Scalar farthest = -leastOf(select(may_see, lit(0) - ahead, lit(0)));
    real others = lit(1e9);  // the limits of bodies that nobody in the row need look at
    uint32_t near = 0;
    for (int k = 0; k < kPlacedBodies; k += kLanes) {
      const real limits = load(&limit(i, k));
      const mask may_be_seen = limits <= lit(farthest);
      near |= laneBits(may_be_seen) << k;
      others = min(others, select(may_be_seen, others, limits));
    }
    wanted_ |= near;
    waiting_.add(i, {x, x_start, way, gone, max(nearest, lit(leastOf(others))), clearance(i)}, may_see);
  }
  static real reachAlong(const real& way) { return madd(way, lit(0.5), lookReach()); }

  // A vector of those that wait looks. By itself, so that sweeps of hair that is near no body stay small.
  [[gnu::noinline]] void look() {
    WaitingLooks::Look at;
    alignas(64) uint32_t numbers[kLanes];
    const int count = waiting_.take(at, numbers);
    const mask lanes = firstLanes(count);
    const real reach = reachAlong(at.way);
    Touch first = untouched(at.x, reach), second = first;
    real nearest = at.others;
    auto lookAt = [&](const SubstepBody& body, const Scalar* root_depths) {
      Touch own = untouched(at.x, reach);
      real clear = at.clear;
      if (root_depths != nullptr) clear = clearInReach(clear, root_depths, numbers, lanes);
      real gap = meet(body, at.x, at.x_start, clear, reach, lanes, own);
      if (root_depths != nullptr) gap = gap - (at.clear - clear);  // the root may come out of it
      if (anyTrue(own.gap < second.gap)) {
        const mask nearer = own.gap < first.gap;
        second = chosen(nearer, first, chosen(own.gap < second.gap, own, second));
        first = chosen(nearer, own, first);
      }
      nearest = min(nearest, gap + at.gone - at.way);  // the gap is at x, which it has not gone to yet
    };
    forBodies(wanted_, lookAt);
    if (waiting_.count() == 0) wanted_ = 0;
    const real rows[1] = {size() > kPlacedBodies ? lit(-1e9) : nearest};  // of bodies that are not placed nothing is known
    scatter(rows, kNearest, numbers, lanes);
    const mask sees_one = lanes && first.gap < reach, sees_two = lanes && second.gap < reach;
    const real room = pinch(first.gap, first.normal, second.gap, second.normal);
    first.gap = first.gap + room;
    second.gap = second.gap + room;
    keepPlane(0, first, at.x, numbers, sees_one);
    keepPlane(1, second, at.x, numbers, sees_two);
  }
  // Plane number n of these vertices, of `lanes`.
  void keepPlane(int n, const Touch& touch, const real3& x, const uint32_t* numbers, const mask& lanes) {
    if (!anyTrue(lanes)) return;
    forLanes(lanes, [&](int lane) {
      const uint32_t i = numbers[lane] / kLanes;
      if (planes_[i] > n) return;
      planes_[i] = static_cast<uint8_t>(n + 1);
      // In the other lanes there is none: whatever the rows hold would be taken for its normal.
      for (int c = 0; c < 3; ++c) store(lit(0), row(kNormal + n * kPlaneRows + c, static_cast<int>(i)));
      store(lit(kNoPlane), row(offsetOf(n), static_cast<int>(i)));
    });
    const real rows[kPlaneRows] = {touch.normal.x,  touch.normal.y,  touch.normal.z,  dot(touch.normal, x) - touch.gap,
                                   touch.carried.x, touch.carried.y, touch.carried.z, touch.friction};
    scatter(rows, kPlanes + n * kPlaneRows, numbers, lanes);
  }
  // To rows of these vertices from `plane` on, of `lanes`.
  template <size_t kRows>
  void scatter(const real (&values)[kRows], int plane, const uint32_t* numbers, const mask& lanes) {
    alignas(64) Scalar columns[kRows][kLanes];
    for (size_t c = 0; c < kRows; ++c) store(values[c], columns[c]);
    forLanes(lanes, [&](int lane) {
      Scalar* to = row(plane, static_cast<int>(numbers[lane] / kLanes)) + numbers[lane] % kLanes;
      for (size_t c = 0; c < kRows; ++c) to[c * kLanes] = columns[c][lane];
    });
  }

  // How the points of a body move in a substep: by turn x point + shift, to `slack` where the strands are.
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
    // Of the third order: what carriedBy() leaves out, and that interpolateRotation() is not even.
    const Scalar turn = std::sqrt(w2) * substeps;
    out.slack = turn * turn * turn / 60 * (std::sqrt(off2) + static_cast<Scalar>(radius_));
    if (isBent(body)) out.slack += movingBendOf(body).shift * body.part;
    return out;
  }
  // How much farther one moves points than the other, at most.
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
  // Of the placed bodies, one for those that move alike.
  void noteMotions() {
    constexpr Scalar kAlike = static_cast<Scalar>(1e-4);  // m
    motions_ = 0;
    for (size_t k = 0; k < kept(); ++k) {
      const Motion own = motionOf(placed_[k], static_cast<Scalar>(input_->parameters->substeps));
      Motion* known = nullptr;
      for (size_t m = 0; m < motions_ && known == nullptr; ++m)
        if (difference(motion_[m], own) < kAlike) known = &motion_[m];
      if (known != nullptr) known->slack = std::max(known->slack, own.slack + difference(*known, own));
      else motion_[motions_++] = own;
    }
  }

  // Whether the strands only move as their velocities say: no edge is stretched or stands across its frame, as after an
  // upload of some other state. Only the rod keeps its lengths.
  static bool calm(const Block& b, const StepInput& input) {
    if (input.parameters->solver != SolverKind::kRod) return false;
    for (int e = 0; e + 1 < b.vertices; ++e) {
      const real3 edge = load3(b.position, e + 1) - load3(b.position, e);
      const real length = load(b.rest_length + at(0, e));
      const quat frame = {load(b.frame + at(0, e)), load(b.frame + at(1, e)), load(b.frame + at(2, e)),
                          load(b.frame + at(3, e))};
      const real along = dot(edge, frameTangent(frame));
      const mask off = along < length * lit(0.9) || dot(edge, edge) > length * length * lit(1.02);
      if (anyTrue(off)) return false;
    }
    return true;
  }

  // Where vertices may come in the step: twice as far from where they are as their speed and their root's motion say.
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
    const double blown = b.grooming != nullptr ? parameters.wind.norm() * dt : 0;  // m, with any drag
    // Part of the way to their goals, which are no farther than twice their length and where the root goes.
    const double drawn = std::min(1.0, 0.5 * std::pow(parameters.goal_rate * dt, 2));
    // 4 sqrt(1 - cosine) is more than the angle.
    const real swung = sqrt(lit(1) - cosine) * lit(4) * length;
    real far = lit(2) * (sqrt(speed2) * lit(dt) + sqrt(dot(moved, moved)) + swung + length * lit(2 * drawn) +
                          lit(0.5 * dt * dt * pulled + blown));
    if (b.acceleration != nullptr) far = madd(sqrt(pushed2), lit(dt * dt), far);
    low = {low.x - far, low.y - far, low.z - far};
    high = {high.x + far, high.y + far, high.z + far};

    alignas(64) Scalar lanes[6][kMostLanes];
    const real bounds[6] = {low.x, low.y, low.z, high.x, high.y, high.z};
    for (int k = 0; k < 6; ++k) store(bounds[k], lanes[k]);
    Box box;
    for (int lane = 0; lane < kLanes; ++lane)
      for (int corner = 0; corner < 6; corner += 3)
        box.extend(Vec3(static_cast<float>(lanes[corner][lane]), static_cast<float>(lanes[corner + 1][lane]),
                        static_cast<float>(lanes[corner + 2][lane])));
    const float radius = parameters.hair_radius + kLookReach;
    box.min().array() -= radius;
    box.max().array() += radius;
    return box;
  }

  static bool meets(const MovingPrimitive& body, const Box& box) {
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
  uint32_t near_[kMost];
  size_t count_ = 0;
  bool all_ = false;
  SubstepBody placed_[kPlacedBodies];
  Motion motion_[kPlacedBodies];
  size_t motions_ = 0;
  Vec3 middle_ = Vec3::Zero();  // m, of a box that holds the strands throughout the step
  float radius_ = 0;            // m, of a ball about it
  real3 roots_ = makeReal3(lit(0), lit(0), lit(0));
  uint32_t covered_ = 0;  // the placed bodies that cover some root, as bits; then root_depths_ has how deeply
  alignas(64) Scalar root_depths_[kPlacedBodies][kLanes];
  Scalar root_rooms_[kPlacedBodies];  // m, how far a body has to go at the least to do so
  bool known_roots_ = false;
  Scalar *rows_ = nullptr, *limits_ = nullptr;
  WaitingLooks waiting_;
  uint32_t wanted_ = 0;  // the placed bodies that some of them have to look at, as bits
  uint8_t planes_[kMaxVerticesPerStrand];  // that any lane of the vertex has in this substep
  const StepInput* input_ = nullptr;
  double time_ = 0;
};
