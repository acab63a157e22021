// Tiles: strands side by side, one per lane. Included inside a target's namespace after kernels/lanes_highway.inl.

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
      : frame(of), limit(lit(squared_limit)), is_lost(lit(1) < lit(0)) {
    std::array<float, kRow> numbers{};
    for (size_t l = 0; l < kRow; ++l)
      if (tile.counts[l] > 0) numbers[l] = before[tile.first + l];
    worst = row(numbers.data(), 0);
  }
  HWY_INLINE void look(mask is_there, const real3& decoded, const real3& wanted) {
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

HWY_INLINE void pourSymbols(const uint16_t* from, size_t count, uint16_t* lane) {
  for (size_t i = 0; i < count; ++i) lane[i * kRow] = from[i];
}
HWY_INLINE void drawSymbols(const uint16_t* lane, size_t count, uint16_t* to) {
  for (size_t i = 0; i < count; ++i) to[i] = lane[i * kRow];
}
