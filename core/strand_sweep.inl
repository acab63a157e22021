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
inline real3 fill3(const float* v) { return {lit(v[0]), lit(v[1]), lit(v[2])}; }
inline real3 fill3(const Vec3& v) { return fill3(v.data()); }

// Of BlockView::grooming, where there is none a factor of 1.
inline real groomingFactor(const Block& b, GroomingPlane plane, int i) {
  if (b.grooming == nullptr) return lit(1);
  return load(b.grooming + (static_cast<size_t>(i) * kGroomingPlanes + plane) * kLanes);
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

// A body at the end of a substep; `time` is the part of the step that has passed then, 0 to 1.
struct SubstepBody {
  uint32_t kind;
  real3 a, b;      // m
  real3 a_motion;  // m, over the substep
  real3 turn;      // radians, over the substep, about a
  real radius, friction, hair_radius;
  real3 middle;    // of a ball around it, with the hair's radius; not of planes
  real ball2;      // m^2, that ball's radius squared
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
          fill3(p.angular_velocity) * lit(static_cast<double>(input.parameters->time_step) / input.parameters->substeps),
          lit(p.radius),
          lit(p.friction),
          lit(input.parameters->hair_radius),
          a + half,
          ball * ball};
}

// Distance of hair at x from the body, m.
inline real gapTo(const SubstepBody& body, const real3& x, real3& normal) {
  real distance;
  if (body.kind == static_cast<uint32_t>(PrimitiveKind::kSphere)) {
    distance = sphereDistance(x, body.a, body.radius, normal);
  } else if (body.kind == static_cast<uint32_t>(PrimitiveKind::kCapsule)) {
    real along;
    distance = capsuleDistance(x, body.a, body.b, body.radius, normal, along);
  } else {
    distance = planeDistance(x, body.a, body.b, normal);
  }
  return distance - body.hair_radius;
}

// The body that is nearest to a vertex, or that its way has met.
struct Touch {
  real gap;        // m, to its surface, or to the plane through where the way met it
  real3 normal;    // of the same
  real3 carried;   // m, where the surface has taken the point at which the vertex was
  real friction;
};
inline Touch untouched(const real3& x) {
  return {lit(1e9), makeReal3(lit(0), lit(0), lit(0)), x, lit(0)};
}

// Looks whether this body is nearer to a vertex that goes from x_start to x in the substep. Seen from the body the vertex
// comes from where the surface has taken x_start. If the normal there and at x are alike, the nearest point of the surface is
// the way out; if not, the way may lead through the body, and distances tell how far it is free (conservative advancement,
// Mirtich 1996): the plane across it there then bounds the vertex. That plane has a convex body wholly behind it.
inline void meet(const SubstepBody& body, const real3& x, const real3& x_start, Touch& nearest) {
  constexpr int kAdvances = 4;
  const real3 carried = carriedBy(x_start, body.a, body.a_motion, body.turn);
  const real3 way = x - carried;
  const real way2 = dot(way, way);
  if (body.kind != static_cast<uint32_t>(PrimitiveKind::kPlane)) {
    const real3 off = x - body.middle;
    if (!anyTrue(dot(off, off) < body.ball2 + way2)) return;
  }
  real3 normal;
  real gap = gapTo(body, x, normal);
  const mask within = gap < lit(0) || gap * gap < way2;
  if (anyTrue(within)) {
    real3 at_normal;
    real free = gapTo(body, carried, at_normal);
    const mask across = within && dot(at_normal, normal) < lit(0.5);
    if (anyTrue(across)) {
      const real per_way = inverseSqrt(max(way2, lit(1e-30)));
      real part = lit(0);
      real3 at = carried;
      for (int i = 0; i < kAdvances; ++i) {
        part = min(madd(max(free, lit(0)), per_way, part), lit(1));
        at = madd(way, part, carried);
        free = gapTo(body, at, at_normal);
      }
      gap = select(across, free + dot(at_normal, x - at), gap);
      normal = select(across, at_normal, normal);
    }
  }
  const mask nearer = gap < nearest.gap;
  nearest.gap = select(nearer, gap, nearest.gap);
  nearest.normal = select(nearer, normal, nearest.normal);
  nearest.carried = select(nearer, carried, nearest.carried);
  nearest.friction = select(nearer, body.friction, nearest.friction);
}
