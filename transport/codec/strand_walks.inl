// The encoders and decoders of docs/wire.md, "Payloads", tile after tile: strands side by side, one per lane. Included
// inside a target's namespace after kernels/lanes_highway.inl and quantization.inl.

/// As many strands of a run as there are lanes.
struct Tile {
  uint32_t first = 0;                     ///< index of the first strand in the run
  size_t rows = 0;                        ///< vertices of the longest strand
  std::array<size_t, kLanes> counts{};    ///< vertices of each strand; 0 in lanes beyond the run
  std::array<size_t, kLanes> vertices{};  ///< first vertex of each strand, in the run
  size_t lanes = 0;                       ///< lanes that have a strand

  Tile(const GuideGeometry& geometry, const StrandRun& run, uint32_t first_strand) : first(first_strand) {
    for (size_t l = 0; l < kLanes; ++l) {
      const size_t number = first + l;
      if (number >= run.strand_count) break;
      const uint32_t* const offset = &geometry.offsets[run.first_strand + number];
      vertices[l] = offset[0] - run.first_vertex;
      counts[l] = offset[1] - offset[0];
      rows = std::max(rows, counts[l]);
      ++lanes;
    }
  }
  /// Index of a strand's first edge in the run.
  size_t edge(size_t lane) const { return vertices[lane] - (first + lane); }
};

constexpr size_t kRow = static_cast<size_t>(kLanes);

HWY_INLINE real row(const float* rows, size_t i) { return {hn::LoadU(Tag(), rows + i * kRow)}; }
HWY_INLINE void setRow(float* rows, size_t i, real value) { hn::StoreU(value.v, Tag(), rows + i * kRow); }
/// Three rows per vertex: x, y, z.
HWY_INLINE real3 row3(const float* rows, size_t i) {
  return makeReal3(row(rows, 3 * i), row(rows, 3 * i + 1), row(rows, 3 * i + 2));
}
HWY_INLINE void setRow3(float* rows, size_t i, const real3& value) {
  setRow(rows, 3 * i, value.x);
  setRow(rows, 3 * i + 1, value.y);
  setRow(rows, 3 * i + 2, value.z);
}

// 32-bit numbers of any kind become rows of lanes by 4 x 4 transposes in every 128 bits of a vector.

#if HWY_TARGET != HWY_SCALAR
/// Loads four numbers of every fourth strand.
template <class D>
HWY_INLINE hn::Vec<D> loadQuads(D d, const float* const* strands, size_t at) {
  if constexpr (hn::MaxLanes(D()) <= 4) {
    return hn::LoadU(d, strands[0] + at);
  } else {
    const hn::Half<D> half;
    return hn::Combine(d, loadQuads(half, strands + hn::MaxLanes(D()) / 2, at), loadQuads(half, strands, at));
  }
}
template <class D>
HWY_INLINE void storeQuads(D d, hn::Vec<D> quads, float* const* strands, size_t at) {
  if constexpr (hn::MaxLanes(D()) <= 4) {
    hn::StoreU(quads, d, strands[0] + at);
  } else {
    const hn::Half<D> half;
    storeQuads(half, hn::LowerHalf(half, quads), strands, at);
    storeQuads(half, hn::UpperHalf(half, quads), strands + hn::MaxLanes(D()) / 2, at);
  }
}

HWY_INLINE void transposeQuads(real (&r)[4]) {
  const hn::RepartitionToWide<Tag> wide;
  const auto low01 = hn::BitCast(wide, hn::InterleaveLower(Tag(), r[0].v, r[1].v));
  const auto low23 = hn::BitCast(wide, hn::InterleaveLower(Tag(), r[2].v, r[3].v));
  const auto high01 = hn::BitCast(wide, hn::InterleaveUpper(Tag(), r[0].v, r[1].v));
  const auto high23 = hn::BitCast(wide, hn::InterleaveUpper(Tag(), r[2].v, r[3].v));
  r[0].v = hn::BitCast(Tag(), hn::InterleaveLower(wide, low01, low23));
  r[1].v = hn::BitCast(Tag(), hn::InterleaveUpper(wide, low01, low23));
  r[2].v = hn::BitCast(Tag(), hn::InterleaveLower(wide, high01, high23));
  r[3].v = hn::BitCast(Tag(), hn::InterleaveUpper(wide, high01, high23));
}
#endif

/// Source or target of each lane's numbers, with their count; `least` is the smallest count of all lanes.
template <class Pointer>
struct Streams {
  std::array<Pointer, kLanes> at{};
  std::array<size_t, kLanes> counts{};
  size_t lanes = 0, least = 0;
  HWY_INLINE void add(Pointer from, size_t count) {
    least = lanes == 0 ? count : std::min(least, count);
    at[lanes] = from;
    counts[lanes++] = count;
  }
};

/// Transposes each lane's numbers into rows.
HWY_INLINE void transposeIn(Streams<const float*>& streams, float* rows) {
  size_t done = 0;
#if HWY_TARGET != HWY_SCALAR
  for (size_t l = streams.lanes; l < kRow; ++l) streams.at[l] = streams.at[0];
  for (; streams.lanes > 0 && done + 4 <= streams.least; done += 4) {
    real r[4];
    for (size_t k = 0; k < 4; ++k) r[k].v = loadQuads(Tag(), streams.at.data() + k, done);
    transposeQuads(r);
    for (size_t k = 0; k < 4; ++k) setRow(rows, done + k, r[k]);
  }
#endif
  for (size_t l = 0; l < streams.lanes; ++l) {
    for (size_t i = done; i < streams.counts[l]; ++i) std::memcpy(rows + i * kRow + l, streams.at[l] + i, sizeof(float));
  }
}
/// The inverse of transposeIn().
HWY_INLINE void draw(const float* rows, const Streams<float*>& streams) {
  size_t done = 0;
#if HWY_TARGET != HWY_SCALAR
  for (; streams.lanes == kRow && done + 4 <= streams.least; done += 4) {
    real r[4];
    for (size_t k = 0; k < 4; ++k) r[k] = row(rows, done + k);
    transposeQuads(r);
    for (size_t k = 0; k < 4; ++k) storeQuads(Tag(), r[k].v, streams.at.data() + k, done);
  }
#endif
  for (size_t l = 0; l < streams.lanes; ++l) {
    for (size_t i = done; i < streams.counts[l]; ++i) std::memcpy(streams.at[l] + i, rows + i * kRow + l, sizeof(float));
  }
}

/// Mask of the lanes whose strand has a vertex i.
struct Lengths {
  real counts;
  explicit Lengths(const Tile& tile) {
    std::array<float, kRow> numbers;
    for (size_t l = 0; l < kRow; ++l) numbers[l] = static_cast<float>(tile.counts[l]);
    counts = row(numbers.data(), 0);
  }
  HWY_INLINE mask has(size_t i) const { return lit(static_cast<double>(i)) < counts; }
};

/// Gathers one vector per strand.
HWY_INLINE real3 perStrand(const Tile& tile, const Vec3* values) {
  std::array<float, 3 * kRow> numbers{};
  for (size_t l = 0; l < kRow; ++l) {
    if (tile.counts[l] == 0) break;
    for (size_t c = 0; c < 3; ++c) numbers[c * kRow + l] = values[tile.first + l][static_cast<int>(c)];
  }
  return row3(numbers.data(), 0);
}

/// HeadFrame in lanes, with sums in the order of Eigen's, so that both give the same bits.
struct LaneFrame {
  real m[3][3];
  real3 position;
  explicit LaneFrame(const HeadFrame& head) {
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) m[r][c] = lit(head.rotation()(r, c));
    position = makeReal3(lit(head.position().x()), lit(head.position().y()), lit(head.position().z()));
  }
  HWY_INLINE real3 toHead(const real3& world) const {
    const real3 p = world - position;
    return makeReal3(m[0][0] * p.x + (m[1][0] * p.y + m[2][0] * p.z), m[0][1] * p.x + (m[1][1] * p.y + m[2][1] * p.z),
                     m[0][2] * p.x + (m[1][2] * p.y + m[2][2] * p.z));
  }
  HWY_INLINE real3 toWorld(const real3& p) const {
    return makeReal3(m[0][0] * p.x + (m[0][1] * p.y + m[0][2] * p.z), m[1][0] * p.x + (m[1][1] * p.y + m[1][2] * p.z),
                     m[2][0] * p.x + (m[2][1] * p.y + m[2][2] * p.z)) +
           position;
  }
};

/// Accumulates the largest squared error of each strand, vertex after vertex.
struct ErrorTracker {
  const LaneFrame& frame;
  real limit, worst;
  mask is_lost;
  ErrorTracker(const LaneFrame& of, float squared_limit, const Tile& tile, const float* before)
      : frame(of), limit(lit(squared_limit)), is_lost(maskNone()) {
    std::array<float, kRow> numbers{};
    for (size_t l = 0; l < kRow; ++l)
      if (tile.counts[l] > 0) numbers[l] = before[tile.first + l];
    worst = row(numbers.data(), 0);
  }
  HWY_INLINE void accumulate(mask is_there, const real3& decoded, const real3& wanted) {
    const real3 off = frame.toWorld(decoded) - wanted;
    const real error = off.x * off.x + (off.y * off.y + off.z * off.z);
    worst = select(is_there && worst < error, error, worst);
    is_lost = is_lost || (is_there && !(error <= limit));  // true for NaN too
  }
  void write(const Tile& tile, float* to) const {
    std::array<float, kRow> numbers;
    setRow(numbers.data(), 0, select(is_lost, lit(std::numeric_limits<float>::infinity()), worst));
    for (size_t l = 0; l < kRow; ++l)
      if (tile.counts[l] > 0) to[tile.first + l] = numbers[l];
  }
};

using Words = hn::Vec<WordTag>;
using SymbolTag = hn::Rebind<uint16_t, WordTag>;

HWY_INLINE Words symbolRow(const uint16_t* rows, size_t i) {
  return hn::PromoteTo(WordTag(), hn::LoadU(SymbolTag(), rows + i * kRow));
}
/// Stores whole numbers from -32768 to 65535 modulo 2^16.
HWY_INLINE void setSymbolRow(uint16_t* rows, size_t i, real value) {
  const Words low = hn::And(hn::ConvertTo(WordTag(), value.v), hn::Set(WordTag(), 0xffff));
  hn::StoreU(hn::DemoteTo(SymbolTag(), low), SymbolTag(), rows + i * kRow);
}
HWY_INLINE Words signedOf(Words symbols) { return hn::ShiftRight<16>(hn::ShiftLeft<16>(symbols)); }
HWY_INLINE real realOf(Words whole) { return {hn::ConvertTo(Tag(), whole)}; }

// Two 16-bit symbols in one 32-bit number, the first in the low half.
HWY_INLINE void setPairRow(float* rows, size_t i, real first, real second) {
  const Words low = hn::And(hn::ConvertTo(WordTag(), first.v), hn::Set(WordTag(), 0xffff));
  const Words high = hn::ShiftLeft<16>(hn::ConvertTo(WordTag(), second.v));
  setRow(rows, i, {hn::BitCast(Tag(), hn::Or(low, high))});
}
HWY_INLINE void pairRow(const float* rows, size_t i, real& first, real& second) {
  const Words both = hn::BitCast(WordTag(), row(rows, i).v);
  first = realOf(signedOf(both));
  second = realOf(hn::ShiftRight<16>(both));
}

HWY_INLINE void interleaveSymbols(const uint16_t* from, size_t count, uint16_t* lane) {
  for (size_t i = 0; i < count; ++i) lane[i * kRow] = from[i];
}
HWY_INLINE void deinterleaveSymbols(const uint16_t* lane, size_t count, uint16_t* to) {
  for (size_t i = 0; i < count; ++i) to[i] = lane[i * kRow];
}

/// Scratch planes for the tiles of a run.
struct Rows {
  size_t plane = 0, symbol_plane = 0;
  float* numbers = nullptr;
  uint16_t* symbols = nullptr;
  Rows(LaneRows& rows, const GuideGeometry& geometry, const StrandRun& run, size_t planes, size_t symbol_planes) {
    size_t most = 0;
    for (uint32_t s = run.first_strand; s < run.first_strand + run.strand_count; ++s)
      most = std::max<size_t>(most, geometry.offsets[s + 1] - geometry.offsets[s]);
    plane = symbol_plane = most * kRow;
    // Lanes whose strand has ended compute with stale values; their results are not used.
    if (rows.numbers.size() < planes * plane) rows.numbers.resize(planes * plane);
    if (rows.symbols.size() < symbol_planes * plane) rows.symbols.resize(symbol_planes * plane);
    numbers = rows.numbers.data();
    symbols = rows.symbols.data();
  }
};

template <class Work>
HWY_INLINE void forEachTile(const GuideGeometry& geometry, const StrandRun& run, const Work& work) {
  for (uint32_t s = 0; s < run.strand_count; s += kRow) work(Tile(geometry, run, s));
}
/// Calls work(tile, begin); begin is the tile's offset in a DirectionRows, where vertex i has row i - 1.
template <class Work>
HWY_INLINE void forEachDirectionTile(const GuideGeometry& geometry, const StrandRun& run, const Work& work) {
  size_t begin = 0;
  forEachTile(geometry, run, [&](const Tile& tile) {
    work(tile, begin);
    begin += 3 * kRow * (tile.rows - 1);
  });
}
void resizeDirections(const GuideGeometry& geometry, const StrandRun& run, DirectionRows& rows) {
  size_t size = 0;
  forEachTile(geometry, run, [&](const Tile& tile) { size += 3 * kRow * (tile.rows - 1); });
  rows.resize(size);
}

size_t edgesOf(const StrandRun& run) { return run.vertex_count - run.strand_count; }

/// Transposes the world positions of a tile into three rows per vertex.
HWY_INLINE void interleavePositions(const Tile& tile, const Vec3* positions, float* rows) {
  Streams<const float*> streams;
  for (size_t l = 0; l < tile.lanes; ++l) streams.add(positions[tile.vertices[l]].data(), 3 * tile.counts[l]);
  transposeIn(streams, rows);
}
HWY_INLINE void deinterleavePositions(const Tile& tile, const float* rows, Vec3* positions) {
  Streams<float*> streams;
  for (size_t l = 0; l < tile.lanes; ++l) streams.add(positions[tile.vertices[l]].data(), 3 * tile.counts[l]);
  draw(rows, streams);
}
/// Row i holds the length of the edge that ends at vertex i; row 0 holds no edge.
HWY_INLINE void interleaveLengths(const Tile& tile, const GuideGeometry& geometry, const StrandRun& run, float* rows) {
  Streams<const float*> streams;
  for (size_t l = 0; l < tile.lanes; ++l) streams.add(&geometry.lengths[run.first_vertex + tile.vertices[l]], tile.counts[l]);
  transposeIn(streams, rows);
}
HWY_INLINE void interleaveEdges(const Tile& tile, const uint16_t* edges, uint16_t* rows) {
  for (size_t l = 0; l < kRow; ++l)
    if (tile.counts[l] > 1) interleaveSymbols(edges + tile.edge(l), tile.counts[l] - 1, rows + kRow + l);
}
HWY_INLINE void deinterleaveEdges(const Tile& tile, const uint16_t* rows, uint16_t* edges) {
  for (size_t l = 0; l < kRow; ++l)
    if (tile.counts[l] > 1) deinterleaveSymbols(rows + kRow + l, tile.counts[l] - 1, edges + tile.edge(l));
}
/// As interleaveEdges() and deinterleaveEdges(), for pairs of symbols.
HWY_INLINE void interleavePairs(const Tile& tile, const uint16_t* edges, float* rows) {
  Streams<const float*> streams;
  for (size_t l = 0; l < tile.lanes; ++l)
    streams.add(reinterpret_cast<const float*>(edges + 2 * tile.edge(l)), tile.counts[l] - 1);
  transposeIn(streams, rows + kRow);
}
HWY_INLINE void deinterleavePairs(const Tile& tile, const float* rows, uint16_t* edges) {
  Streams<float*> streams;
  for (size_t l = 0; l < tile.lanes; ++l) streams.add(reinterpret_cast<float*>(edges + 2 * tile.edge(l)), tile.counts[l] - 1);
  draw(rows + kRow, streams);
}

// ---- delta16

void encodeDelta(const StrandEncoding& job, LaneRows& lane_rows) {
  const Rows rows(lane_rows, job.geometry, job.run, 3, 3);
  const LaneFrame frame(job.head);
  const real step = lit(job.step), per_step = lit(1 / job.step), most = lit(kMaxGridIndex);
  const size_t edges = edgesOf(job.run);
  forEachTile(job.geometry, job.run, [&](const Tile& tile) {
    interleavePositions(tile, job.positions, rows.numbers);
    const Lengths lengths(tile);
    ErrorTracker judgement(frame, job.squared_limit, tile, job.worst);
    real3 before = perStrand(tile, job.roots);
    for (size_t i = 1; i < tile.rows; ++i) {
      const real3 wanted = row3(rows.numbers, i), local = frame.toHead(wanted);
      const mask is_there = lengths.has(i);
      const real3 index = makeReal3(gridNumber(local.x * per_step, most), gridNumber(local.y * per_step, most),
                                    gridNumber(local.z * per_step, most));
      const real3 edge = index - before;
      const real low = min(edge.x, min(edge.y, edge.z)), high = max(edge.x, max(edge.y, edge.z));
      const mask fits = low >= lit(-32768) && high <= lit(32767);
      judgement.is_lost = judgement.is_lost || (is_there && !fits);
      judgement.accumulate(is_there, index * step, wanted);
      setSymbolRow(rows.symbols, i, edge.x);
      setSymbolRow(rows.symbols + rows.symbol_plane, i, edge.y);
      setSymbolRow(rows.symbols + 2 * rows.symbol_plane, i, edge.z);
      before = index;
    }
    for (size_t c = 0; c < 3; ++c) deinterleaveEdges(tile, rows.symbols + c * rows.symbol_plane, job.edges + c * edges);
    judgement.write(tile, job.worst);
  });
}

/// The decoded symbols of one plane, vertex after vertex.
struct Symbols {
  const uint16_t* rows;
  bool along;
  Words mask, before = hn::Zero(WordTag());
  HWY_INLINE Words next(size_t i) {
    Words own = symbolRow(rows, i);
    if (along) own = before = hn::And(hn::Add(own, before), mask);
    return hn::And(own, mask);
  }
};

void decodeDelta(const StrandDecoding& job, LaneRows& lane_rows) {
  const Rows rows(lane_rows, job.geometry, job.run, 3, 3);
  const LaneFrame frame(job.head);
  const real step = lit(job.step);
  const size_t edges = edgesOf(job.run);
  forEachTile(job.geometry, job.run, [&](const Tile& tile) {
    for (size_t c = 0; c < 3; ++c) interleaveEdges(tile, job.edges + c * edges, rows.symbols + c * rows.symbol_plane);
    const real3 root = perStrand(tile, job.roots);
    Words x = hn::ConvertTo(WordTag(), root.x.v), y = hn::ConvertTo(WordTag(), root.y.v), z = hn::ConvertTo(WordTag(), root.z.v);
    const Words mask = hn::Set(WordTag(), 0xffff);
    Symbols along_x{rows.symbols, job.along_strand, mask};
    Symbols along_y{rows.symbols + rows.symbol_plane, job.along_strand, mask};
    Symbols along_z{rows.symbols + 2 * rows.symbol_plane, job.along_strand, mask};
    for (size_t i = 0; i < tile.rows; ++i) {
      if (i > 0) {
        x = hn::Add(x, signedOf(along_x.next(i)));
        y = hn::Add(y, signedOf(along_y.next(i)));
        z = hn::Add(z, signedOf(along_z.next(i)));
      }
      const real3 local = makeReal3(realOf(x) * step, realOf(y) * step, realOf(z) * step);
      setRow3(rows.numbers, i, frame.toWorld(local));
    }
    deinterleavePositions(tile, rows.numbers, job.positions);
  });
}

// ---- octahedral

constexpr double kMaxSquaredEdge = 1e12;  // m^2, longer than any hair

void encodeOctahedral(const StrandEncoding& job, LaneRows& lane_rows) {
  const Rows rows(lane_rows, job.geometry, job.run, 4, 2);
  const LaneFrame frame(job.head);
  const real steps = lit((1 << job.bits) - 1);
  const size_t edges = edgesOf(job.run);
  float* const length_rows = rows.numbers + 3 * rows.plane;
  forEachTile(job.geometry, job.run, [&](const Tile& tile) {
    interleavePositions(tile, job.positions, rows.numbers);
    interleaveLengths(tile, job.geometry, job.run, length_rows);
    const Lengths lengths(tile);
    ErrorTracker judgement(frame, job.squared_limit, tile, job.worst);
    real3 before = perStrand(tile, job.roots);
    for (size_t i = 1; i < tile.rows; ++i) {
      // Aimed from the decoded vertex before, so that errors do not accumulate.
      const real3 wanted = row3(rows.numbers, i), edge = frame.toHead(wanted) - before;
      const real squared = edge.x * edge.x + (edge.y * edge.y + edge.z * edge.z);
      const mask has_direction = squared > lit(0) && squared < lit(kMaxSquaredEdge);  // false for NaN
      const OctahedralPoint nearest = toOctahedral(edge, steps);
      const OctahedralPoint point{select(has_direction, nearest.u, lit(0)), select(has_direction, nearest.v, lit(0))};
      setSymbolRow(rows.symbols, i, point.u);
      setSymbolRow(rows.symbols + rows.symbol_plane, i, point.v);
      before = before + fromOctahedral(point, steps) * row(length_rows, i);
      judgement.accumulate(lengths.has(i), before, wanted);
    }
    for (size_t c = 0; c < 2; ++c) deinterleaveEdges(tile, rows.symbols + c * rows.symbol_plane, job.edges + c * edges);
    judgement.write(tile, job.worst);
  });
}

void decodeOctahedral(const StrandDecoding& job, LaneRows& lane_rows) {
  const Rows rows(lane_rows, job.geometry, job.run, 4, 2);
  const LaneFrame frame(job.head);
  const real steps = lit((1 << job.bits) - 1);
  const size_t edges = edgesOf(job.run);
  float* const length_rows = rows.numbers + 3 * rows.plane;
  forEachTile(job.geometry, job.run, [&](const Tile& tile) {
    for (size_t c = 0; c < 2; ++c) interleaveEdges(tile, job.edges + c * edges, rows.symbols + c * rows.symbol_plane);
    interleaveLengths(tile, job.geometry, job.run, length_rows);
    const Words mask = hn::Set(WordTag(), (1 << job.bits) - 1);
    Symbols u{rows.symbols, job.along_strand, mask};
    Symbols v{rows.symbols + rows.symbol_plane, job.along_strand, mask};
    real3 at = perStrand(tile, job.roots);
    setRow3(rows.numbers, 0, frame.toWorld(at));
    for (size_t i = 1; i < tile.rows; ++i) {
      const OctahedralPoint point{realOf(u.next(i)), realOf(v.next(i))};
      at = at + fromOctahedral(point, steps) * row(length_rows, i);
      setRow3(rows.numbers, i, frame.toWorld(at));
    }
    deinterleavePositions(tile, rows.numbers, job.positions);
  });
}

// ---- tangents

void restDirections(const GuideGeometry& geometry, const StrandRun& run, DirectionRows& rows) {
  resizeDirections(geometry, run, rows);
  forEachDirectionTile(geometry, run, [&](const Tile& tile, size_t begin) {
    Streams<const float*> streams;
    for (size_t l = 0; l < tile.lanes; ++l) {
      const Vec3* const first = geometry.directions.data() + run.first_vertex + tile.vertices[l] + 1;
      streams.add(reinterpret_cast<const float*>(first), 3 * (tile.counts[l] - 1));
    }
    transposeIn(streams, rows.data() + begin);
  });
}

/// Predicts the edges of a tile from their references: docs/wire.md, "Encoding 5, tangent".
class Predictor {
 public:
  HWY_INLINE Predictor(const DirectionRows& rest, const TangentHistory* history, size_t begin)
      : last_((history ? history->last : rest).data() + begin), before_(history ? history->before().data() + begin : nullptr) {}
  HWY_INLINE real3 next(size_t i) {
    real3 reference = row3(last_, i - 1);
    if (before_) reference = unit((reference + reference) - row3(before_, i - 1));
    const real3 predicted = i == 1 ? reference : turned(reference, reference_, direction_);
    reference_ = reference;
    return predicted;
  }
  /// Records the decoded direction of the edge that was predicted.
  HWY_INLINE void update(const real3& direction) { direction_ = direction; }

 private:
  const float *last_, *before_;
  real3 reference_{}, direction_{};  // of the edge before
};

HWY_INLINE real atLeast(real a, double least) { return select(a > lit(least), a, lit(least)); }

void encodeTangents(const StrandEncoding& job, LaneRows& lane_rows) {
  const Rows rows(lane_rows, job.geometry, job.run, 5, 0);
  const LaneFrame frame(job.head);
  const real step = lit(job.step);
  float *const length_rows = rows.numbers + 3 * rows.plane, *const pair_rows = length_rows + rows.plane;
  if (job.directions) resizeDirections(job.geometry, job.run, *job.directions);
  forEachDirectionTile(job.geometry, job.run, [&](const Tile& tile, size_t begin) {
    interleavePositions(tile, job.positions, rows.numbers);
    interleaveLengths(tile, job.geometry, job.run, length_rows);
    Predictor predictor(*job.rest, job.history, begin);
    float* const directions = job.directions ? job.directions->data() + begin : nullptr;
    const Lengths lengths(tile);
    ErrorTracker judgement(frame, job.squared_limit, tile, job.worst);
    real3 at = perStrand(tile, job.roots);
    for (size_t i = 1; i < tile.rows; ++i) {
      const real3 wanted = row3(rows.numbers, i), way = frame.toHead(wanted) - at;
      const real3 predicted = predictor.next(i);
      real3 axis_u, axis_v;
      axesAcross(predicted, axis_u, axis_v);
      const real length = row(length_rows, i), long_enough = atLeast(length, kShortestCodedEdge);
      const real ahead = plainDot(way, predicted), scale = long_enough / (ahead * step);
      const real u = plainDot(way, axis_u) * scale, v = plainDot(way, axis_v) * scale;
      // Where no symbols fit (NaN included), the error is too large and the strand is sent as float32.
      const mask holds = ahead > lit(0.05f) * long_enough && abs(u) < lit(32767) && abs(v) < lit(32767);
      const real whole_u = nearestWhole(select(holds, u, lit(0))), whole_v = nearestWhole(select(holds, v, lit(0)));
      setPairRow(pair_rows, i, whole_u, whole_v);
      const real by = step / long_enough;
      const real3 direction = unit((predicted + axis_u * (whole_u * by)) + axis_v * (whole_v * by));
      at = at + direction * length;
      judgement.accumulate(lengths.has(i), at, wanted);
      predictor.update(direction);
      if (directions) setRow3(directions, i - 1, direction);
    }
    deinterleavePairs(tile, pair_rows, job.edges);
    judgement.write(tile, job.worst);
  });
}

void decodeTangents(const StrandDecoding& job, LaneRows& lane_rows) {
  const Rows rows(lane_rows, job.geometry, job.run, 5, 0);
  const LaneFrame frame(job.head);
  const real step = lit(job.step);
  float *const length_rows = rows.numbers + 3 * rows.plane, *const pair_rows = length_rows + rows.plane;
  resizeDirections(job.geometry, job.run, *job.directions);
  forEachDirectionTile(job.geometry, job.run, [&](const Tile& tile, size_t begin) {
    interleavePairs(tile, job.edges, pair_rows);
    interleaveLengths(tile, job.geometry, job.run, length_rows);
    Predictor predictor(*job.rest, job.history, begin);
    float* const directions = job.directions->data() + begin;
    real3 at = perStrand(tile, job.roots);
    setRow3(rows.numbers, 0, frame.toWorld(at));
    for (size_t i = 1; i < tile.rows; ++i) {
      const real3 predicted = predictor.next(i);
      real3 axis_u, axis_v;
      axesAcross(predicted, axis_u, axis_v);
      const real length = row(length_rows, i), by = step / atLeast(length, kShortestCodedEdge);
      real u, v;
      pairRow(pair_rows, i, u, v);
      const real3 direction = unit((predicted + axis_u * (u * by)) + axis_v * (v * by));
      at = at + direction * length;
      predictor.update(direction);
      setRow3(rows.numbers, i, frame.toWorld(at));
      setRow3(directions, i - 1, direction);
    }
    deinterleavePositions(tile, rows.numbers, job.positions);
  });
}
