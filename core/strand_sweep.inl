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
inline real3 fill3(const Vec3& v) { return fill3(v.data()); }

// Of BlockView::grooming, where there is none a factor of 1.
inline real groomingFactor(const Block& b, GroomingPlane plane, int i) {
  if (b.grooming == nullptr) return lit(1);
  return load(b.grooming + (static_cast<size_t>(i) * kGroomingPlanes + plane) * kLanes);
}

// Of BlockView::acceleration, which there must be.
inline real3 accelerationOf(const Block& b, int i) {
  const Scalar* row = b.acceleration + static_cast<size_t>(3 * i) * kLanes;
  return {load(row), load(row + kLanes), load(row + 2 * kLanes)};
}

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

// Pushes x out of the body where `free` holds and takes back slip; then `normal` is the body's there. Vectors of lanes
// that the body does not touch are left as they are. x_start: position at the start of the substep; clear: how far from
// the surface x must be, m, at most the hair's radius.
inline real3 pushOut(const SubstepBody& body, const real3& x, const real3& x_start, const real& clear, const mask& free,
                     real3& normal) {
  if (body.kind != PrimitiveKind::kPlane) {
    const real3 off = x - spread(body.middle);
    if (!anyTrue(dot(off, off) < lit(body.ball2))) return x;
  }
  const SurfacePoint at = surfaceAt(body, x, clear);
  const real distance = at.distance - clear;
  const mask touches = (distance < lit(0)) && free;
  if (!anyTrue(touches)) return x;
  const real3 motion = surfaceMotion(x, at.axis_point, at.axis_motion, spread(body.spin), lit(body.substep));
  const real3 outside = resolveContact(x, x_start, motion, at.normal, distance, body.friction);
  normal = select(touches, at.normal, normal);
  return select(touches, outside, x);
}
