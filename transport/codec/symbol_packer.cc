#include "transport/codec/symbol_packer.h"

#include <bit>
#include <cstring>

#include "transport/codec/bit_blocks.h"

namespace strandcast {
namespace {

/// Higher levels take several times as long for a few percent. Residuals rarely repeat, so that searching for
/// matches gains little: only long ones, in a small table.
constexpr int kLevel = 1, kShortestMatch = 7, kTableLog = 8;

/// Bits of the residuals of some edges of a strand.
uint64_t bitsOf(std::span<const uint16_t> edges, bool along, int bits) {
  uint64_t sum = 0;
  uint16_t before = 0;
  for (const uint16_t own : edges) {
    const auto residual = static_cast<uint16_t>(along ? own - before : own);
    sum += static_cast<uint64_t>(std::bit_width(zigzag(signExtended(residual, bits))));
    before = own;
  }
  return sum;
}

/// Writes the length that precedes a section.
void putLength(size_t length, uint8_t* to) {
  const auto value = static_cast<uint32_t>(length);
  std::memcpy(to, &value, sizeof value);
}

}  // namespace

SymbolPacker::SymbolPacker(const StrandCoder& coder)
    : pack_(coder.pack), subtract_(coder.subtract), fold_(coder.fold), context_(ZSTD_createCCtx()) {
  // The content size is not stored: the receiver knows it.
  ZSTD_CCtx_setParameter(context_.get(), ZSTD_c_compressionLevel, kLevel);
  ZSTD_CCtx_setParameter(context_.get(), ZSTD_c_minMatch, kShortestMatch);
  ZSTD_CCtx_setParameter(context_.get(), ZSTD_c_hashLog, kTableLog);
  ZSTD_CCtx_setParameter(context_.get(), ZSTD_c_contentSizeFlag, 0);
}

bool SymbolPacker::prefersAlongStrand(const GuideSymbols& symbols, const SymbolPrediction& prediction) {
  // Every 16th strand is a sufficient sample.
  constexpr size_t kSampleEvery = 16;
  const size_t count = symbols.edges.size() / static_cast<size_t>(symbols.edge_planes);
  uint64_t bits[2] = {};
  for (size_t s = 0; s < prediction.strand_ends.size(); s += kSampleEvery) {
    const size_t first = s == 0 ? 0 : prediction.strand_ends[s - 1];
    const size_t length = prediction.strand_ends[s] - first;
    for (const bool along : {false, true}) {
      for (size_t at = first; at < symbols.edges.size(); at += count)
        bits[along ? 1 : 0] += bitsOf({symbols.edges.data() + at, length}, along, prediction.edge_bits);
    }
  }
  return bits[1] < bits[0];
}

std::span<const uint16_t> SymbolPacker::residualsOf(const GuideSymbols& symbols,
                                                    const SymbolPrediction& prediction) {
  if (!prediction.along_strand && prediction.edge_bits == 16) return symbols.edges;
  const size_t count = symbols.edges.size() / static_cast<size_t>(symbols.edge_planes);
  const int bits = prediction.edge_bits;
  residuals_.resize(symbols.edges.size());
  for (size_t at = 0; at < symbols.edges.size(); at += count) {
    const uint16_t* const plane = symbols.edges.data() + at;
    uint16_t* const residuals = residuals_.data() + at;
    subtract_(plane, count, prediction.along_strand, bits, residuals);
    if (!prediction.along_strand) continue;
    // The first edge of a strand has no predecessor.
    for (const uint32_t first : prediction.strand_ends)
      if (first < count) subtract_(plane + first, 1, false, bits, residuals + first);
  }
  return residuals_;
}

void SymbolPacker::packInBlocks(const GuideSymbols& symbols, const SymbolPrediction& prediction,
                                std::vector<uint8_t>& bytes) {
  const std::span<const uint16_t> edges = residualsOf(symbols, prediction);
  const size_t begin = bytes.size();
  bytes.resize(begin + maxPackedBytes(symbols.roots.size()) + maxPackedBytes(edges.size()));
  const uint8_t* const end = pack_(edges, pack_(symbols.roots, bytes.data() + begin));
  bytes.resize(static_cast<size_t>(end - bytes.data()));
}

void SymbolPacker::compress(const GuideSymbols& symbols, const SymbolPrediction& prediction,
                            std::vector<uint8_t>& bytes) {
  const std::span<const uint16_t> edges = residualsOf(symbols, prediction);
  const size_t roots = symbols.roots.size(), count = roots + edges.size();
  low_.resize(count);
  high_.resize(count);
  fold_(symbols.roots.data(), roots, low_.data(), high_.data());
  fold_(edges.data(), edges.size(), low_.data() + roots, high_.data() + roots);
  for (const std::vector<uint8_t>* plane : {&low_, &high_}) {
    const size_t start = bytes.size();
    bytes.resize(start + 4 + ZSTD_compressBound(count));
    const size_t length = ZSTD_compress2(context_.get(), bytes.data() + start + 4, bytes.size() - start - 4,
                                         plane->data(), count);
    putLength(length, bytes.data() + start);
    bytes.resize(start + 4 + length);
  }
}

SymbolUnpacker::SymbolUnpacker(const StrandCoder& coder)
    : unpack_(coder.unpack), unfold_(coder.unfold), context_(ZSTD_createDCtx()) {}

bool SymbolUnpacker::unpackBlocks(std::span<const uint8_t> bytes, GuideSymbols& symbols) const {
  return unpack_(bytes, symbols.roots) && unpack_(bytes, symbols.edges) && bytes.empty();
}

bool SymbolUnpacker::decompress(std::span<const uint8_t> bytes, GuideSymbols& symbols) {
  const size_t roots = symbols.roots.size(), count = roots + symbols.edges.size();
  for (std::vector<uint8_t>* plane : {&low_, &high_}) {
    uint32_t length = 0;
    if (bytes.size() < sizeof length) return false;
    std::memcpy(&length, bytes.data(), sizeof length);
    bytes = bytes.subspan(sizeof length);
    if (length > bytes.size()) return false;
    plane->resize(count);
    // Never writes beyond the capacity; error codes exceed any count.
    if (ZSTD_decompressDCtx(context_.get(), plane->data(), count, bytes.data(), length) != count)
      return false;
    bytes = bytes.subspan(length);
  }
  if (!bytes.empty()) return false;
  unfold_(low_.data(), high_.data(), roots, symbols.roots.data());
  unfold_(low_.data() + roots, high_.data() + roots, symbols.edges.size(), symbols.edges.data());
  return true;
}

}  // namespace strandcast
