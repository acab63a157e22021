// Distances of points from the surface of a body in a substep, over any lane type. Included inside a namespace that has
// the lane vocabulary and the kernel text.

inline real3 fill3(const float* v) { return {lit(v[0]), lit(v[1]), lit(v[2])}; }
inline quat fill4(const float* v) { return {lit(v[0]), lit(v[1]), lit(v[2]), lit(v[3])}; }

inline real3 spread(const Scalar (&v)[3]) { return {lit(v[0]), lit(v[1]), lit(v[2])}; }
inline quat spread(const Scalar (&v)[4]) { return {lit(v[0]), lit(v[1]), lit(v[2]), lit(v[3])}; }
// Value of lanes that are all equal.
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

// A primitive at the end of a substep, the same for all lanes. `time`: fraction of the step that has passed, 0 to 1.
struct SubstepBody {
  PrimitiveKind kind;
  Scalar a[3], b[3];   // m
  Scalar a_motion[3];  // m, displacement of a over the substep
  Scalar turn[3];      // radians, rotation vector over the substep, about a
  Scalar radius, radius_b, extent[3];
  Scalar rotation[4];     // x y z w; only of kinds that rotate
  Scalar middle[3];       // m, centre of the bounding ball; not of planes
  Scalar ball;            // m, radius of the bounding ball, with the hair's radius
  const uint32_t* words;  // ShapeData::words of all shapes
  uint32_t data, extra;   // as in MovingPrimitive
  Scalar time, part;      // fractions of the step: elapsed time, and the substep
  Scalar friction;
};
// `time`, `part`: as in SubstepBody; `substep`: its duration, s.
inline SubstepBody bodyAt(const MovingPrimitive& p, const uint32_t* words, double time, double part, double substep,
                          double hair_radius) {
  SubstepBody body;
  body.kind = static_cast<PrimitiveKind>(p.kind);
  const real3 a_step = fill3(p.a_end) - fill3(p.a_begin), b_step = fill3(p.b_end) - fill3(p.b_begin);
  const real3 a = madd(a_step, lit(time), fill3(p.a_begin)), b = madd(b_step, lit(time), fill3(p.b_begin));
  keep(a, body.a);
  keep(b, body.b);
  keep(a_step * lit(part), body.a_motion);
  const bool capsule = body.kind == PrimitiveKind::kCapsule || body.kind == PrimitiveKind::kTaperedCapsule;
  const real3 half = capsule ? (b - a) * lit(0.5) : zero3();
  const float thickest = body.kind == PrimitiveKind::kTaperedCapsule ? std::max(p.radius, p.radius_b) : p.radius;
  const real ball = length(half) + lit(thickest + hair_radius);
  keep(a + half, body.middle);
  body.ball = one(ball);
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
  body.extra = p.extra;
  body.time = static_cast<Scalar>(time);
  body.part = static_cast<Scalar>(part);
  body.friction = p.friction;
  return body;
}

// Surface of a body as seen from a point.
struct SurfacePoint {
  real distance;  // m, signed, negative inside
  real least;     // m, lower bound of the true distance; beyond a field's band it may exceed `distance`, which is capped there
  real even;      // m: within this distance of the point, no normal differs by 60 degrees from its own; 0 = unknown
  real3 normal;   // unit, out of the body
};

inline real convexDistance(const SubstepBody& body, const real3& x, real3& normal) {
  real nearest = lit(-1e9);
  normal = makeReal3(lit(0), lit(1), lit(0));
  for (uint32_t i = 0; i < body.extra; ++i) {
    float plane[4];
    std::memcpy(plane, body.words + body.data + 4 * i, sizeof plane);
    convexPlane(x, fill3(plane), lit(plane[3]), nearest, normal);
  }
  return nearest;
}

// Calls work(lane) for each lane of the mask.
template <class Work>
inline void forLanes(const mask& lanes, const Work& work) {
  for (uint32_t left = laneBits(lanes); left != 0; left &= left - 1) work(std::countr_zero(left));
}

// Points in a distance field, and the bricks in which they lie.
struct FieldLookup {
  FieldGrid grid;
  FieldPlace place;
  word entries;  // entries of the brick index
  real side;     // as FieldCorners::side
};
// Only of `lanes`; the other lanes get an outside brick.
inline FieldLookup sampleField(const SubstepBody& body, const real3& x, const mask& lanes) {
  FieldLookup found;
  std::memcpy(&found.grid, body.words + body.data, sizeof found.grid);
  const FieldGrid& grid = found.grid;
  found.place =
      fieldPlace(x, fill3(grid.origin), lit(grid.cell), makeReal3(lit(grid.bricks[0]), lit(grid.bricks[1]), lit(grid.bricks[2])));
  const word bricks = select(lanes, toInt(found.place.brick), splat(0));
  found.entries = select(lanes, wordAt(body.words + grid.index, bricks), splat(static_cast<int32_t>(kOutsideBrick)));
  const real entry = realOf(found.entries);
  found.side = select(entry >= lit(0), lit(0), select(entry > lit(-1.5), lit(1), lit(-1)));
  return found;
}
// Offset of the samples of a stored brick in bytes, from the field's first sample.
inline word firstByte(const word& entries) { return entries * splat(kBrickWords * sizeof(uint32_t)); }

// Lower bound of the distance, from the stored value at the nearest corner of the cell or, beyond the band, of the
// brick.
inline real cornerLowerBound(const SubstepBody& body, const FieldLookup& found, const mask& lanes) {
  const FieldGrid& grid = found.grid;
  const FieldPlace& place = found.place;
  const auto nearest = [](const real3& t) {
    const real half = lit(0.5);
    return makeReal3(floor(t.x + half), floor(t.y + half), floor(t.z + half));
  };
  const real3 in_cell = nearest(place.in_cell), in_brick = nearest(place.in_brick);
  const real side = lit(kBrickSide), row = lit(grid.bricks[0] + 1), slice = row * lit(grid.bricks[1] + 1);
  const mask stored = abs(found.side) < lit(0.5);
  const real sample = madd(madd(in_cell.z, side, in_cell.y), side, place.first_sample + in_cell.x);
  const real corner = madd(in_brick.z, slice, madd(in_brick.y, row, place.corner + in_brick.x));
  const word samples = select(lanes && stored, firstByte(found.entries) + toInt(sample + sample), splat(0));
  const word corners = select(lanes && !stored, toInt(corner), splat(0));
  const real value = select(stored, lit(grid.quantum) * lowHalves(wordAtByte(body.words + grid.samples, samples)),
                            floatOf(wordAt(body.words + grid.corners, corners)));
  const real3 away = place.in_cell - in_cell, far = (place.in_brick - in_brick) * lit(grid.cell * kBrickCells);
  // The interpolant deviates by at most the mean distance to the corners, which is at most the root mean square.
  const real in_band = lit(grid.cell) * sqrt(abs(away.x) + abs(away.y) + abs(away.z));
  return value - select(stored, in_band, length(far + place.outside));
}

// Evenness of stored bricks, see firstEvenness().
inline real evennessOf(const SubstepBody& body, const FieldGrid& grid, const word& bricks) {
  static_assert(kEvennessesPerWord == 16);
  const word words = wordAt(body.words + firstEvenness(grid), shiftedDown(bricks, splat(4)));
  const word place = bricks & splat(kEvennessesPerWord - 1);
  return realOf(shiftedDown(words, place + place) & splat(3));
}

// `clear`: see fieldDistance(). In a brick beyond the band the normal is zero.
inline SurfacePoint fieldSurfaceAt(const SubstepBody& body, const real3& x, const real& clear, const mask& lanes) {
  SurfacePoint out;
  const FieldLookup found = sampleField(body, x, lanes);
  const FieldGrid& grid = found.grid;
  const real beyond = max(clear, lit(grid.band));
  const mask outside = found.side > lit(0.5), away = lanes && outside;
  out.even = lit(0);
  out.least = lit(grid.band);
  if (anyTrue(away)) out.least = max(out.least, cornerLowerBound(body, found, away));
  const mask near = lanes && !outside;
  if (!anyTrue(near)) {  // no lane is near enough for contact
    out.normal = zero3();
    out.distance = beyond;
    return out;
  }
  const mask stored = near && found.side > lit(-0.5), inside = near && found.side < lit(-0.5);
  const word brick = select(stored, found.entries, splat(0));
  const bool any_stored = anyTrue(stored);  // otherwise the field may have no brick to read for other lanes
  word pairs[4] = {splat(0), splat(0), splat(0), splat(0)};
  if (any_stored) {  // neighbouring samples along x are read as one unaligned word
    const word cell = select(stored, toInt(found.place.first_sample + found.place.first_sample), splat(0));
    for (uint32_t c = 0; c < 4; ++c) {
      const uint32_t n = (c & 1) * kBrickSide + (c >> 1) * kBrickSide * kBrickSide;
      pairs[c] = wordAtByte(body.words + grid.samples, firstByte(brick) + cell + splat(static_cast<int32_t>(2 * n)));
    }
  }
  FieldCorners at{lowHalves(pairs[0]),  highHalves(pairs[0]), lowHalves(pairs[1]),
                  highHalves(pairs[1]), lowHalves(pairs[2]),  highHalves(pairs[2]),
                  lowHalves(pairs[3]),  highHalves(pairs[3]), found.side};
  if (anyTrue(inside)) {
    const uint32_t row = grid.bricks[0] + 1, slice = row * (grid.bricks[1] + 1);
    const word corner = select(inside, toInt(found.place.corner), splat(0));
    real* const values[8] = {&at.v000, &at.v100, &at.v010, &at.v110, &at.v001, &at.v101, &at.v011, &at.v111};
    for (uint32_t c = 0; c < 8; ++c) {
      const uint32_t n = (c & 1) + (c >> 1 & 1) * row + (c >> 2) * slice;
      *values[c] = select(inside, floatOf(wordAt(body.words + grid.corners + n, corner)), *values[c]);
    }
  }
  const real distance = fieldDistance(found.place, at, lit(grid.cell), lit(grid.band), lit(grid.quantum), clear, out.normal);
  out.normal = select(outside, zero3(), out.normal);
  out.least = select(outside, out.least, distance);
  out.distance = select(outside, beyond, distance);
  const real3 t = found.place.in_brick;
  const real to_border = min(min(min(t.x, t.y), t.z), lit(1) - max(max(t.x, t.y), t.z));
  const real even = any_stored ? evennessOf(body, grid, brick) : lit(0);
  const real around = madd(to_border, lit(kBrickCells), even - lit(1));  // cells
  out.even = select(stored && even > lit(0.5), around * lit(grid.cell), lit(0));
  return out;
}

// Whether the body is a distance field with a bend in this step.
inline bool isBent(const SubstepBody& body) { return body.kind == PrimitiveKind::kField && body.extra != 0; }
inline MovingBend movingBendOf(const SubstepBody& body) {
  MovingBend moving;
  std::memcpy(&moving, body.words + body.extra, sizeof moving);
  return moving;
}
inline Bend bendAt(const MovingBend& moving, Scalar time) {
  auto term = [&](int i) {
    auto factor = [&](int c) {
      const Scalar begin = moving.begin[i][c], end = moving.end[i][c];
      return lit(begin + time * (end - begin));
    };
    return makeReal3(factor(0), factor(1), factor(2));
  };
  return {term(0), term(1), term(2), term(3), term(4), term(5), term(6), term(7), term(8), term(9), fill3(moving.reach)};
}

// surfaceAt() of a bent field, in the body's frame.
inline SurfacePoint bentSurfaceAt(const SubstepBody& body, const real3& x, const real& clear, const mask& lanes) {
  const MovingBend moving = movingBendOf(body);
  const Bend bend = bendAt(moving, body.time);
  SurfacePoint out = fieldSurfaceAt(body, x + bendShift(bend, x), clear, lanes);
  const real stretch = lit(moving.stretch);
  out.least = out.least / stretch;
  out.even = lit(0);
  out.normal = bentGradient(bend, x, out.normal);
  out.distance = bentDistance(out.distance, stretch, out.normal);
  return out;
}

// surfaceAt() of kinds that rotate. Not inlined, so that sweeps over spheres and capsules stay small.
[[gnu::noinline]] inline SurfacePoint turningSurfaceAt(const SubstepBody& body, const real3& x, const real& clear,
                                                       const mask& lanes) {
  SurfacePoint out;
  const quat rotation = spread(body.rotation);
  const real3 local = rotateBack(rotation, x - spread(body.a));
  if (body.kind == PrimitiveKind::kField) {
    out = isBent(body) ? bentSurfaceAt(body, local, clear, lanes) : fieldSurfaceAt(body, local, clear, lanes);
    out.normal = rotate(rotation, out.normal);
    return out;
  }
  real3 normal;
  if (body.kind == PrimitiveKind::kEllipsoid)
    out.distance = ellipsoidDistance(local, spread(body.extent), normal);
  else if (body.kind == PrimitiveKind::kBox)
    out.distance = boxDistance(local, spread(body.extent), normal);
  else
    out.distance = convexDistance(body, local, normal);
  out.least = out.distance;
  out.even = lit(0);
  out.normal = rotate(rotation, normal);
  return out;
}

// Surface of a body as seen from x. `clear`: m, distance that the point must keep from it, see fieldDistance(). Only of
// `lanes`; other lanes are undefined.
inline SurfacePoint surfaceAt(const SubstepBody& body, const real3& x, const real& clear, const mask& lanes) {
  if (body.kind >= PrimitiveKind::kEllipsoid) return turningSurfaceAt(body, x, clear, lanes);
  SurfacePoint out;
  out.even = lit(0);
  const real3 a = spread(body.a);
  const real radius = lit(body.radius);
  if (body.kind == PrimitiveKind::kSphere) {
    out.distance = sphereDistance(x, a, radius, out.normal);
    out.even = (out.distance + radius) * lit(0.8);
  } else {
    const real3 b = spread(body.b);
    real along;
    if (body.kind == PrimitiveKind::kPlane)
      out.distance = planeDistance(x, a, b, out.normal);
    else if (body.kind == PrimitiveKind::kCapsule)
      out.distance = capsuleDistance(x, a, b, radius, out.normal, along);
    else
      out.distance = taperedCapsuleDistance(x, a, b, radius, lit(body.radius_b), out.normal, along);
  }
  out.least = out.distance;
  return out;
}

// Lower bound of the distance of points from the surface, m. Cheaper than surfaceAt() for fields, ellipsoids and convex
// bodies.
[[gnu::noinline]] inline real distanceLowerBound(const SubstepBody& body, const real3& x) {
  if (body.kind == PrimitiveKind::kField) {
    const real3 local = rotateBack(spread(body.rotation), x - spread(body.a));
    if (!isBent(body)) return cornerLowerBound(body, sampleField(body, local, maskAll()), maskAll());
    const MovingBend moving = movingBendOf(body);
    const FieldLookup found = sampleField(body, local + bendShift(bendAt(moving, body.time), local), maskAll());
    return cornerLowerBound(body, found, maskAll()) / lit(moving.stretch);
  }
  if (body.kind == PrimitiveKind::kEllipsoid || body.kind == PrimitiveKind::kConvex)
    return length(x - spread(body.middle)) - lit(body.ball);
  return surfaceAt(body, x, lit(0), maskAll()).distance;
}
