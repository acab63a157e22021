// What the sweeps over blocks of strands share, over any lane type: included inside a namespace that has the lane vocabulary
// and the kernel text, before them. A lane is a strand and the loops run along it.

using Block = BlockView<Scalar>;

// Where row i of a quantity's plane starts: BlockView::at with the number of lanes known to the compiler.
constexpr size_t at(int plane, int i) { return (static_cast<size_t>(i) * kBlockPlanes + plane) * kLanes; }

inline real3 load3(const Scalar* planes, int i) {
  return {load(planes + at(0, i)), load(planes + at(1, i)), load(planes + at(2, i))};
}
inline void store3(const real3& value, Scalar* planes, int i) {
  store(value.x, planes + at(0, i));
  store(value.y, planes + at(1, i));
  store(value.z, planes + at(2, i));
}
inline real3 fill3(const float* v) { return {lit(v[0]), lit(v[1]), lit(v[2])}; }
inline real3 fill3(const Vec3& v) { return fill3(v.data()); }

struct RootFrame {
  real3 position;
  quat rotation;
};
inline RootFrame loadRoot(const Block& b, int first_plane) {
  const Scalar* p = b.root + static_cast<size_t>(first_plane) * kLanes;
  constexpr size_t next = kLanes;
  return {{load(p), load(p + next), load(p + 2 * next)},
          {load(p + 3 * next), load(p + 4 * next), load(p + 5 * next), load(p + 6 * next)}};
}


// A body at the end of a substep; `time` is the part of the step that has passed then, 0 to 1.
struct SubstepBody {
  uint32_t kind;
  real3 a, b;                // m
  real3 a_motion, b_motion;  // m, over the substep
  real3 spin;                // rad/s
  real radius, friction, substep, hair_radius;
  real3 middle;              // of a ball around it, with the hair's radius; not of planes
  real ball2;                // m^2, that ball's radius squared
};
inline SubstepBody bodyAt(const MovingPrimitive& p, const StepInput& input, double time) {
  const real part = lit(1.0 / input.parameters->substeps);
  const real3 a_step = fill3(p.a_end) - fill3(p.a_begin), b_step = fill3(p.b_end) - fill3(p.b_begin);
  const real3 a = madd(a_step, lit(time), fill3(p.a_begin)), b = madd(b_step, lit(time), fill3(p.b_begin));
  const bool capsule = p.kind == static_cast<uint32_t>(PrimitiveKind::kCapsule);
  const real3 half = capsule ? (b - a) * lit(0.5) : makeReal3(lit(0), lit(0), lit(0));
  const real ball = length(half) + lit(p.radius + input.parameters->hair_radius);
  return {p.kind,
          a,
          b,
          a_step * part,
          b_step * part,
          fill3(p.angular_velocity),
          lit(p.radius),
          lit(p.friction),
          lit(static_cast<double>(input.parameters->time_step) / input.parameters->substeps),
          lit(input.parameters->hair_radius),
          a + half,
          ball * ball};
}

// Pushes x out of the body where `free` holds and takes back slip; then `normal` is the body's there. Vectors of lanes
// that the body does not touch are left as they are. x_start: position at the start of the substep.
inline real3 pushOut(const SubstepBody& body, const real3& x, const real3& x_start, const mask& free, real3& normal) {
  real3 out, axis_point = body.a, axis_motion = body.a_motion;
  real distance;
  if (body.kind != static_cast<uint32_t>(PrimitiveKind::kPlane)) {
    const real3 off = x - body.middle;
    if (!anyTrue(dot(off, off) < body.ball2)) return x;
  }
  if (body.kind == static_cast<uint32_t>(PrimitiveKind::kSphere)) {
    distance = sphereDistance(x, body.a, body.radius, out);
  } else if (body.kind == static_cast<uint32_t>(PrimitiveKind::kCapsule)) {
    real along;
    distance = capsuleDistance(x, body.a, body.b, body.radius, out, along);
    axis_point = madd(body.b - body.a, along, body.a);
    axis_motion = madd(body.b_motion - body.a_motion, along, body.a_motion);
  } else {
    distance = planeDistance(x, body.a, body.b, out);
  }
  const mask touches = (distance - body.hair_radius < lit(0)) && free;
  if (!anyTrue(touches)) return x;
  const real3 motion = surfaceMotion(x, axis_point, axis_motion, body.spin, body.substep);
  const real3 outside = resolveContact(x, x_start, motion, out, distance - body.hair_radius, body.friction);
  normal = select(touches, out, normal);
  return select(touches, outside, x);
}

// The bodies that the strands of a block may touch in a step: those whose swept boxes meet the block's.
class NearBodies {
 public:
  NearBodies(const Block& b, const StepInput& input) : bodies_(input.primitives) {
    if (bodies_.empty()) return;
    all_ = !calm(b, input);
    if (all_) return;
    const Box box = reach(b, input);
    for (size_t i = 0; i < bodies_.size(); ++i) {
      if (!meets(bodies_[i], box)) continue;
      if (count_ == kMost) {  // then all are taken
        all_ = true;
        break;
      }
      near_[count_++] = static_cast<uint32_t>(i);
    }
  }
  size_t size() const { return all_ ? bodies_.size() : count_; }
  const MovingPrimitive& operator[](size_t i) const { return bodies_[all_ ? i : near_[i]]; }

  /// To be called at the start of a substep, for pushAllOut(). `time` as of bodyAt().
  void place(const StepInput& input, double time) {
    for (size_t i = 0; i < size() && i < kPlaced; ++i) placed_[i] = bodyAt((*this)[i], input, time);
    input_ = &input;
    time_ = time;
  }
  /// pushOut() of every body.
  real3 pushAllOut(real3 x, const real3& x_start, const mask& free, real3& normal) const {
    for (size_t i = 0; i < size(); ++i)
      x = pushOut(i < kPlaced ? placed_[i] : bodyAt((*this)[i], *input_, time_), x, x_start, free, normal);
    return x;
  }

 private:
  static constexpr size_t kMost = 64, kPlaced = 16, kMostLanes = 64;

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
    real speed2 = lit(0), length = lit(0);
    for (int i = 0; i < b.vertices; ++i) {
      const real3 x = load3(b.position, i), v = load3(b.velocity, i);
      low = {min(low.x, x.x), min(low.y, x.y), min(low.z, x.z)};
      high = {max(high.x, x.x), max(high.y, x.y), max(high.z, x.z)};
      speed2 = max(speed2, dot(v, v));
      length = length + load(b.rest_length + at(0, i));
    }
    const RootFrame begin = loadRoot(b, 0), end = loadRoot(b, kRootPlanes / 2);
    const real3 moved = end.position - begin.position;
    const quat p = begin.rotation, q = end.rotation;
    const real cosine = min(abs(madd(p.x, q.x, madd(p.y, q.y, madd(p.z, q.z, p.w * q.w)))), lit(1));
    const Parameters& parameters = *input.parameters;
    const double dt = parameters.time_step;
    const real fall = lit(0.5 * dt * dt * parameters.gravity.norm() + dt * dt * parameters.air_drag * parameters.wind.norm());
    // 4 sqrt(1 - cosine) is more than the angle.
    const real far = lit(2) * (sqrt(speed2) * lit(dt) + sqrt(dot(moved, moved)) + fall + sqrt(lit(1) - cosine) * lit(4) * length);
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
    const float radius = parameters.hair_radius;
    box.min().array() -= radius;
    box.max().array() += radius;
    return box;
  }

  static bool meets(const MovingPrimitive& body, const Box& box) {
    const Vec3 a_begin(body.a_begin[0], body.a_begin[1], body.a_begin[2]), a_end(body.a_end[0], body.a_end[1], body.a_end[2]);
    const Vec3 b_begin(body.b_begin[0], body.b_begin[1], body.b_begin[2]), b_end(body.b_end[0], body.b_end[1], body.b_end[2]);
    if (body.kind == static_cast<uint32_t>(PrimitiveKind::kPlane)) {
      auto below = [&](const Vec3& point, const Vec3& normal) {
        return (box.center() - point).dot(normal) < 0.5f * box.sizes().dot(normal.cwiseAbs());
      };
      return below(a_begin, b_begin) || below(a_end, b_end);
    }
    Box swept(a_begin);
    swept.extend(a_end);
    if (body.kind == static_cast<uint32_t>(PrimitiveKind::kCapsule)) swept.extend(b_begin).extend(b_end);
    swept.min().array() -= body.radius;
    swept.max().array() += body.radius;
    return box.intersects(swept);
  }

  std::span<const MovingPrimitive> bodies_;
  uint32_t near_[kMost];
  size_t count_ = 0;
  bool all_ = false;
  SubstepBody placed_[kPlaced];
  const StepInput* input_ = nullptr;
  double time_ = 0;
};
