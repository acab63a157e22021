// How far points are from the surface of a body in a substep, over any lane type: included inside a namespace that has the
// lane vocabulary and the kernel text.

inline real3 fill3(const float* v) { return {lit(v[0]), lit(v[1]), lit(v[2])}; }
inline quat fill4(const float* v) { return {lit(v[0]), lit(v[1]), lit(v[2]), lit(v[3])}; }

// A body at the end of a substep; `time` is the part of the step that has passed then, 0 to 1.
struct SubstepBody {
  PrimitiveKind kind;
  real3 a, b;             // m
  real3 a_motion;         // m, over the substep
  real3 turn;             // radians, over the substep, about a
  real radius, friction;
  real3 middle;           // of a ball around it and what it presses; not of planes
  real ball2;             // m^2, that ball's radius squared
  real radius_b;
  real3 extent;
  quat rotation;          // of kinds that have one
  const uint32_t* words;  // of all shapes
  uint32_t data, planes;  // its own in them
};
// `part`: of the step that a substep is; `substep`: s.
inline SubstepBody bodyAt(const MovingPrimitive& p, const uint32_t* words, double time, double part, double substep,
                          double hair_radius) {
  const auto kind = static_cast<PrimitiveKind>(p.kind);
  const real3 a_step = fill3(p.a_end) - fill3(p.a_begin), b_step = fill3(p.b_end) - fill3(p.b_begin);
  const real3 a = madd(a_step, lit(time), fill3(p.a_begin)), b = madd(b_step, lit(time), fill3(p.b_begin));
  const bool capsule = kind == PrimitiveKind::kCapsule || kind == PrimitiveKind::kTaperedCapsule;
  const real3 half = capsule ? (b - a) * lit(0.5) : makeReal3(lit(0), lit(0), lit(0));
  const float thickest = kind == PrimitiveKind::kTaperedCapsule ? std::max(p.radius, p.radius_b) : p.radius;
  const real ball = length(half) + lit(thickest + hair_radius) + contactReach();
  const quat rotation = kind < PrimitiveKind::kEllipsoid
                            ? quat{lit(0), lit(0), lit(0), lit(1)}
                            : interpolateRotation(fill4(p.rotation_begin), fill4(p.rotation_end), lit(time));
  return {kind,
          a,
          b,
          a_step * lit(part),
          fill3(p.angular_velocity) * lit(substep),
          lit(p.radius),
          lit(p.friction),
          a + half,
          ball * ball,
          lit(p.radius_b),
          fill3(p.extent),
          rotation,
          words,
          p.data,
          p.planes};
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
  bool near = false;
  for (int lane = 0; lane < kLanes; ++lane) {
    const uint32_t entry = body.words[grid.index + static_cast<uint32_t>(bricks[lane])];
    const bool stored = entry < kInsideBrick;
    near = near || entry != kOutsideBrick;
    side[lane] = static_cast<Scalar>(stored ? 0 : entry == kOutsideBrick ? 1 : -1);
    const uint32_t first = static_cast<uint32_t>(stored ? cells[lane] : corners[lane]);
    const uint32_t row = stored ? kBrickSide : grid.bricks[0] + 1;
    const uint32_t slice = stored ? kBrickSide * kBrickSide : row * (grid.bricks[1] + 1);
    for (uint32_t c = 0; c < 8; ++c) {
      const uint32_t n = first + (c & 1) + (c >> 1 & 1) * row + (c >> 2) * slice;
      values[c][lane] =
          stored ? static_cast<Scalar>(fieldSample(body.words + grid.samples + size_t{entry} * kBrickWords, n))
                 : static_cast<Scalar>(std::bit_cast<float>(body.words[grid.corners + n]));
    }
  }
  const real3 none = makeReal3(lit(0), lit(0), lit(0));
  const real beyond = max(clear, lit(grid.band));
  if (!near) {  // nothing is pushed from here
    normal = none;
    return beyond;
  }
  const FieldCorners at{load(values[0]), load(values[1]), load(values[2]), load(values[3]), load(values[4]),
                        load(values[5]), load(values[6]), load(values[7]), load(side)};
  const real distance = fieldDistance(place, at, lit(grid.cell), lit(grid.band), lit(grid.quantum), clear, normal);
  const mask outside = load(side) > lit(0.5);
  normal = select(outside, none, normal);
  return select(outside, beyond, distance);
}

// `clear`: m, as far as the point is to be kept from the surface.
inline SurfacePoint surfaceAt(const SubstepBody& body, const real3& x, const real& clear) {
  SurfacePoint out;
  if (body.kind >= PrimitiveKind::kEllipsoid) {
    const quat back = {lit(0) - body.rotation.x, lit(0) - body.rotation.y, lit(0) - body.rotation.z, body.rotation.w};
    const real3 local = rotate(back, x - body.a);
    real3 normal;
    if (body.kind == PrimitiveKind::kEllipsoid) out.distance = ellipsoidDistance(local, body.extent, normal);
    else if (body.kind == PrimitiveKind::kBox) out.distance = boxDistance(local, body.extent, normal);
    else if (body.kind == PrimitiveKind::kConvex) out.distance = convexDistance(body, local, normal);
    else out.distance = fieldDistanceAt(body, local, clear, normal);
    out.normal = rotate(body.rotation, normal);
    return out;
  }
  if (body.kind == PrimitiveKind::kSphere) {
    out.distance = sphereDistance(x, body.a, body.radius, out.normal);
  } else if (body.kind == PrimitiveKind::kPlane) {
    out.distance = planeDistance(x, body.a, body.b, out.normal);
  } else {
    real along;
    out.distance = body.kind == PrimitiveKind::kCapsule
                       ? capsuleDistance(x, body.a, body.b, body.radius, out.normal, along)
                       : taperedCapsuleDistance(x, body.a, body.b, body.radius, body.radius_b, out.normal, along);
  }
  return out;
}
