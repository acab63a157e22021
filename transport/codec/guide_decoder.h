#pragma once
#include <map>
#include <span>
#include <vector>

#include "transport/chunks.h"
#include "transport/codec/guide_payload.h"
#include "transport/codec/strand_coder.h"
#include "transport/codec/symbol_packer.h"

namespace strandcast {

enum class DecodeResult {
  kDone,
  kDamaged,
  kNoKey  ///< sound as far as can be told, but it builds on a frame that is not the last one here
};

/// Reads the payloads of chunks. Nothing in a payload is believed: memory and work are bounded by the groom
/// (whose strands are as long as the longest of those beside them) and by what was received. Chunks that
/// build on others come in the order in which they were encoded.
class GuideDecoder {
 public:
  /// Any `coder` reads the same positions.
  explicit GuideDecoder(const StrandCoder& coder = strandCoder()) : coder_(coder), unpacker_(coder) {}
  /// `guides` as an assembler or a checked announcement made them.
  void setGroom(const StrandSet& guides);
  /// World positions of the chunk's vertices into `positions`, finite, as many as the chunk's vertex_count.
  /// The header is sound: the run lies within the groom and the head's rotation is of unit length.
  /// `positions` is arbitrary unless it is kDone.
  DecodeResult decode(const GuideChunk& chunk, std::span<Vec3> positions);

 private:
  struct Memory {
    uint32_t strand_count = 0;
    DirectionRows rest;
    TangentHistory history;
  };
  /// What stands before the symbols of every encoding but kFloat32.
  struct Preamble {
    uint8_t mode = 0;
    float step = 0;                            // m
    std::vector<uint16_t> exact;               // strands of the run that are sent as they are, ascending
    std::span<const uint8_t> exact_positions;  // float32
    std::span<const uint8_t> symbols;
  };
  bool readPreamble(const GuideChunk& chunk, const StrandRun& run);
  DecodeResult decodeSymbols(const GuideChunk& chunk, const StrandRun& run, std::span<Vec3> positions);
  DecodeResult decodeTangents(const GuideChunk& chunk, const StrandRun& run, std::span<Vec3> positions);
  /// From symbols to positions.
  void placeStrands(const GuideChunk& chunk, const StrandRun& run, const DirectionRows* rest,
                    const TangentHistory* history, std::span<Vec3> positions);
  void placeRoots(const StrandRun& run, Encoding encoding);
  Memory& remember(const StrandRun& run);

  StrandCoder coder_;
  GuideGeometry geometry_;
  std::map<uint32_t, Memory> memories_;  // by first strand
  uint64_t remembered_strands_ = 0;
  Preamble preamble_;
  GuideSymbols symbols_;
  SymbolUnpacker unpacker_;
  LaneRows rows_;
  // Of the chunk under way:
  std::vector<Vec3> roots_;  // per strand: StrandDecoding::roots
  DirectionRows directions_;
  DirectionRows rest_;  // of a run that is not remembered
};

}  // namespace strandcast
