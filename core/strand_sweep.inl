// What the sweeps over blocks of strands share, over any lane type: included inside a namespace that has the lane vocabulary
// and the kernel text, before them. A lane is a strand and the loops run along it.

using Block = BlockView<Scalar>;

// Where row i of a quantity's plane starts, from that quantity's pointer in the block.
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
inline const Scalar* sizeOf(const Block& b, SizePlane plane, int i) {
  return b.sizes + (static_cast<size_t>(sizeRow(i, b.vertices, b.uniform)) * kSizePlanes + plane) * kLanes;
}
inline real3 fill3(const Vec3& v) { return fill3(v.data()); }

// Of BlockView::grooming, where there is none a factor of 1.
inline real groomingFactor(const Block& b, GroomingPlane plane, int i) {
  if (b.grooming == nullptr) return lit(1);
  return load(b.grooming + (static_cast<size_t>(i) * kGroomingPlanes + plane) * kLanes);
}

// Of BlockView::acceleration, which there must be.
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

// Vertex i of the rest shape as the root carries it.
inline real3 restPoint(const Block& b, const RootFrame& root, int i) {
  return rotate(root.rotation, load3(b.rest_local, i)) + root.position;
}
// Where vertex i is to be if it is pinned; `time`: the part of the step that has passed then.
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

// What a body is to a vertex in a substep: a plane along its surface.
struct Touch {
  real gap;        // m, to its surface, or to the plane through where the way met it
  real3 normal;    // of the same
  real3 carried;   // m, where the surface has taken the point at which the vertex was
  real friction;   // of its body
};
// Of a vertex at x with no body nearer than `reach`.
inline Touch untouched(const real3& x, const real& reach) { return {reach, makeReal3(lit(0), lit(0), lit(0)), x, lit(0)}; }
inline Touch chosen(const mask& first, const Touch& a, const Touch& b) {
  return {select(first, a.gap, b.gap), select(first, a.normal, b.normal), select(first, a.carried, b.carried),
          select(first, a.friction, b.friction)};
}

// Where a body takes a point of it in a substep.
inline real3 carriedOf(const SubstepBody& body, const real3& point) {
  const real3 rigidly = carriedBy(point, spread(body.a), spread(body.a_motion), spread(body.turn));
  if (!isBent(body)) return rigidly;
  const MovingBend moving = movingBendOf(body);
  const quat rotation = spread(body.rotation);
  const real3 local = rotateBack(rotation, rigidly - spread(body.a));
  const real3 bent = carriedByBend(bendAt(moving, body.time - body.part), bendAt(moving, body.time), local);
  return rigidly + rotate(rotation, bent - local);
}

// What this body is to a vertex that goes from x_start to x in the substep, in `touch`, which is left alone where the body is
// farther than `reach` (m, plus the way). Seen from the body the vertex comes from where the surface has taken x_start. If the
// normal there and at x are alike, the nearest point of the surface is the way out; if not, the way may lead through the body,
// and distances tell how far it is free (conservative advancement, Mirtich 1996): where that ends, the plane along the surface
// bounds the vertex. It has all of a convex body behind it; in a crease the way may only graze that side, and x is deeper in the
// other.
// `clear`: how far from the surface x must be, m, at most the hair's radius. Only of `lanes`. Gives at most the gap, m.
inline real meet(const SubstepBody& body, const real3& x, const real3& x_start, const real& clear, const real& reach,
                 const mask& lanes, Touch& touch) {
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
    const mask from_outside = at.distance - clear > lit(0) - contactReach();
    const mask across = within && from_outside && dot(at.normal, normal) < lit(0.5);
    if (anyTrue(across)) {
      const real per_way = inverseSqrt(max(way2, lit(1e-30)));
      real part = lit(0);
      for (int i = 0; i < kAdvances; ++i) {
        const real before = part;
        part = min(madd(max(at.distance - clear, lit(0)), per_way, part), lit(1));
        if (i > 0 && !anyTrue(across && part > before)) break;  // nobody sees anything new
        at = surfaceAt(body, madd(way, part, carried), clear, across);
      }
      const real free = at.distance - clear, beyond = free + dot(at.normal, way) * (lit(1) - part);
      const mask met = across && free * per_way < lit(0.1) && beyond < gap;
      gap = select(met, beyond, gap);
      normal = select(met, at.normal, normal);
    }
  }
  touch = chosen(near, {gap, normal, carried, lit(body.friction)}, touch);
  return room;
}
