// How far points are from the surface of a body in a substep, over any lane type: included inside a namespace that has the
// lane vocabulary and the kernel text.

inline real3 fill3(const float* v) { return {lit(v[0]), lit(v[1]), lit(v[2])}; }
inline quat fill4(const float* v) { return {lit(v[0]), lit(v[1]), lit(v[2]), lit(v[3])}; }

inline real3 spread(const Scalar (&v)[3]) { return {lit(v[0]), lit(v[1]), lit(v[2])}; }
inline quat spread(const Scalar (&v)[4]) { return {lit(v[0]), lit(v[1]), lit(v[2]), lit(v[3])}; }
// Of lanes that are all the same.
inline Scalar one(const real& v) {
  alignas(64) Scalar lanes[kLanes];
  store(v, lanes);
  return lanes[0];
}
inline void keep(const real3& v, Scalar (&out)[3]) {
  out[0] = one(v.x);
  out[1] = one(v.y);
  out[2] = one(v.z);
}

// A body at the end of a substep, one for all lanes; `time` is the part of the step that has passed then, 0 to 1.
struct SubstepBody {
  PrimitiveKind kind;
  Scalar a[3], b[3];      // m
  Scalar a_motion[3];     // m, over the substep
  Scalar turn[3];         // radians, over the substep, about a
  Scalar radius, radius_b, extent[3];
  Scalar rotation[4];     // of kinds that have one
  Scalar middle[3];       // of a ball around it and what it presses; not of planes
  Scalar ball, ball2;     // m, m^2: that ball's radius and its square
  const uint32_t* words;  // of all shapes
  uint32_t data, planes;  // its own in them
  real friction;
};
// `part`: of the step that a substep is; `substep`: s.
inline SubstepBody bodyAt(const MovingPrimitive& p, const uint32_t* words, double time, double part, double substep,
                          double hair_radius, const real& friction_scale) {
  SubstepBody body;
  body.kind = static_cast<PrimitiveKind>(p.kind);
  const real3 a_step = fill3(p.a_end) - fill3(p.a_begin), b_step = fill3(p.b_end) - fill3(p.b_begin);
  const real3 a = madd(a_step, lit(time), fill3(p.a_begin)), b = madd(b_step, lit(time), fill3(p.b_begin));
  keep(a, body.a);
  keep(b, body.b);
  keep(a_step * lit(part), body.a_motion);
  const bool capsule = body.kind == PrimitiveKind::kCapsule || body.kind == PrimitiveKind::kTaperedCapsule;
  const real3 half = capsule ? (b - a) * lit(0.5) : makeReal3(lit(0), lit(0), lit(0));
  const float thickest = body.kind == PrimitiveKind::kTaperedCapsule ? std::max(p.radius, p.radius_b) : p.radius;
  const real ball = length(half) + lit(thickest + hair_radius) + contactReach();
  keep(a + half, body.middle);
  body.ball = one(ball);
  body.ball2 = one(ball * ball);
  if (body.kind >= PrimitiveKind::kEllipsoid) {
    const quat rotation = interpolateRotation(fill4(p.rotation_begin), fill4(p.rotation_end), lit(time));
    const real components[4] = {rotation.x, rotation.y, rotation.z, rotation.w};
    for (int c = 0; c < 4; ++c) body.rotation[c] = one(components[c]);
  }
  keep(fill3(p.angular_velocity) * lit(substep), body.turn);
  for (int c = 0; c < 3; ++c) body.extent[c] = p.extent[c];
  body.radius = p.radius;
  body.radius_b = p.radius_b;
  body.words = words;
  body.data = p.data;
  body.planes = p.planes;
  body.friction = lit(p.friction) * friction_scale;
  return body;
}

// Where a body's surface is nearest to a point.
struct SurfacePoint {
  real distance;  // m, negative inside
  real3 normal;   // unit, out of the body
};

inline real convexDistance(const SubstepBody& body, const real3& x, real3& normal) {
  real nearest = lit(-1e9);
  normal = makeReal3(lit(0), lit(1), lit(0));
  for (uint32_t i = 0; i < body.planes; ++i) {
    float plane[4];
    std::memcpy(plane, body.words + body.data + 4 * i, sizeof plane);
    convexPlane(x, fill3(plane), lit(plane[3]), nearest, normal);
  }
  return nearest;
}

// `clear`: see fieldDistance. In a brick beyond the band the normal is zero.
inline real fieldDistanceAt(const SubstepBody& body, const real3& x, const real& clear, real3& normal) {
  FieldGrid grid;
  std::memcpy(&grid, body.words + body.data, sizeof grid);
  const FieldPlace place = fieldPlace(x, fill3(grid.origin), lit(grid.cell),
                                      makeReal3(lit(grid.bricks[0]), lit(grid.bricks[1]), lit(grid.bricks[2])));
  alignas(64) Scalar bricks[kLanes], corners[kLanes], cells[kLanes], side[kLanes], values[8][kLanes];
  store(place.brick, bricks);
  store(place.corner, corners);
  store(place.first_sample, cells);
  uint32_t entries[kLanes];
  bool near = false;
  for (int lane = 0; lane < kLanes; ++lane) {
    entries[lane] = body.words[grid.index + static_cast<uint32_t>(bricks[lane])];
    near = near || entries[lane] != kOutsideBrick;
  }
  const real3 none = makeReal3(lit(0), lit(0), lit(0));
  const real beyond = max(clear, lit(grid.band));
  if (!near) {  // nothing is pushed from here
    normal = none;
    return beyond;
  }
  for (int lane = 0; lane < kLanes; ++lane) {
    const uint32_t entry = entries[lane];
    const bool stored = entry < kInsideBrick;
    side[lane] = static_cast<Scalar>(stored ? 0 : entry == kOutsideBrick ? 1 : -1);
    if (stored) {
      const uint32_t* brick = body.words + grid.samples + size_t{entry} * kBrickWords;
      for (uint32_t c = 0; c < 8; c += 2) {  // two neighbours along x at a time
        const uint32_t n =
            static_cast<uint32_t>(cells[lane]) + (c >> 1 & 1) * kBrickSide + (c >> 2) * kBrickSide * kBrickSide;
        uint64_t both;  // of two words; what follows a field's samples is its own too
        std::memcpy(&both, brick + n / 2, sizeof both);
        both >>= 16 * (n & 1);
        values[c][lane] = static_cast<Scalar>(static_cast<int16_t>(both));
        values[c + 1][lane] = static_cast<Scalar>(static_cast<int16_t>(both >> 16));
      }
      continue;
    }
    const uint32_t row = grid.bricks[0] + 1, slice = row * (grid.bricks[1] + 1);
    for (uint32_t c = 0; c < 8; ++c) {
      const uint32_t n = static_cast<uint32_t>(corners[lane]) + (c & 1) + (c >> 1 & 1) * row + (c >> 2) * slice;
      values[c][lane] = static_cast<Scalar>(std::bit_cast<float>(body.words[grid.corners + n]));
    }
  }
  const FieldCorners at{load(values[0]), load(values[1]), load(values[2]), load(values[3]), load(values[4]),
                        load(values[5]), load(values[6]), load(values[7]), load(side)};
  const real distance = fieldDistance(place, at, lit(grid.cell), lit(grid.band), lit(grid.quantum), clear, normal);
  const mask outside = load(side) > lit(0.5);
  normal = select(outside, none, normal);
  return select(outside, beyond, distance);
}

// Of kinds that turn. By itself, so that what sweeps over spheres and capsules stays small. `clear`: see surfaceAt.
[[gnu::noinline]] inline SurfacePoint turningSurfaceAt(const SubstepBody& body, const real3& x, const real& clear) {
  SurfacePoint out;
  const quat rotation = spread(body.rotation);
  const quat back = {lit(0) - rotation.x, lit(0) - rotation.y, lit(0) - rotation.z, rotation.w};
  const real3 local = rotate(back, x - spread(body.a));
  real3 normal;
  if (body.kind == PrimitiveKind::kEllipsoid) out.distance = ellipsoidDistance(local, spread(body.extent), normal);
  else if (body.kind == PrimitiveKind::kBox) out.distance = boxDistance(local, spread(body.extent), normal);
  else if (body.kind == PrimitiveKind::kConvex) out.distance = convexDistance(body, local, normal);
  else out.distance = fieldDistanceAt(body, local, clear, normal);
  out.normal = rotate(rotation, normal);
  return out;
}

// `clear`: m, as far as the point is to be kept from the surface.
inline SurfacePoint surfaceAt(const SubstepBody& body, const real3& x, const real& clear) {
  if (body.kind >= PrimitiveKind::kEllipsoid) return turningSurfaceAt(body, x, clear);
  SurfacePoint out;
  const real3 a = spread(body.a);
  const real radius = lit(body.radius);
  if (body.kind == PrimitiveKind::kSphere) {
    out.distance = sphereDistance(x, a, radius, out.normal);
    return out;
  }
  const real3 b = spread(body.b);
  if (body.kind == PrimitiveKind::kPlane) {
    out.distance = planeDistance(x, a, b, out.normal);
    return out;
  }
  real along;
  out.distance = body.kind == PrimitiveKind::kCapsule
                     ? capsuleDistance(x, a, b, radius, out.normal, along)
                     : taperedCapsuleDistance(x, a, b, radius, lit(body.radius_b), out.normal, along);
  return out;
}
