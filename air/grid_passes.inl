// The passes of air/grid_passes.h over any lane type. Included inside a namespace that has the lane vocabulary, the kernel
// text and air/lanes_*.inl. Lanes are neighbours along x, or samples; the formulas are in kernels/grid.h.

// Offset of a row, from index (0, 0, 0) as all arrays here.
inline size_t startOf(const GridShape& s, int j, int k) {
  return s.row() * static_cast<size_t>(j) + s.layer() * static_cast<size_t>(k);
}
inline int inside(int i, int end) { return i < 0 ? 0 : i < end ? i : end - 1; }

// The cells around `kLanes` positions: index of the first corner in an array, and position in the cell, 0 to 1.
struct Corners {
  alignas(64) uint32_t first[kLanes];
  real3 part;
};
inline Corners cornersAt(const GridShape& s, const real3& at, const real3& last) {
  const GridPlace place = gridPlace(at, last);
  Corners out;
  storeAsInt(
      madd(place.low.z, lit(static_cast<double>(s.layer())), madd(place.low.y, lit(static_cast<double>(s.row())), place.low.x)),
      out.first);
  out.part = place.part;
  return out;
}
inline Corners cornersAt(const GridShape& s, const real3& at) {
  const real last = lit(s.cells - 1);
  return cornersAt(s, at, makeReal3(last, last, last));
}
// Values of a field at the eight corners. Neighbours along x are loaded as pairs, which is faster than gathering.
inline void readCorners(const GridShape& s, const Scalar* field, const Corners& corners, real (&v)[8]) {
  const size_t y = s.row();
  for (int z = 0; z < 2; ++z)
    transposed(
        [&](int lane) {
          const Scalar* p = field + corners.first[lane] + static_cast<size_t>(z) * s.layer();
          return quads::twoAndTwo(p, p + y);
        },
        v + 4 * z);
}
// Corners::part in memory, for access lane by lane.
struct CornerParts {
  alignas(64) Scalar of[3][kLanes];
  explicit CornerParts(const real3& part) {
    store(part.x, of[0]);
    store(part.y, of[1]);
    store(part.z, of[2]);
  }
};
// Nodes of four numbers, interpolated at the position of one lane.
inline quads::real sampled(const GridShape& s, const Scalar* nodes, const Corners& corners, const CornerParts& parts, int lane) {
  const Scalar* n = nodes + 4 * size_t{corners.first[lane]};
  const size_t y = 4 * s.row(), z = 4 * s.layer();
  const quads::real3 part = {quads::fill(parts.of[0][lane]), quads::fill(parts.of[1][lane]), quads::fill(parts.of[2][lane])};
  return quads::interpolated(quads::load(n), quads::load(n + 4), quads::load(n + y), quads::load(n + y + 4), quads::load(n + z),
                             quads::load(n + z + 4), quads::load(n + z + y), quads::load(n + z + y + 4), part);
}

// Distances to the body at the end of the step. The body is placed once for all points.
inline void distancesPass(const MovingPrimitive& primitive, const uint32_t* words, const float* points, size_t count,
                          float* out) {
  const SubstepBody body = bodyAt(primitive, words, 1, 1, 1, 0);
  for (size_t first = 0; first < count; first += kLanes) {
    const size_t lanes = count - first < kLanes ? count - first : kLanes;
    alignas(64) Scalar x[3][kLanes], distance[kLanes];
    for (size_t lane = 0; lane < kLanes; ++lane)
      for (size_t c = 0; c < 3; ++c) x[c][lane] = static_cast<Scalar>(points[3 * (first + (lane < lanes ? lane : 0)) + c]);
    const real3 at = makeReal3(load(x[0]), load(x[1]), load(x[2]));
    store(surfaceAt(body, at, lit(0), maskAll()).distance, distance);
    for (size_t lane = 0; lane < lanes; ++lane) out[first + lane] = static_cast<float>(distance[lane]);
  }
}

inline void centrePass(const WindView<Scalar>& w, int k) {
  const GridShape& s = w.shape;
  for (int j = 0; j < s.cells; ++j) {
    const size_t row = startOf(s, j, k);
    for (int i = 0; i < s.cells; i += kLanes) {
      const size_t c = row + static_cast<size_t>(i);
      real centre[4];
      for (int axis = 0; axis < 3; ++axis) {
        const Scalar* u = w.velocity[axis] + c;
        centre[axis] = (loadAt(u) + loadAt(u + s.next(axis))) * lit(0.5);
      }
      centre[3] = lit(0);
      storeFours(centre, w.centre + 4 * c);
    }
  }
}

// Displacement by the velocity at half the way (midpoint rule). The padding at both ends of a row repeats the end cells.
inline void displacePass(const WindView<Scalar>& w, Scalar courant, Scalar* const* out, int k) {
  const GridShape& s = w.shape;
  for (int j = 0; j < s.cells; ++j) {
    const size_t row = startOf(s, j, k);
    for (int i = 0; i < s.cells; i += kLanes) {
      auto centre = [&](int axis) {
        const Scalar* u = w.velocity[axis] + row + i;
        return (loadAt(u) + loadAt(u + s.next(axis))) * lit(0.5);
      };
      const real3 here = makeReal3(laneNumbers() + lit(i), lit(j), lit(k));
      const real3 middle = tracedBack(here, makeReal3(centre(0), centre(1), centre(2)), lit(0.5 * courant));
      const Corners corners = cornersAt(s, middle);
      const CornerParts parts(corners.part);
      real moved[4];
      transposed([&](int lane) { return sampled(s, w.centre, corners, parts, lane); }, moved);
      for (int axis = 0; axis < 3; ++axis) storeAt(lit(courant) * moved[axis], out[axis] + row + i);
    }
    for (int axis = 0; axis < 3; ++axis) {
      Scalar* d = out[axis] + row;
      d[-1] = d[0];
      d[s.cells] = d[s.cells - 1];
    }
  }
}

// Displacement of the air that arrives at faces of component `axis`: the mean of the cells on both sides.
inline real3 displacementAt(const GridShape& s, Scalar* const* of_cells, int axis, int i, int j, int k) {
  const int jb = inside(axis == 1 ? j - 1 : j, s.cells), kb = inside(axis == 2 ? k - 1 : k, s.cells);
  const size_t after = startOf(s, inside(j, s.cells), inside(k, s.cells)) + static_cast<size_t>(i);
  const size_t before = axis == 0 ? after - 1 : startOf(s, jb, kb) + static_cast<size_t>(i);
  auto mean = [&](const Scalar* d) { return (loadAt(d + before) + loadAt(d + after)) * lit(0.5); };
  return makeReal3(mean(of_cells[0]), mean(of_cells[1]), mean(of_cells[2]));
}

struct Advected {
  real value, low, high;
};
inline Advected valueAt(const GridShape& s, const Scalar* field, int axis, const real3& at) {
  const double n = s.cells;
  const Corners corners =
      cornersAt(s, at, makeReal3(lit(axis == 0 ? n : n - 1), lit(axis == 1 ? n : n - 1), lit(axis == 2 ? n : n - 1)));
  real v[8];
  readCorners(s, field, corners, v);
  Advected out{interpolated(v[0], v[1], v[2], v[3], v[4], v[5], v[6], v[7], corners.part), v[0], v[0]};
  for (int c = 1; c < 8; ++c) {
    out.low = min(out.low, v[c]);
    out.high = max(out.high, v[c]);
  }
  return out;
}
// Whether a position is outside the box of the grid. On the axes across `axis` values stand at cell centres, half a cell inside the
// box.
inline mask beyond(const GridShape& s, int axis, const real3& at) {
  const double n = s.cells;
  auto out = [&](const real& x, bool own) { return x < lit(own ? 0 : -0.5) || x > lit(own ? n : n - 0.5); };
  return out(at.x, axis == 0) || out(at.y, axis == 1) || out(at.z, axis == 2);
}
inline int rowsOf(const GridShape& s, int axis) { return axis == 1 ? s.cells + 1 : s.cells; }
inline int columnsOf(const GridShape& s, int axis) { return axis == 0 ? s.cells + 1 : s.cells; }

inline void advectPass(const WindView<Scalar>& w, int axis, int k) {
  const GridShape& s = w.shape;
  for (int j = 0; j < rowsOf(s, axis); ++j) {
    const size_t row = startOf(s, j, k);
    for (int i = 0; i < columnsOf(s, axis); i += kLanes) {
      const real3 here = makeReal3(laneNumbers() + lit(i), lit(j), lit(k));
      const real3 at = here - displacementAt(s, w.displacement, axis, i, j, k);
      Scalar* out = w.next[axis] + row + i;
      storeAt(valueAt(s, w.velocity[axis], axis, at).value, out);
      if (w.ambient == nullptr || !anyTrue(beyond(s, axis, at))) continue;
      alignas(64) Scalar flags[kLanes], place[3][kLanes];
      store(select(beyond(s, axis, at), lit(1), lit(0)), flags);
      store(at.x, place[0]);
      store(at.y, place[1]);
      store(at.z, place[2]);
      for (int lane = 0; lane < kLanes; ++lane) {
        const Scalar point[3] = {place[0][lane], place[1][lane], place[2][lane]};
        if (flags[lane] > 0) out[lane] = w.ambient_velocity(w.ambient, axis, point);
      }
    }
  }
}

inline void correctPass(const WindView<Scalar>& w, int axis, Scalar* out, int k) {
  const GridShape& s = w.shape;
  for (int j = 0; j < rowsOf(s, axis); ++j) {
    const size_t row = startOf(s, j, k);
    for (int i = 0; i < columnsOf(s, axis); i += kLanes) {
      const real3 here = makeReal3(laneNumbers() + lit(i), lit(j), lit(k));
      const real3 behind = here - displacementAt(s, w.displacement, axis, i, j, k);
      const real3 onward = here - displacementAt(s, w.onward, axis, i, j, k);
      const Advected from = valueAt(s, w.velocity[axis], axis, behind);
      const real ahead = loadAt(w.next[axis] + row + i), was = loadAt(w.velocity[axis] + row + i);
      const real back = valueAt(s, w.next[axis], axis, onward).value;
      real corrected = macCormack(ahead, was, back, from.low, from.high);
      if (w.ambient != nullptr) corrected = select(beyond(s, axis, behind) || beyond(s, axis, onward), ahead, corrected);
      storeAt(corrected, out + row + i);
    }
  }
}

// One explicit step of viscosity; outside the grid the outermost values are repeated.
inline void diffusePass(const WindView<Scalar>& w, int axis, Scalar coefficient, int k) {
  const GridShape& s = w.shape;
  const int rows = rowsOf(s, axis), columns = columnsOf(s, axis), layers = axis == 2 ? s.cells + 1 : s.cells;
  Scalar* field = w.velocity[axis];
  for (int j = 0; j < rows; ++j) {
    Scalar* row = field + startOf(s, j, k);
    const Scalar* rows_around[4] = {field + startOf(s, inside(j - 1, rows), k), field + startOf(s, inside(j + 1, rows), k),
                                    field + startOf(s, j, inside(k - 1, layers)), field + startOf(s, j, inside(k + 1, layers))};
    row[-1] = row[0];
    row[columns] = row[columns - 1];
    for (int i = 0; i < columns; i += kLanes) {
      const real own = loadAt(row + i);
      real sum = loadAt(row + i - 1) + loadAt(row + i + 1);
      for (const Scalar* around : rows_around) sum = sum + loadAt(around + i);
      storeAt(madd(sum - own * lit(6), lit(coefficient), own), w.next[axis] + startOf(s, j, k) + i);
    }
  }
}

inline void exchangePass(const WindView<Scalar>& w, int axis, int k) {
  const GridShape& s = w.shape;
  for (int j = 0; j < rowsOf(s, axis); ++j) {
    const size_t row = startOf(s, j, k);
    for (int i = 0; i < columnsOf(s, axis); i += kLanes) {
      const size_t after = row + static_cast<size_t>(i), before = after - s.next(axis);
      auto mean = [&](const Scalar* e) { return (loadAt(e + before) + loadAt(e + after)) * lit(0.5); };
      const real rate = mean(w.exchange[0]);
      if (!anyTrue(rate > lit(0))) continue;
      Scalar* out = w.velocity[axis] + after;
      const real target = mean(w.exchange[1 + axis]) * inverse(max(rate, lit(1e-20)));
      storeAt(draggedTo(loadAt(out), target, rate), out);
    }
  }
}

// As exchangePass(), with anisotropic drag of hair.
inline void exchangeAmongPass(const WindView<Scalar>& w, int axis, int k) {
  const GridShape& s = w.shape;
  for (int j = 0; j < rowsOf(s, axis); ++j) {
    const size_t row = startOf(s, j, k);
    for (int i = 0; i < columnsOf(s, axis); i += kLanes) {
      const size_t after = row + static_cast<size_t>(i), before = after - s.next(axis);
      auto mean = [&](const Scalar* e) { return (loadAt(e + before) + loadAt(e + after)) * lit(0.5); };
      auto three = [&](Scalar* const* e) { return makeReal3(mean(e[0]), mean(e[1]), mean(e[2])); };
      const real rate = mean(w.exchange[0]);
      const mask some = rate > lit(0);
      if (!anyTrue(some)) continue;
      real here[4], there[4];
      loadFours(w.centre + 4 * before, here);
      loadFours(w.centre + 4 * after, there);
      Scalar* out = w.velocity[axis] + after;
      const real own = loadAt(out);
      real velocity[3];
      for (int c = 0; c < 3; ++c) velocity[c] = c == axis ? own : (here[c] + there[c]) * lit(0.5);
      const real3 dragged = draggedAmong(makeReal3(velocity[0], velocity[1], velocity[2]), three(w.exchange + 1), rate,
                                         three(w.slip), three(w.slip + 3));
      storeAt(select(some, axis == 0 ? dragged.x : axis == 1 ? dragged.y : dragged.z, own), out);
    }
  }
}

// Weights of the faces of a row: stored per face, or one for all faces, which then are not loaded. The results are equal.
struct StoredWeights {
  const PressureView<Scalar>& p;
  real open(int axis, size_t face) const { return loadAt(p.open[axis] + face); }
  real diagonal(size_t c) const { return loadAt(p.diagonal + c); }
  real inverseDiagonal(size_t c) const { return loadAt(p.inverse_diagonal + c); }
};
struct EvenWeights {
  real weight, sum, inverse_sum;
  real open(int, size_t) const { return weight; }
  real diagonal(size_t) const { return sum; }
  real inverseDiagonal(size_t) const { return inverse_sum; }
};
template <class Weights>
inline real neighbours(const GridShape& s, const Weights& w, const Scalar* x, size_t c) {
  const size_t y = s.row(), z = s.layer();
  real sum = w.open(0, c) * loadAt(x + c - 1);
  sum = madd(w.open(0, c + 1), loadAt(x + c + 1), sum);
  sum = madd(w.open(1, c), loadAt(x + c - y), sum);
  sum = madd(w.open(1, c + y), loadAt(x + c + y), sum);
  sum = madd(w.open(2, c), loadAt(x + c - z), sum);
  return madd(w.open(2, c + z), loadAt(x + c + z), sum);
}
template <class Weights>
inline real residualAt(const GridShape& s, const Weights& w, const Scalar* x, const Scalar* right, size_t c) {
  return loadAt(right + c) - (w.diagonal(c) * loadAt(x + c) - neighbours(s, w, x, c));
}
// Calls body(c) for the first cell of every vector of a layer.
template <class Body>
inline void alongRows(const GridShape& s, int k, const Body& body) {
  for (int j = 0; j < s.cells; ++j) {
    const size_t row = startOf(s, j, k);
    for (int i = 0; i < s.cells; i += kLanes) body(row + static_cast<size_t>(i));
  }
}
// Calls body(c, weights) likewise. Weights behind the end of a row are 0, so equal weights need rows of whole vectors.
template <class Body>
inline void alongWeights(const PressureView<Scalar>& p, int k, const Body& body) {
  const GridShape& s = p.shape;
  const StoredWeights stored{p};
  for (int j = 0; j < s.cells; ++j) {
    const size_t row = startOf(s, j, k);
    const Scalar weight = s.cells % kLanes == 0 ? p.even[k * s.cells + j] : 0;
    if (weight > 0) {
      const EvenWeights even{lit(weight), lit(p.diagonal[row]), lit(p.inverse_diagonal[row])};
      for (int i = 0; i < s.cells; i += kLanes) body(row + static_cast<size_t>(i), even);
    } else {
      for (int i = 0; i < s.cells; i += kLanes) body(row + static_cast<size_t>(i), stored);
    }
  }
}

template <class Wanted>
inline void outflowAlong(const WindView<Scalar>& w, const PressureView<Scalar>& p, const Wanted& wanted, Scalar* right, int k) {
  const size_t y = w.shape.row(), z = w.shape.layer();
  alongRows(w.shape, k, [&](size_t c) {
    const real out = outflow(loadAt(w.velocity[0] + c), loadAt(w.velocity[0] + c + 1), loadAt(w.velocity[1] + c),
                             loadAt(w.velocity[1] + c + y), loadAt(w.velocity[2] + c), loadAt(w.velocity[2] + c + z));
    const real fluid = loadAt(p.diagonal + c);
    storeAt(select(fluid > lit(0), wanted(c) - out, lit(0)), right + c);
  });
}
inline void outflowPass(const WindView<Scalar>& w, const PressureView<Scalar>& p, Scalar* right, int k) {
  if (w.target_divergence == nullptr)
    outflowAlong(
        w, p, [](size_t) { return lit(0); }, right, k);
  else
    outflowAlong(
        w, p, [&](size_t c) { return loadAt(w.target_divergence + c); }, right, k);
}
inline Scalar fastestPass(const WindView<Scalar>& w, int k) {
  real most = lit(0);
  const GridShape& s = w.shape;
  for (int axis = 0; axis < 3; ++axis) {
    if (k == s.cells && axis != 2) continue;
    for (int j = 0; j < rowsOf(s, axis); ++j)
      for (int i = 0; i < columnsOf(s, axis); i += kLanes) {
        const real inside = laneNumbers() + lit(i);
        const real size = abs(loadAt(w.velocity[axis] + startOf(s, j, k) + i));
        most = max(most, select(inside < lit(columnsOf(s, axis)), size, lit(0)));
      }
  }
  return largest(most);
}
inline void smoothPass(const PressureView<Scalar>& p, const Scalar* x, const Scalar* right, Scalar weight, Scalar* out, int k) {
  if (x == nullptr) {
    alongWeights(p, k,
                 [&](size_t c, const auto& w) { storeAt(w.inverseDiagonal(c) * lit(weight) * loadAt(right + c), out + c); });
    return;
  }
  alongWeights(p, k, [&](size_t c, const auto& w) {
    const real scale = w.inverseDiagonal(c) * lit(weight);
    storeAt(madd(scale, residualAt(p.shape, w, x, right, c), loadAt(x + c)), out + c);
  });
}
inline void residualPass(const PressureView<Scalar>& p, const Scalar* x, const Scalar* right, Scalar* out, int k) {
  alongWeights(p, k, [&](size_t c, const auto& w) { storeAt(residualAt(p.shape, w, x, right, c), out + c); });
}
// Sums of eight cells for a layer of the coarser grid. Values that vectors write behind the end of a row are not used.
inline void restrictPass(const GridShape& fine, const Scalar* in, const GridShape& coarse, Scalar* out, int k) {
  const size_t y = fine.row(), z = fine.layer();
  for (int j = 0; j < coarse.cells; ++j)
    for (int i = 0; i < coarse.cells; i += kLanes) {
      const Scalar* cells = in + startOf(fine, 2 * j, 2 * k) + 2 * i;
      real pair[2];
      loadTwos(cells, pair);
      real sum = pair[0] + pair[1];
      for (const size_t next : {y, z, z + y}) {
        loadTwos(cells + next, pair);
        sum = sum + pair[0] + pair[1];
      }
      storeAt(sum, out + startOf(coarse, j, k) + i);
    }
}
// Adds the values of the coarser grid to the cells of a layer that are not solid.
inline void prolongPass(const PressureView<Scalar>& p, const GridShape& coarse, const Scalar* in, Scalar* x, int k) {
  for (int j = 0; j < p.shape.cells; ++j)
    for (int i = 0; i < coarse.cells; i += kLanes) {
      const size_t c = startOf(p.shape, j, k) + 2 * static_cast<size_t>(i);
      const mask own = laneNumbers() < lit(coarse.cells - i);
      const real add = select(own, loadAt(in + startOf(coarse, j / 2, k / 2) + i), lit(0));
      real cells[2], inverse_diagonal[2];
      loadTwos(x + c, cells);
      loadTwos(p.inverse_diagonal + c, inverse_diagonal);
      for (int side = 0; side < 2; ++side) cells[side] = cells[side] + select(inverse_diagonal[side] > lit(0), add, lit(0));
      storeTwos(cells, x + c);
    }
}
inline double applyPass(const PressureView<Scalar>& p, const Scalar* x, Scalar* out, int k) {
  real sum = lit(0);
  alongWeights(p, k, [&](size_t c, const auto& w) {
    const real own = loadAt(x + c), row = w.diagonal(c) * own - neighbours(p.shape, w, x, c);
    storeAt(row, out + c);
    sum = madd(own, row, sum);
  });
  return static_cast<double>(sumOf(sum));
}
inline Scalar advancePass(const GridShape& s, Scalar a, const Scalar* step, const Scalar* q, Scalar* x, Scalar* r, int k) {
  real most = lit(0);
  alongRows(s, k, [&](size_t c) {
    storeAt(madd(loadAt(step + c), lit(a), loadAt(x + c)), x + c);
    const real left = madd(loadAt(q + c), lit(-a), loadAt(r + c));
    storeAt(left, r + c);
    most = max(most, abs(left));
  });
  return largest(most);
}
inline double dotPass(const GridShape& s, const Scalar* a, const Scalar* b, int k) {
  real sum = lit(0);
  alongRows(s, k, [&](size_t c) { sum = madd(loadAt(a + c), loadAt(b + c), sum); });
  return static_cast<double>(sumOf(sum));
}
inline void turnPass(const GridShape& s, Scalar a, const Scalar* z, Scalar* step, int k) {
  alongRows(s, k, [&](size_t c) { storeAt(madd(loadAt(step + c), lit(a), loadAt(z + c)), step + c); });
}
inline void subtractGradientPass(const WindView<Scalar>& w, const PressureView<Scalar>& p, const Scalar* pressure, int axis,
                                 int k) {
  const GridShape& s = w.shape;
  for (int j = 0; j < rowsOf(s, axis); ++j)
    for (int i = 0; i < columnsOf(s, axis); i += kLanes) {
      const size_t c = startOf(s, j, k) + static_cast<size_t>(i);
      Scalar* out = w.velocity[axis] + c;
      storeAt(projectVelocity(loadAt(out), loadAt(p.open[axis] + c), loadAt(pressure + c - s.next(axis)), loadAt(pressure + c)),
              out);
    }
}

// Samples near the border of the grid and positions that are not finite are left out: splats and blurs must stay inside.
inline mask isInGrid(const GridShape& s, const real3& at) {
  const real low = lit(2), high = lit(s.cells - 3);
  return at.x >= low && at.x <= high && at.y >= low && at.y <= high && at.z >= low && at.z <= high;
}

constexpr double kMaxSampleSpeed = 1e4;   // m/s; a faster strand has diverged
constexpr size_t kSamplesTogether = 128;  // fit the L1 cache between the two loops
// Extrapolated positions (m, 4 numbers each, into `places`) and velocities (into v.motion) of samples.
inline void locate(const SplatView<Scalar>& v, size_t begin, size_t end, Scalar* places) {
  static constexpr Scalar kOne[4] = {0, 0, 0, 1};
  const quads::real unit = quads::load(kOne), ahead = quads::fill(v.ahead);
  for (size_t n = begin; n < end; ++n) {
    const StrandSample& sample = v.samples[n];
    const float* shares = v.shares + sample.share;
    const size_t first = 3 * size_t{sample.vertex};
    quads::real x = quads::fill(0), u = unit;
    for (size_t i = 0; i < sample.count; ++i) {
      const quads::real share = quads::fill(static_cast<Scalar>(shares[i]));
      x = quads::madd(share, quads::threeOf(v.positions + first + 3 * i), x);
      u = quads::madd(share, quads::threeOf(v.velocities + first + 3 * i), u);
    }
    quads::store(quads::madd(ahead, u, x), places + 4 * (n - begin));
    quads::store(u, v.motion + 4 * n);
  }
}
inline SplatReach<Scalar> placePass(const SplatView<Scalar>& v, size_t begin, size_t end) {
  auto plane = [&](int p) { return v.places + static_cast<size_t>(p) * v.stride; };
  const real none = lit(v.shape.cells);
  real most = lit(0), low[3] = {none, none, none}, high[3] = {lit(0), lit(0), lit(0)};
  alignas(64) Scalar places[4 * (kSamplesTogether + kLanes)] = {};
  for (size_t first = begin; first < end; first += kSamplesTogether) {
    const size_t last = end - first < kSamplesTogether ? end : first + kSamplesTogether;
    locate(v, first, last, places);
    for (size_t n = first; n < last; n += kLanes) {
      real x[4], u[4], at[3];
      loadFours(places + 4 * (n - first), x);
      loadFours(v.motion + 4 * n, u);
      const real a = abs(u[0]), b = abs(u[1]), c = abs(u[2]);
      // A sample of a strand that diverged is left out: its position is set outside the grid.
      const mask sane = a < lit(kMaxSampleSpeed) && b < lit(kMaxSampleSpeed) && c < lit(kMaxSampleSpeed);
      for (int r = 0; r < 3; ++r) {
        const Scalar* f = v.frame + 3 * r;
        const real there = madd(x[0], lit(f[0]), madd(x[1], lit(f[1]), madd(x[2], lit(f[2]), lit(v.frame[9 + r]))));
        at[r] = select(sane, there, lit(-1));
        storeAt(at[r], plane(r) + n);
        storeAt(x[r], plane(kWorldPlace + r) + n);
      }
      most = max(most, select(sane, max(max(a, b), c), lit(0)));
      const mask in = isInGrid(v.shape, makeReal3(at[0], at[1], at[2]));
      for (int r = 0; r < 3; ++r) {
        low[r] = min(low[r], select(in, at[r], none));
        high[r] = max(high[r], select(in, at[r], lit(0)));
      }
    }
  }
  SplatReach<Scalar> out;
  out.fastest = largest(most);
  for (int r = 0; r < 3; ++r) {
    out.low[r] = reduceMin(low[r]);
    out.high[r] = largest(high[r]);
  }
  return out;
}

// Calls body(n, corners, in) for each vector of samples. `in`: lanes inside the grid; other lanes have arbitrary valid corners.
template <class Body>
inline void eachInGrid(const SplatView<Scalar>& v, size_t begin, size_t end, const Body& body) {
  for (size_t n = begin; n < end; n += kLanes) {
    const size_t count = end - n < kLanes ? end - n : kLanes;
    const Scalar* place = v.places + n;
    const real3 at = makeReal3(loadAt(place), loadAt(place + v.stride), loadAt(place + 2 * v.stride));
    const mask in = isInGrid(v.shape, at) && laneNumbers() < lit(static_cast<double>(count));
    body(n, cornersAt(v.shape, makeReal3(select(in, at.x, lit(2)), select(in, at.y, lit(2)), select(in, at.z, lit(2)))), in);
  }
}
// Calls spread(lane, node, low, high) for the lanes of the mask. `node`: first corner; `low`, `high`: weights of the four corners of
// its layer and of the next layer.
template <class Spread>
inline void spreadOver(const Corners& corners, const mask& lanes, const Spread& spread) {
  alignas(64) Scalar shares[2][4 * kLanes];
  for (int z = 0; z < 2; ++z) {
    real of_layer[4];
    for (int c = 0; c < 4; ++c) of_layer[c] = splatWeight(corners.part, lit(c & 1), lit(c >> 1), lit(z));
    storeFours(of_layer, shares[z]);
  }
  for (uint32_t left = laneBits(lanes); left != 0; left &= left - 1) {
    const int lane = std::countr_zero(left);
    spread(lane, size_t{corners.first[lane]}, shares[0] + 4 * lane, shares[1] + 4 * lane);
  }
}
inline void splatPass(const SplatView<Scalar>& v, size_t begin, size_t end, int32_t* nodes) {
  const size_t y = 4 * v.shape.row(), z = 4 * v.shape.layer();
  const Scalar scales[4] = {v.momentum_scale, v.momentum_scale, v.momentum_scale, v.mass_scale};
  eachInGrid(v, begin, end, [&](size_t n, const Corners& corners, const mask& in) {
    const Scalar *motion = v.motion + 4 * n, *masses = v.masses + n;
    spreadOver(corners, in, [=, &scales](int lane, size_t node, const Scalar* low, const Scalar* high) {
      const Shared splatted = sharedOut(motion + 4 * lane, masses[lane], scales);
      addShares(splatted, low, nodes + 4 * node, y);
      addShares(splatted, high, nodes + 4 * node + z, y);
    });
  });
}
// Nodes of one number, interpolated.
inline real sampledNumber(const GridShape& s, const Scalar* nodes, const Corners& corners) {
  real v[8];
  readCorners(s, nodes, corners, v);
  return interpolated(v[0], v[1], v[2], v[3], v[4], v[5], v[6], v[7], corners.part);
}
inline void sampleNumbersPass(const SplatView<Scalar>& v, size_t begin, size_t end, const Scalar* nodes, Scalar* out) {
  eachInGrid(v, begin, end,
             [&](size_t n, const Corners& corners, const mask&) { storeAt(sampledNumber(v.shape, nodes, corners), out + n); });
}
inline void crowdPass(const SplatView<Scalar>& v, size_t begin, size_t end, const CrowdView<Scalar>& crowd, int32_t* nodes) {
  const size_t y = v.shape.row(), z = v.shape.layer();
  eachInGrid(v, begin, end, [&](size_t n, const Corners& corners, const mask& in) {
    const real density = sampledNumber(v.shape, crowd.density, corners);
    const real rest = loadAt(crowd.rest + n) * lit(crowd.rest_scale);
    const real stiffness = lit(crowd.stiffness), most = loadAt(crowd.largest + n) * stiffness * lit(kMaxHeldCrowding);
    const real held = heldCrowding(loadAt(crowd.held + n), density, rest, stiffness, lit(crowd.gain), most);
    storeAt(held, crowd.held + n);
    const real number = loadAt(v.masses + n) * (crowding(density, rest, stiffness) + held) * lit(crowd.scale);
    const mask crowded = in && number > lit(0);
    if (!anyTrue(crowded)) return;
    alignas(64) Scalar numbers[kLanes];
    store(number, numbers);
    spreadOver(corners, crowded, [&](int lane, size_t node, const Scalar* low, const Scalar* high) {
      auto add = [&](int32_t& sum, Scalar share) { sum += static_cast<int32_t>(numbers[lane] * share + Scalar(0.5)); };
      for (size_t c = 0; c < 4; ++c) {
        const size_t corner = node + (c & 1) + (c >> 1) * y;
        add(nodes[corner], low[c]);
        add(nodes[corner + z], high[c]);
      }
    });
  });
}

// Calls body(c) for the first number of every vector of a layer that intersects the box; nodes have `numbers` numbers.
template <class Body>
inline void alongBox(const GridShape& s, int numbers, const NodeBox& box, int k, const Body& body) {
  for (int j = box.min().y(); j <= box.max().y(); ++j) {
    const size_t row = startOf(s, j, k) * static_cast<size_t>(numbers);
    for (int i = box.min().x() * numbers / kLanes * kLanes; i < (box.max().x() + 1) * numbers; i += kLanes)
      body(row + static_cast<size_t>(i));
  }
}
inline void blurPass(const GridShape& s, int numbers, int axis, const NodeBox& box, const Scalar* in, Scalar* out, int k) {
  const size_t next = s.next(axis) * static_cast<size_t>(numbers);
  alongBox(s, numbers, box, k,
           [&](size_t c) { storeAt(blurred(loadAt(in + c - next), loadAt(in + c), loadAt(in + c + next)), out + c); });
}
// density^(-1/2) of nodes with hair.
inline real thinAt(const HairView<Scalar>& h, const mask& hairy, size_t c) {
  return lit(1) / sqrt(select(hairy, loadAt(h.density + c), lit(1)));
}
inline void spreadPass(const HairView<Scalar>& h, const NodeBox& box, int k) {
  alongBox(h.shape, 1, box, k, [&](size_t c) {
    real node[4];
    loadFours(h.nodes + 4 * c, node);
    const mask hairy = node[3] > lit(0);
    const real thin = select(hairy, thinAt(h, hairy, c), lit(0));
    for (real& number : node) number = number * thin;
    storeFours(node, h.spread + 4 * c);
  });
}
inline void forcesPass(const HairView<Scalar>& h, const NodeBox& box, int k) {
  alongBox(h.shape, 1, box, k, [&](size_t c) {
    real node[4], out[4] = {lit(0), lit(0), lit(0), lit(0)};
    loadFours(h.nodes + 4 * c, node);
    const mask hairy = node[3] > lit(0);
    if (!anyTrue(hairy)) return storeFours(out, h.changes + 4 * c);
    if (h.crowding != nullptr)
      for (int axis = 0; axis < 3; ++axis) {
        const size_t next = h.shape.next(axis);
        const real push = pushAlong(loadAt(h.crowding + c), loadAt(h.density + c - next), loadAt(h.density + c + next),
                                    loadAt(h.crowded + c - next), loadAt(h.crowded + c + next), lit(h.slope));
        for (int r = 0; r < 3; ++r) out[r] = out[r] + lit(h.turn[3 * r + axis]) * push;
      }
    if (h.spread != nullptr) {
      real rubbed[4];
      loadFours(h.spread + 4 * c, rubbed);
      const real share = lit(h.part) * thinAt(h, hairy, c);
      for (int r = 0; r < 4; ++r) out[r] = out[r] + share * rubbed[r];
    }
    for (real& number : out) number = select(hairy, number, lit(0));
    storeFours(out, h.changes + 4 * c);
  });
}

// Calls out(n, value) with the interpolated nodes of each of `count` positions.
template <class Out>
inline void eachSampled(const GridShape& s, const Scalar* nodes, const Scalar* places, size_t stride, size_t count,
                        const Out& out) {
  for (size_t first = 0; first < count; first += kLanes) {
    const size_t lanes = count - first < kLanes ? count - first : kLanes;
    const Scalar* at = places + first;
    const Corners corners = cornersAt(s, makeReal3(loadAt(at), loadAt(at + stride), loadAt(at + 2 * stride)));
    const CornerParts parts(corners.part);
    for (size_t lane = 0; lane < lanes; ++lane) out(first + lane, sampled(s, nodes, corners, parts, static_cast<int>(lane)));
  }
}
inline void samplePass(const GridShape& s, const Scalar* nodes, const Scalar* places, size_t stride, size_t count, Scalar* out) {
  eachSampled(s, nodes, places, stride, count, [&](size_t n, const quads::real& value) { quads::store(value, out + 4 * n); });
}
inline void changePass(const SplatView<Scalar>& v, const Scalar* nodes, size_t begin, size_t end, Scalar* out) {
  eachSampled(v.shape, nodes, v.places + begin, v.stride, end - begin, [&](size_t n, const quads::real& value) {
    quads::store(value - quads::lastOf(value) * quads::load(v.motion + 4 * (begin + n)), out + 4 * n);
  });
}

inline GridPasses<Scalar> passes() {
  return {"",           &distancesPass, &centrePass,        &displacePass,      &advectPass,
          &correctPass, &diffusePass,   &exchangePass,      &exchangeAmongPass, &fastestPass,
          &outflowPass, &smoothPass,    &residualPass,      &restrictPass,      &prolongPass,
          &applyPass,   &advancePass,   &dotPass,           &turnPass,          &subtractGradientPass,
          &placePass,   &splatPass,     &sampleNumbersPass, &crowdPass,         &blurPass,
          &spreadPass,  &forcesPass,    &samplePass,        &changePass};
}
