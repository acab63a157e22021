// What the sweeps of both solvers share, over any lane type: rows of a block, contact planes, grooming. Included before
// them inside a namespace that has the lane vocabulary and the kernel text. A lane is a strand; loops run along it.

using Block = BlockView<Scalar>;

// Offset of row i of a plane from the pointer of its quantity in the block.
constexpr size_t at(int plane, int i) { return (static_cast<size_t>(i) * kBlockPlanes + plane) * kLanes; }

inline real3 load3(const Scalar* planes, int i) {
  return {load(planes + at(0, i)), load(planes + at(1, i)), load(planes + at(2, i))};
}
inline void store3(const real3& value, Scalar* planes, int i) {
  store(value.x, planes + at(0, i));
  store(value.y, planes + at(1, i));
  store(value.z, planes + at(2, i));
}
template <class Number>
inline real3 load3(const VectorRows<Number>& rows, int i) {
  const Scalar* row = rows.first + static_cast<size_t>(3 * i) * kLanes;
  return {load(row), load(row + kLanes), load(row + 2 * kLanes)};
}
inline void store3(const real3& value, const VectorRows<Scalar>& rows, int i) {
  Scalar* row = rows.first + static_cast<size_t>(3 * i) * kLanes;
  store(value.x, row);
  store(value.y, row + kLanes);
  store(value.z, row + 2 * kLanes);
}
inline const Scalar* massData(const Block& b, MassPlane plane, int i) {
  return b.mass_data + (static_cast<size_t>(massRow(i, b.vertices, b.uniform)) * kMassPlanes + plane) * kLanes;
}
inline real3 fill3(const Vec3& v) { return fill3(v.data()); }

// Factor from BlockView::grooming; 1 if the block has none.
inline real groomingFactor(const Block& b, GroomingPlane plane, int i) {
  if (b.grooming == nullptr) return lit(1);
  return load(b.grooming + (static_cast<size_t>(i) * kGroomingPlanes + plane) * kLanes);
}

// Precondition: BlockView::acceleration is not null.
inline real3 accelerationOf(const Block& b, int i) { return load3(b.acceleration, i); }

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

// Position of vertex i of the rest shape as the root carries it, m.
inline real3 restPoint(const Block& b, const RootFrame& root, int i) {
  return rotate(root.rotation, load3(b.rest_local, i)) + root.position;
}
// Position of vertex i if it is pinned, m. `time`: fraction of the step that has passed, 0 to 1.
inline real3 heldPoint(const Block& b, const RootFrame& root, int i, double time) {
  const real3 by_root = restPoint(b, root, i);
  if (b.bone_pins == nullptr) return by_root;
  const Scalar* row = b.bone_pins + static_cast<size_t>(i) * kBonePinPlanes * kLanes;
  auto place = [&](int plane) {
    const Scalar* p = row + static_cast<size_t>(plane) * kLanes;
    return makeReal3(load(p), load(p + kLanes), load(p + 2 * kLanes));
  };
  const real3 begin = place(kHeldBegin);
  return select(load(row) > lit(0.5), madd(place(kHeldEnd) - begin, lit(time), begin), by_root);
}

// Contact plane: a body's surface as a vertex sees it in a substep.
struct ContactPlane {
  real gap;       // m, of the vertex to the plane, less its clearance; negative inside
  real3 normal;   // unit, out of the body
  real3 carried;  // m, where the surface has carried the point at which the vertex was
  real friction;  // Coulomb coefficient of the body
};
// Contact plane of a vertex at x with no body nearer than `reach`.
inline ContactPlane noContact(const real3& x, const real& reach) { return {reach, zero3(), x, lit(0)}; }
inline ContactPlane chosen(const mask& first, const ContactPlane& a, const ContactPlane& b) {
  return {select(first, a.gap, b.gap), select(first, a.normal, b.normal), select(first, a.carried, b.carried),
          select(first, a.friction, b.friction)};
}

// Position to which a body carries one of its points in a substep, with the motion of a bent surface.
inline real3 carriedOf(const SubstepBody& body, const real3& point) {
  const real3 rigidly = carriedBy(point, spread(body.a), spread(body.a_motion), spread(body.turn));
  if (!isBent(body)) return rigidly;
  const MovingBend moving = movingBendOf(body);
  const quat rotation = spread(body.rotation);
  const real3 local = rotateBack(rotation, rigidly - spread(body.a));
  const real3 bent = carriedByBend(bendAt(moving, body.time - body.part), bendAt(moving, body.time), local);
  return rigidly + rotate(rotation, bent - local);
}

// Contact plane of a body for a vertex that moves from x_start to x in the substep. Writes `plane` if the body is
// nearer than `reach` (m) plus the vertex's relative displacement. Returns a lower bound of the gap, m. `clear`:
// distance that x must keep from the surface, m, at most the hair's radius. Only of `lanes`.
//
// Seen from the body, the vertex moves in a straight line from the carried point of x_start to x. If the normals at
// both ends are within 60 degrees, the nearest surface point of x gives the plane. Otherwise the segment may pass
// through the body: up to 8 steps of conservative advancement (Mirtich 1996) find where it meets the surface, and the
// plane there bounds the vertex. That plane has all of a convex body behind it. In a crease the segment may only graze
// that side; so it counts only if x is deeper behind it than in the body.
inline real closestContact(const SubstepBody& body, const real3& x, const real3& x_start, const real& clear, const real& reach,
                           const mask& lanes, ContactPlane& plane) {
  constexpr int kAdvances = 8;
  const real3 carried = carriedOf(body, x_start), way = x - carried;
  const real way2 = dot(way, way);
  mask near = lanes;
  real room = lit(0);
  if (body.kind != PrimitiveKind::kPlane) {
    const real3 off = x - spread(body.middle);
    const real ball = lit(body.ball) + reach;
    near = near && dot(off, off) < madd(ball, ball, way2);
    room = length(off) - lit(body.ball);
    if (!anyTrue(near)) return room;
  }
  SurfacePoint at = surfaceAt(body, x, clear, near);
  real gap = at.distance - clear;
  room = select(near, at.least - clear, room);
  real3 normal = at.normal;
  const mask within = near && (gap < lit(0) || gap * gap < way2) && at.even * at.even < way2;
  if (anyTrue(within)) {
    at = surfaceAt(body, carried, clear, within);
    const mask from_outside = at.distance - clear > -contactReach();
    const mask across = within && from_outside && dot(at.normal, normal) < lit(0.5);
    if (anyTrue(across)) {
      const real per_way = inverseSqrt(max(way2, lit(1e-30)));
      real part = lit(0);
      for (int i = 0; i < kAdvances; ++i) {
        const real before = part;
        part = min(madd(max(at.distance - clear, lit(0)), per_way, part), lit(1));
        if (i > 0 && !anyTrue(across && part > before)) break;  // no lane advances any more
        at = surfaceAt(body, madd(way, part, carried), clear, across);
      }
      const real free = at.distance - clear, beyond = free + dot(at.normal, way) * (lit(1) - part);
      const mask met = across && free * per_way < lit(0.1) && beyond < gap;
      gap = select(met, beyond, gap);
      normal = select(met, at.normal, normal);
    }
  }
  plane = chosen(near, {gap, normal, carried, lit(body.friction)}, plane);
  return room;
}

// Effect of grooming on the vertices of a block in a step: the share of velocity that air drag leaves, and the mass
// that the goal pull adds (kernels/strand.h).
class Grooming {
 public:
  // `scratch`: of the block.
  Grooming(const Block& b, const StepInput& input, Scalar* scratch)
      : block_(b), rows_(scratch + solverScratch(b.vertices, kLanes)), wind_(fill3(input.parameters->wind)) {
    const Parameters& p = *input.parameters;
    on_ = b.factors || p.goal_rate > 0;
    if (!on_) return;
    const double h = static_cast<double>(p.time_step) / p.substeps;
    const DragStep usual(p.air_drag, h);
    substep_ = lit(h);
    keep_ = lit(usual.keep);
    time2_ = lit(usual.time2);
    gravity_ = fill3(p.gravity);
    for (int i = 0; i < b.vertices; ++i) {
      Scalar *keep = row(kKeep, i), *time2 = row(kTime2, i);
      for (int lane = 0; lane < kLanes; ++lane) {
        const double scale = b.grooming != nullptr ? plane(kAirDragScale, i)[lane] : 1.0;
        const DragStep own(p.air_drag * scale, h);
        keep[lane] = static_cast<Scalar>(own.keep);
        time2[lane] = static_cast<Scalar>(own.time2);
      }
      const real free = select(load(massData(b, kWeight, i)) > lit(0), lit(1), lit(0));
      const real own_mass = load(massData(b, kMass, i));
      const real m = select(free > lit(0), own_mass * (time2_ * inverse(load(time2))), own_mass);
      const real rate = lit(p.goal_rate) * groomingFactor(b, kGoalScale, i) * free;
      const real stiffness = goalStiffness(own_mass, rate, time2_);
      store(rate, row(kRate, i));
      store(stiffness, row(kStiffnessAdded, i));
      store(m + stiffness, row(kMassWith, i));
      store(free * inverse(m + stiffness), row(kWeightWith, i));
    }
  }
  // Whether any grooming acts. If not, no other member may be called.
  bool on() const { return on_; }

  real keep(int i) const { return load(row(kKeep, i)); }
  real time2(int i) const { return load(row(kTime2, i)); }  // s^2, see DragStep
  real rate(int i) const { return load(row(kRate, i)); }    // 1/s, of the goal pull; 0 if pinned
  real mass(int i) const {
    return load(row(kMassWith, i));
  }  // effective: for forces times the usual time2, with the goal's stiffness
  real weight(int i) const { return load(row(kWeightWith, i)); }
  // Right-hand side of the rod's bending system for vertex i at `shift` in this substep, without internal forces.
  // `way`: displacement by gravity, wind and external forces with the usual air drag, less RodStep::jump_, without goal
  // pull.
  real3 loadTowardsGoal(int i, const real3& way, const RootFrame& root, const real3& shift) const {
    const real3 lack = (restPoint(block_, root, i) - load3(block_.position, i)) - shift;
    const real3 driven = block_.acceleration != nullptr ? gravity_ + accelerationOf(block_, i) : gravity_;
    const real3 own = madd(driven, time2(i) - time2_, madd(wind_, (keep_ - keep(i)) * substep_, way));
    const real3 pulled = goalPull(own, mass(i), load(row(kStiffnessAdded, i)), lack);
    return select(weight(i) > lit(0), pulled, zero3());
  }

 private:
  enum Row : int { kKeep, kTime2, kRate, kStiffnessAdded, kMassWith, kWeightWith };
  static_assert(kWeightWith + 1 == kGroomingRows);
  Scalar* row(Row which, int i) const { return rows_ + (static_cast<size_t>(i) * kGroomingRows + which) * kLanes; }
  const Scalar* plane(GroomingPlane which, int i) const {
    return block_.grooming + (static_cast<size_t>(i) * kGroomingPlanes + which) * kLanes;
  }

  const Block& block_;
  Scalar* rows_;
  real3 wind_, gravity_;
  real substep_ = lit(0), keep_ = lit(1), time2_ = lit(0);
  bool on_ = false;
};
