// The bodies that the strands of a block may touch in a step: of those that the broad phase has listed for its neighbourhood by
// how far strands reach, the ones near where its strands are now. Included after core/strand_sweep.inl.
class NearBodies {
 public:
  NearBodies(const Block& b, const StepInput& input) : block_(b), bodies_(input.primitives) {
    if (input.near != nullptr) listed_ = input.near->of(b.neighbourhood);
    is_listed_ = input.near != nullptr;
    if (candidates() == 0) return;
    friction_scale_ = groomingFactor(b, kFrictionScale, 0);
    all_ = !calm(b, input) || b.bone_pins != nullptr;  // a bone may pull strands anywhere
    if (all_) return;
    const Box box = reach(b, input);
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

  /// To be called at the start of a substep, for nearest(). `time` as of bodyAt().
  void place(const StepInput& input, double time) {
    for (size_t i = 0; i < size() && i < kPlaced; ++i) placed_[i] = place(i, input, time);
    input_ = &input;
    time_ = time;
  }
  /// Of all bodies, for vertex `v`; see meet().
  Touch nearest(int v, const real3& x, const real3& x_start) const {
    const real clear = clearance(v);
    Touch touch = untouched(x);
    const size_t placed = std::min(size(), kPlaced);
    for (size_t i = 0; i < placed; ++i) meet(placed_[i], x, x_start, clear, touch);
    for (size_t i = placed; i < size(); ++i) meet(place(i, *input_, time_), x, x_start, clear, touch);
    return touch;
  }
  /// Touch::way alone; more than any where it would have to be asked for too many bodies.
  real longestWay(const real3& x, const real3& x_start) const {
    if (size() > kPlaced) return lit(1e9);
    real most = lit(0);
    for (size_t i = 0; i < size(); ++i) {
      const SubstepBody& body = placed_[i];
      const real3 way = x - carriedBy(x_start, spread(body.a), spread(body.a_motion), spread(body.turn));
      most = max(most, dot(way, way));
    }
    return sqrt(most);
  }

 private:
  static constexpr size_t kMost = 64, kPlaced = 16, kMostLanes = 64;

  const MovingPrimitive& body(size_t i) const { return bodies_[all_ ? candidate(i) : near_[i]]; }
  size_t candidates() const { return is_listed_ ? listed_.size() : bodies_.size(); }
  uint32_t candidate(size_t i) const { return is_listed_ ? listed_[i] : static_cast<uint32_t>(i); }

  // How far from every body vertex v must be: what lies deeper at rest may stay as deep.
  real clearance(int v) const {
    const real radius = lit(input_->parameters->hair_radius);
    return block_.rest_distance == nullptr ? radius : min(radius, load(block_.rest_distance + size_t(v) * kLanes));
  }

  SubstepBody place(size_t i, const StepInput& input, double time) const {
    const Parameters& p = *input.parameters;
    const uint32_t* words = input.shapes != nullptr ? input.shapes->words.data() : nullptr;
    return bodyAt(body(i), words, time, 1.0 / p.substeps, static_cast<double>(p.time_step) / p.substeps, p.hair_radius,
                  friction_scale_);
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
    const float radius = parameters.hair_radius + kContactReach;
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
  real friction_scale_ = lit(1);
  SubstepBody placed_[kPlaced];
  const StepInput* input_ = nullptr;
  double time_ = 0;
};
