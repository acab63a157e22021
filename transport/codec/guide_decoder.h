#pragma once
#include <map>
#include <span>
#include <vector>

#include "transport/chunks.h"
#include "transport/codec/guide_payload.h"
#include "transport/codec/guide_symbols.h"

namespace strandcast {

enum class DecodeResult {
  kDone,
  kDamaged,
  kNoKey  ///< sound as far as can be told, but the key frame that it refers to is not here
};

/// Reads the payloads of chunks. Nothing in a payload is believed: memory and work are bounded by the groom
/// and by what was received.
class GuideDecoder {
 public:
  /// `guides` as an assembler or a checked announcement made them.
  void setGroom(const StrandSet& guides);
  /// World positions of the chunk's vertices into `positions`, finite, as many as the chunk's vertex_count.
  /// The header is sound: the run lies within the groom and the head's rotation is of unit length.
  /// `positions` is arbitrary unless it is kDone.
  DecodeResult decode(const GuideChunk& chunk, std::span<Vec3> positions);

 private:
  struct Key {
    uint64_t frame = 0;
    Encoding encoding = Encoding::kFloat32;
    StrandRun run;
    GuideSymbols symbols;
  };
  DecodeResult decodeSymbols(const GuideChunk& chunk, const StrandRun& run, std::span<Vec3> positions);
  void rebuild(const Pose& head, const StrandRun& run, Encoding encoding, float step,
               std::span<Vec3> positions) const;
  void keep(const GuideChunk& chunk, const StrandRun& run);

  GuideGeometry geometry_;
  std::map<uint32_t, Key> keys_;  // by first strand
  uint64_t kept_strands_ = 0;
  GuideSymbols symbols_;
  std::vector<uint32_t> strand_ends_;
  SymbolUnpacker unpacker_;
};

}  // namespace strandcast
