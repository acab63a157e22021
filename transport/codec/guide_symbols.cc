#include "transport/codec/guide_symbols.h"

#include <bit>
#include <cstring>

namespace strandcast {
namespace {

constexpr int kLevel = 1;  // higher ones take several times as long for a few percent

/// Small for small residuals of either sign; `residual` modulo 2^bits.
uint16_t zigzag(uint32_t residual, int bits) {
  const auto extended = static_cast<int32_t>(residual << (32 - bits)) >> (32 - bits);
  return static_cast<uint16_t>((extended << 1 ^ extended >> 31) & ((1 << bits) - 1));
}

uint32_t unfolded(uint32_t folded) { return folded >> 1 ^ (0u - (folded & 1u)); }

/// The residuals of one plane: `store(i, folded)`.
template <class Store>
void predictPlane(std::span<const uint16_t> plane, bool along, int bits,
                  std::span<const uint32_t> strand_ends, Store&& store) {
  size_t i = 0;
  for (const uint32_t end : strand_ends) {
    uint32_t before = 0;
    for (; i < end; ++i) {
      const uint32_t own = plane[i];
      store(i, zigzag(along ? own - before : own, bits));
      before = own;
    }
  }
}

void restorePlane(std::span<uint16_t> plane, bool along, int bits, std::span<const uint32_t> strand_ends) {
  const uint32_t mask = (1u << bits) - 1;
  size_t i = 0;
  for (const uint32_t end : strand_ends) {
    uint32_t before = 0;
    for (; i < end; ++i) {
      const uint32_t own = unfolded(plane[i]) + (along ? before : 0u);
      before = own;
      plane[i] = static_cast<uint16_t>(own & mask);
    }
  }
}

template <class Store>
void predictEdges(const GuideSymbols& symbols, const SymbolPrediction& prediction, Store&& store) {
  const size_t count = symbols.edges.size() / static_cast<size_t>(symbols.edge_planes);
  for (size_t at = 0; at < symbols.edges.size(); at += count) {
    predictPlane({symbols.edges.data() + at, count}, prediction.along_strand, prediction.edge_bits,
                 prediction.strand_ends, [&](size_t i, uint16_t folded) { store(at + i, folded); });
  }
}

/// A section's length in front of it.
void putLength(size_t length, uint8_t* to) {
  const auto value = static_cast<uint32_t>(length);
  std::memcpy(to, &value, sizeof value);
}

}  // namespace

SymbolPacker::SymbolPacker() : context_(ZSTD_createCCtx()) {
  // The receiver knows what comes out.
  ZSTD_CCtx_setParameter(context_.get(), ZSTD_c_compressionLevel, kLevel);
  ZSTD_CCtx_setParameter(context_.get(), ZSTD_c_contentSizeFlag, 0);
}

bool SymbolPacker::prefersAlongStrand(const GuideSymbols& symbols, const SymbolPrediction& prediction) {
  // A few strands of one plane tell as much as all of them.
  constexpr size_t kSampleEvery = 8;
  const size_t count = symbols.edges.size() / static_cast<size_t>(symbols.edge_planes);
  uint64_t bits[2] = {};
  for (size_t s = 0; s < prediction.strand_ends.size(); s += kSampleEvery) {
    const size_t first = s == 0 ? 0 : prediction.strand_ends[s - 1];
    const uint32_t length[] = {static_cast<uint32_t>(prediction.strand_ends[s] - first)};
    for (const bool along : {false, true}) {
      for (size_t at = first; at < symbols.edges.size(); at += count) {
        predictPlane({symbols.edges.data() + at, length[0]}, along, prediction.edge_bits, length,
                     [&](size_t, uint16_t folded) {
                       bits[along ? 1 : 0] += static_cast<uint64_t>(std::bit_width(folded));
                     });
      }
    }
  }
  return bits[1] < bits[0];
}

void SymbolPacker::pack(const GuideSymbols& symbols, const SymbolPrediction& prediction,
                        std::vector<uint8_t>& bytes) {
  const size_t roots = symbols.roots.size(), count = roots + symbols.edges.size();
  residuals_.resize(count);
  for (size_t i = 0; i < roots; ++i) {
    residuals_[i] = zigzag(symbols.roots[i], 16);
  }
  predictEdges(symbols, prediction, [&](size_t i, uint16_t folded) { residuals_[roots + i] = folded; });
  plane_.resize(count);
  for (const int shift : {0, 8}) {
    for (size_t i = 0; i < count; ++i) plane_[i] = static_cast<uint8_t>(residuals_[i] >> shift);
    const size_t start = bytes.size();
    bytes.resize(start + 4 + ZSTD_compressBound(count));
    const size_t length = ZSTD_compress2(context_.get(), bytes.data() + start + 4, bytes.size() - start - 4,
                                         plane_.data(), count);
    putLength(length, bytes.data() + start);
    bytes.resize(start + 4 + length);
  }
}

SymbolUnpacker::SymbolUnpacker() : context_(ZSTD_createDCtx()) {}

bool SymbolUnpacker::unpack(std::span<const uint8_t> bytes, const SymbolPrediction& prediction,
                            GuideSymbols& symbols) {
  const size_t roots = symbols.roots.size(), count = roots + symbols.edges.size();
  for (std::vector<uint8_t>* plane : {&low_, &high_}) {
    uint32_t length = 0;
    if (bytes.size() < sizeof length) return false;
    std::memcpy(&length, bytes.data(), sizeof length);
    bytes = bytes.subspan(sizeof length);
    if (length > bytes.size()) return false;
    plane->resize(count);
    // Never writes more than there is room for; an error code is larger than any count.
    if (ZSTD_decompressDCtx(context_.get(), plane->data(), count, bytes.data(), length) != count)
      return false;
    bytes = bytes.subspan(length);
  }
  if (!bytes.empty()) return false;
  const auto folded = [&](size_t i) { return static_cast<uint16_t>(low_[i] | high_[i] << 8); };
  for (size_t i = 0; i < roots; ++i) {
    symbols.roots[i] = static_cast<uint16_t>(unfolded(folded(i)));
  }
  for (size_t i = 0; i < symbols.edges.size(); ++i) symbols.edges[i] = folded(roots + i);
  const size_t edges = symbols.edges.size() / static_cast<size_t>(symbols.edge_planes);
  for (size_t at = 0; at < symbols.edges.size(); at += edges) {
    restorePlane({symbols.edges.data() + at, edges}, prediction.along_strand, prediction.edge_bits,
                 prediction.strand_ends);
  }
  return true;
}

}  // namespace strandcast
