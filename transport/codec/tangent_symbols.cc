#include "transport/codec/tangent_symbols.h"

#include <algorithm>
#include <bit>
#include <cstdlib>

#include "transport/codec/bit_stream.h"

namespace strandcast {
namespace {

/// As if before the first edge of the first strand.
constexpr uint32_t kFirstSize = 4;

uint32_t sizeOf(uint16_t symbol) {
  return static_cast<uint32_t>(std::abs(static_cast<int>(static_cast<int16_t>(symbol))));
}

/// `size` of two symbols is expected.
int parameterFor(uint32_t size) { return std::bit_width(size >> 1); }

/// Goes through all symbols in the order of the wire: code(symbol, k).
template <class Symbols, class Code>
void codeAll(Symbols& symbols, std::span<const uint32_t> strand_ends, const TangentSizes& before,
             TangentSizes& sizes, const Code& code) {
  const size_t strands = strand_ends.size(), edges = symbols.edges.size() / 2;
  uint32_t size = 0;  // of the root before
  for (size_t s = 0; s < strands; ++s) {
    const int k = parameterFor(size / 2);
    size = 0;
    for (size_t c = 0; c < 3; ++c) {
      code(symbols.roots[c * strands + s], k);
      size += sizeOf(symbols.roots[c * strands + s]);
    }
  }
  sizes.resize(edges);
  uint32_t first_size = kFirstSize;  // of the first edge of the strand before
  size_t e = 0;
  for (const uint32_t end : strand_ends) {
    size = first_size;
    for (const size_t first = e; e < end; ++e) {
      const int k = parameterFor(before.empty() ? size : (size + before[e]) / 2);
      code(symbols.edges[e], k);
      code(symbols.edges[edges + e], k);
      size = std::min(sizeOf(symbols.edges[e]) + sizeOf(symbols.edges[edges + e]), 65535u);
      sizes[e] = static_cast<uint16_t>(size);
      if (e == first) first_size = size;
    }
  }
}

}  // namespace

void packTangents(const GuideSymbols& symbols, std::span<const uint32_t> strand_ends,
                  const TangentSizes& before, TangentSizes& sizes, std::vector<uint8_t>& bytes) {
  RiceWriter writer(bytes);
  codeAll(symbols, strand_ends, before, sizes, [&](uint16_t symbol, int k) { writer.put(symbol, k); });
  writer.finish();
}

bool unpackTangents(std::span<const uint8_t> bytes, std::span<const uint32_t> strand_ends,
                    const TangentSizes& before, TangentSizes& sizes, GuideSymbols& symbols) {
  RiceReader reader(bytes);
  codeAll(symbols, strand_ends, before, sizes, [&](uint16_t& symbol, int k) { symbol = reader.get(k); });
  return reader.isAtEnd();
}

}  // namespace strandcast
