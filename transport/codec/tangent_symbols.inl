// Symbols of encoding 4 (docs/wire.md) and their bits: small signed numbers whose size is much like that of
// their neighbours', along the strand and in the frame before. Each has a Rice code (bit_stream.h) whose
// parameter follows from these, so that a chunk needs no tables and decodes alone.

/// As if before the first edge of the first strand.
constexpr uint32_t kFirstSize = 4;

/// `size` of two symbols is expected.
HWY_INLINE int parameterFor(uint32_t size) { return std::bit_width(size >> 1); }

/// Goes through all symbols in the order of the wire: root(symbol, k) gives a symbol's size, edge(e, k) that
/// of an edge's two. `before`: sizes of the edges in the frame that this one builds on, or null.
template <class Root, class Edge>
HWY_INLINE void codeAll(size_t strands, std::span<const uint32_t> strand_ends, const uint16_t* before,
                        uint16_t* sizes, const Root& root, const Edge& edge) {
  uint32_t size = 0;  // of the root before
  for (size_t s = 0; s < strands; ++s) {
    const int k = parameterFor(size / 2);
    size = 0;
    for (size_t c = 0; c < 3; ++c) size += root(c * strands + s, k);
  }
  uint32_t first_size = kFirstSize;  // of the first edge of the strand before
  size_t e = 0;
  for (const uint32_t end : strand_ends) {
    size = first_size;
    for (const size_t first = e; e < end; ++e) {
      size = std::min(edge(e, parameterFor(before ? (size + before[e]) / 2 : size)), 65535u);
      sizes[e] = static_cast<uint16_t>(size);
      if (e == first) first_size = size;
    }
  }
}

const uint8_t* packTangents(const GuideSymbols& symbols, std::span<const uint32_t> strand_ends,
                            const uint16_t* before, uint16_t* sizes, uint8_t* to) {
  RiceWriter writer(to);
  const uint16_t *const u = symbols.edges.data(), *const v = u + symbols.edges.size() / 2;
  codeAll(
      strand_ends.size(), strand_ends, before, sizes,
      [&](size_t i, int k) {
        const uint32_t z = riceFolded(symbols.roots[i]);
        writer.put(z, k);
        return riceSize(z);
      },
      [&](size_t e, int k) {
        const uint32_t a = riceFolded(u[e]), b = riceFolded(v[e]);
        writer.put(a, b, k);
        return riceSize(a) + riceSize(b);
      });
  return writer.finish();
}

bool unpackTangents(std::span<const uint8_t> bytes, std::span<const uint32_t> strand_ends,
                    const uint16_t* before, uint16_t* sizes, GuideSymbols& symbols) {
  RiceReader reader(bytes);
  uint16_t *const u = symbols.edges.data(), *const v = u + symbols.edges.size() / 2;
  codeAll(
      strand_ends.size(), strand_ends, before, sizes,
      [&](size_t i, int k) {
        const uint32_t z = reader.get(k);
        symbols.roots[i] = riceUnfolded(z);
        return riceSize(z);
      },
      [&](size_t e, int k) {
        uint32_t a, b;
        reader.get(k, a, b);
        u[e] = riceUnfolded(a);
        v[e] = riceUnfolded(b);
        return riceSize(a) + riceSize(b);
      });
  return reader.isAtEnd();
}
