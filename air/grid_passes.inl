// The passes of air/grid_passes.h over any lane type. Included inside a namespace that has the lane vocabulary, the kernel
// text and air/lanes_*.inl. Lanes are neighbours along x, or samples; the formulas are in kernels/grid.h.

// From place (0, 0, 0), as all arrays here.
inline size_t startOf(const GridShape& s, int j, int k) {
  return s.row() * static_cast<size_t>(j) + s.layer() * static_cast<size_t>(k);
}
inline int inside(int i, int end) { return i < 0 ? 0 : i < end ? i : end - 1; }

// The corners around `kLanes` places.
struct Corners {
  alignas(64) Scalar first[kLanes], part[3][kLanes];
};
inline Corners cornersAt(const GridShape& s, const real3& at) {
  const real last = lit(s.cells - 1);
  const GridPlace place = gridPlace(at, makeReal3(last, last, last));
  Corners out;
  store(madd(place.low.z, lit(static_cast<double>(s.layer())),
             madd(place.low.y, lit(static_cast<double>(s.row())), place.low.x)),
        out.first);
  store(place.part.x, out.part[0]);
  store(place.part.y, out.part[1]);
  store(place.part.z, out.part[2]);
  return out;
}
// Four numbers of nodes at the corners of one lane.
inline quads::real sampled(const GridShape& s, const Scalar* nodes, const Corners& corners, int lane) {
  const Scalar* n = nodes + 4 * static_cast<size_t>(corners.first[lane]);
  const size_t y = 4 * s.row(), z = 4 * s.layer();
  const quads::real3 part = {quads::fill(corners.part[0][lane]), quads::fill(corners.part[1][lane]),
                             quads::fill(corners.part[2][lane])};
  return quads::interpolated(quads::load(n), quads::load(n + 4), quads::load(n + y), quads::load(n + y + 4),
                             quads::load(n + z), quads::load(n + z + 4), quads::load(n + z + y),
                             quads::load(n + z + y + 4), part);
}

inline void centrePass(const WindView<Scalar>& w, int k) {
  const GridShape& s = w.shape;
  for (int j = 0; j < s.cells; ++j) {
    const size_t row = startOf(s, j, k);
    for (int i = 0; i < s.cells; ++i) {
      const size_t c = row + static_cast<size_t>(i);
      Scalar* out = w.centre + 4 * c;
      for (int axis = 0; axis < 3; ++axis)
        out[axis] = Scalar(0.5) * (w.velocity[axis][c] + w.velocity[axis][c + s.next(axis)]);
      out[3] = 0;
    }
  }
}

// Displacement by the velocity half way (midpoint rule). Where the row ends, as at its last cell.
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
      for (int lane = 0; lane < kLanes; ++lane) {
        alignas(64) Scalar moved[4];
        quads::store(sampled(s, w.centre, corners, lane), moved);
        for (int axis = 0; axis < 3; ++axis)
          out[axis][row + static_cast<size_t>(i + lane)] = courant * moved[axis];
      }
    }
    for (int axis = 0; axis < 3; ++axis) {
      Scalar* d = out[axis] + row;
      d[-1] = d[0];
      d[s.cells] = d[s.cells - 1];
    }
  }
}

// How far what comes to faces of component `axis` has gone: the mean of the cells on both sides.
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
  const GridPlace place =
      gridPlace(at, makeReal3(lit(axis == 0 ? n : n - 1), lit(axis == 1 ? n : n - 1), lit(axis == 2 ? n : n - 1)));
  const real first = madd(place.low.z, lit(static_cast<double>(s.layer())),
                          madd(place.low.y, lit(static_cast<double>(s.row())), place.low.x));
  const size_t y = s.row(), z = s.layer();
  const real v[8] = {gather(field, first),         gather(field + 1, first),     gather(field + y, first),
                     gather(field + y + 1, first), gather(field + z, first),     gather(field + z + 1, first),
                     gather(field + z + y, first), gather(field + z + y + 1, first)};
  Advected out{interpolated(v[0], v[1], v[2], v[3], v[4], v[5], v[6], v[7], place.part), v[0], v[0]};
  for (int c = 1; c < 8; ++c) {
    out.low = min(out.low, v[c]);
    out.high = max(out.high, v[c]);
  }
  return out;
}
// Beyond the grid's own box, half a cell out of the places of components that do not lie on its faces.
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
      if (w.ambient != nullptr)
        corrected = select(beyond(s, axis, behind) || beyond(s, axis, onward), ahead, corrected);
      storeAt(corrected, out + row + i);
    }
  }
}

// One explicit step of viscosity; beyond the outermost values everything is as they are.
inline void diffusePass(const WindView<Scalar>& w, int axis, Scalar coefficient, int k) {
  const GridShape& s = w.shape;
  const int rows = rowsOf(s, axis), columns = columnsOf(s, axis), layers = axis == 2 ? s.cells + 1 : s.cells;
  Scalar* field = w.velocity[axis];
  for (int j = 0; j < rows; ++j) {
    Scalar* row = field + startOf(s, j, k);
    const Scalar* rows_around[4] = {field + startOf(s, inside(j - 1, rows), k), field + startOf(s, inside(j + 1, rows), k),
                                    field + startOf(s, j, inside(k - 1, layers)),
                                    field + startOf(s, j, inside(k + 1, layers))};
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

inline real neighbours(const PressureView<Scalar>& p, const Scalar* x, size_t c) {
  const size_t y = p.shape.row(), z = p.shape.layer();
  real sum = loadAt(p.open[0] + c) * loadAt(x + c - 1);
  sum = madd(loadAt(p.open[0] + c + 1), loadAt(x + c + 1), sum);
  sum = madd(loadAt(p.open[1] + c), loadAt(x + c - y), sum);
  sum = madd(loadAt(p.open[1] + c + y), loadAt(x + c + y), sum);
  sum = madd(loadAt(p.open[2] + c), loadAt(x + c - z), sum);
  return madd(loadAt(p.open[2] + c + z), loadAt(x + c + z), sum);
}
inline real residualAt(const PressureView<Scalar>& p, const Scalar* x, const Scalar* right, size_t c) {
  return loadAt(right + c) - (loadAt(p.diagonal + c) * loadAt(x + c) - neighbours(p, x, c));
}
// body(c) for the first cell of every vector of a layer.
template <class Body>
inline void alongRows(const GridShape& s, int k, const Body& body) {
  for (int j = 0; j < s.cells; ++j) {
    const size_t row = startOf(s, j, k);
    for (int i = 0; i < s.cells; i += kLanes) body(row + static_cast<size_t>(i));
  }
}

inline void outflowPass(const WindView<Scalar>& w, const PressureView<Scalar>& p, Scalar* right, int k) {
  const size_t y = w.shape.row(), z = w.shape.layer();
  alongRows(w.shape, k, [&](size_t c) {
    const real out = outflow(loadAt(w.velocity[0] + c), loadAt(w.velocity[0] + c + 1), loadAt(w.velocity[1] + c),
                             loadAt(w.velocity[1] + c + y), loadAt(w.velocity[2] + c), loadAt(w.velocity[2] + c + z));
    const real fluid = loadAt(p.diagonal + c);
    storeAt(select(fluid > lit(0), lit(0) - out, lit(0)), right + c);
  });
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
inline void smoothPass(const PressureView<Scalar>& p, const Scalar* x, const Scalar* right, Scalar weight, Scalar* out,
                       int k) {
  if (x == nullptr) {
    alongRows(p.shape, k, [&](size_t c) {
      storeAt(loadAt(p.inverse_diagonal + c) * lit(weight) * loadAt(right + c), out + c);
    });
    return;
  }
  alongRows(p.shape, k, [&](size_t c) {
    const real scale = loadAt(p.inverse_diagonal + c) * lit(weight);
    storeAt(madd(scale, residualAt(p, x, right, c), loadAt(x + c)), out + c);
  });
}
inline void residualPass(const PressureView<Scalar>& p, const Scalar* x, const Scalar* right, Scalar* out, int k) {
  alongRows(p.shape, k, [&](size_t c) { storeAt(residualAt(p, x, right, c), out + c); });
}
inline double applyPass(const PressureView<Scalar>& p, const Scalar* x, Scalar* out, int k) {
  real sum = lit(0);
  alongRows(p.shape, k, [&](size_t c) {
    const real own = loadAt(x + c), row = loadAt(p.diagonal + c) * own - neighbours(p, x, c);
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
      storeAt(lessGradient(loadAt(out), loadAt(p.open[axis] + c), loadAt(pressure + c - s.next(axis)),
                           loadAt(pressure + c)),
              out);
    }
}

constexpr double kSane = 1e4;  // m/s
inline Scalar placePass(const SplatView<Scalar>& v, size_t begin, size_t end) {
  auto plane = [&](int p) { return v.places + static_cast<size_t>(p) * v.stride; };
  static constexpr Scalar kOne[4] = {0, 0, 0, 1};
  const quads::real unit = quads::load(kOne);
  for (size_t n = begin; n < end; ++n) {
    const StrandSample& sample = v.samples[n];
    quads::real x = quads::fill(0), u = unit;
    for (uint32_t i = 0; i < sample.count; ++i) {
      const quads::real share = quads::fill(static_cast<Scalar>(v.shares[sample.share + i]));
      const size_t at = 3 * static_cast<size_t>(sample.vertex + i);
      x = quads::madd(share, quads::threeOf(v.positions + at), x);
      u = quads::madd(share, quads::threeOf(v.velocities + at), u);
    }
    Scalar place[4];
    quads::store(x, place);
    quads::store(u, v.motion + 4 * n);
    for (int c = 0; c < 3; ++c) plane(kWorldPlace + c)[n] = place[c];
  }
  real most = lit(0);
  for (size_t n = begin; n < end; n += kLanes) {
    alignas(64) Scalar speeds[3][kLanes];
    for (int lane = 0; lane < kLanes; ++lane)
      for (int c = 0; c < 3; ++c) speeds[c][lane] = v.motion[4 * (n + static_cast<size_t>(lane)) + static_cast<size_t>(c)];
    const real x = loadAt(plane(kWorldPlace) + n), y = loadAt(plane(kWorldPlace + 1) + n),
               z = loadAt(plane(kWorldPlace + 2) + n);
    const real a = abs(load(speeds[0])), b = abs(load(speeds[1])), c = abs(load(speeds[2]));
    // A sample whose strand went wrong is left out, as beyond the grid.
    const mask sane = a < lit(kSane) && b < lit(kSane) && c < lit(kSane);
    for (int r = 0; r < 3; ++r) {
      const Scalar* f = v.frame + 3 * r;
      const real at = madd(x, lit(f[0]), madd(y, lit(f[1]), madd(z, lit(f[2]), lit(v.frame[9 + r]))));
      storeAt(select(sane, at, lit(-1)), plane(r) + n);
    }
    most = max(most, select(sane, max(max(a, b), c), lit(0)));
  }
  return largest(most);
}

// Samples at the grid's border, and what is not finite, are left out: what is spread from them must stay in the grid.
inline mask isInGrid(const GridShape& s, const real3& at) {
  const real low = lit(2), high = lit(s.cells - 3);
  return at.x >= low && at.x <= high && at.y >= low && at.y <= high && at.z >= low && at.z <= high;
}

// For every sample in the grid spread(lane, node, weights): its first corner and the shares of all eight, kLanes apart;
// before it, for each vector of them, prepare(n, corners).
template <class Prepare, class Spread>
inline void eachSplat(const SplatView<Scalar>& v, size_t begin, size_t end, const Prepare& prepare, const Spread& spread) {
  const GridShape& s = v.shape;
  for (size_t first = begin; first < end; first += kLanes) {
    const int count = static_cast<int>(end - first < kLanes ? end - first : kLanes);
    const Scalar* place = v.places + first;
    const real3 at = makeReal3(loadAt(place), loadAt(place + v.stride), loadAt(place + 2 * v.stride));
    const mask in = isInGrid(s, at);
    const Corners corners =
        cornersAt(s, makeReal3(select(in, at.x, lit(2)), select(in, at.y, lit(2)), select(in, at.z, lit(2))));
    alignas(64) Scalar weights[8][kLanes], inside[kLanes];
    store(select(in, lit(1), lit(0)), inside);
    const real3 part = makeReal3(load(corners.part[0]), load(corners.part[1]), load(corners.part[2]));
    for (int c = 0; c < 8; ++c) store(splatWeight(part, lit(c & 1), lit(c >> 1 & 1), lit(c >> 2)), weights[c]);
    prepare(first, corners);
    for (int lane = 0; lane < count; ++lane)
      if (inside[lane] > 0) spread(lane, static_cast<size_t>(corners.first[lane]), &weights[0][lane]);
  }
}
struct CornerOffsets {
  size_t of[8];
  explicit CornerOffsets(const GridShape& s) {
    const size_t y = s.row(), z = s.layer();
    const size_t offsets[8] = {0, 1, y, y + 1, z, z + 1, z + y, z + y + 1};
    for (int c = 0; c < 8; ++c) of[c] = offsets[c];
  }
};
inline void splatPass(const SplatView<Scalar>& v, size_t begin, size_t end, int32_t* nodes) {
  const CornerOffsets corner(v.shape);
  const Scalar scales[4] = {v.momentum_scale, v.momentum_scale, v.momentum_scale, v.mass_scale};
  const quads::real scale = quads::load(scales);
  size_t first = begin;
  eachSplat(
      v, begin, end, [&](size_t n, const Corners&) { first = n; },
      [&](int lane, size_t node, const Scalar* weights) {
        const size_t n = first + static_cast<size_t>(lane);
        const quads::real value = quads::load(v.motion + 4 * n) * quads::fill(v.masses[n]) * scale;
        for (int c = 0; c < 8; c += 2)
          addShares(value, weights[c * kLanes], weights[(c + 1) * kLanes], nodes + 4 * (node + corner.of[c]));
      });
}
// One number of nodes at corners.
inline real sampledNumber(const GridShape& s, const Scalar* nodes, const Corners& corners) {
  const real first = load(corners.first);
  const size_t y = s.row(), z = s.layer();
  return interpolated(gather(nodes, first), gather(nodes + 1, first), gather(nodes + y, first), gather(nodes + y + 1, first),
                      gather(nodes + z, first), gather(nodes + z + 1, first), gather(nodes + z + y, first),
                      gather(nodes + z + y + 1, first),
                      makeReal3(load(corners.part[0]), load(corners.part[1]), load(corners.part[2])));
}
inline void sampleNumbersPass(const SplatView<Scalar>& v, size_t begin, size_t end, const Scalar* nodes, Scalar* out) {
  eachSplat(
      v, begin, end, [&](size_t n, const Corners& corners) { storeAt(sampledNumber(v.shape, nodes, corners), out + n); },
      [](int, size_t, const Scalar*) {});
}
inline void crowdPass(const SplatView<Scalar>& v, size_t begin, size_t end, const CrowdView<Scalar>& crowd, int32_t* nodes) {
  const CornerOffsets corner(v.shape);
  alignas(64) Scalar numbers[kLanes];
  eachSplat(
      v, begin, end,
      [&](size_t n, const Corners& corners) {
        const real density = sampledNumber(v.shape, crowd.density, corners);
        const real rest = loadAt(crowd.rest + n) * lit(crowd.rest_scale);
        const real stiffness = lit(crowd.stiffness), most = loadAt(crowd.largest + n) * stiffness * lit(kMostHeld);
        const real held = heldCrowding(loadAt(crowd.held + n), density, rest, stiffness, lit(crowd.gain), most);
        storeAt(held, crowd.held + n);
        store(loadAt(v.masses + n) * (crowding(density, rest, stiffness) + held) * lit(crowd.scale), numbers);
      },
      [&](int lane, size_t node, const Scalar* weights) {
        if (!(numbers[lane] > 0)) return;
        for (int c = 0; c < 8; ++c)
          nodes[node + corner.of[c]] += static_cast<int32_t>(numbers[lane] * weights[c * kLanes] + Scalar(0.5));
      });
}

inline void blurPass(const GridShape& s, int numbers, int axis, const Scalar* in, Scalar* out, int k) {
  const size_t next = s.next(axis) * static_cast<size_t>(numbers);
  for (int j = 0; j < s.cells; ++j) {
    const size_t row = startOf(s, j, k) * static_cast<size_t>(numbers);
    for (int i = 0; i < s.cells * numbers; i += kLanes) {
      const size_t c = row + static_cast<size_t>(i);
      storeAt(blurred(loadAt(in + c - next), loadAt(in + c), loadAt(in + c + next)), out + c);
    }
  }
}

// out(n, sampled): what nodes have at each of `count` places.
template <class Out>
inline void eachSampled(const GridShape& s, const Scalar* nodes, const Scalar* places, size_t stride, size_t count,
                        const Out& out) {
  for (size_t first = 0; first < count; first += kLanes) {
    const size_t lanes = count - first < kLanes ? count - first : kLanes;
    const Scalar* at = places + first;
    const Corners corners = cornersAt(s, makeReal3(loadAt(at), loadAt(at + stride), loadAt(at + 2 * stride)));
    for (size_t lane = 0; lane < lanes; ++lane) out(first + lane, sampled(s, nodes, corners, static_cast<int>(lane)));
  }
}
inline void samplePass(const GridShape& s, const Scalar* nodes, const Scalar* places, size_t stride, size_t count,
                       Scalar* out) {
  eachSampled(s, nodes, places, stride, count, [&](size_t n, const quads::real& value) { quads::store(value, out + 4 * n); });
}
inline void changePass(const SplatView<Scalar>& v, const Scalar* nodes, size_t begin, size_t end, Scalar* out) {
  eachSampled(v.shape, nodes, v.places + begin, v.stride, end - begin, [&](size_t n, const quads::real& value) {
    quads::store(value - quads::lastOf(value) * quads::load(v.motion + 4 * (begin + n)), out + 4 * n);
  });
}

inline GridPasses<Scalar> passes() {
  return {"",           &centrePass, &displacePass, &advectPass, &correctPass, &diffusePass, &exchangePass,
          &fastestPass, &outflowPass, &smoothPass, &residualPass, &applyPass,  &advancePass, &dotPass,     &turnPass,
          &subtractGradientPass, &placePass, &splatPass, &sampleNumbersPass, &crowdPass, &blurPass, &samplePass, &changePass};
}
