#pragma once
#include <map>
#include <span>
#include <vector>

#include "transport/chunks.h"
#include "transport/codec/guide_payload.h"
#include "transport/codec/strand_coder.h"
#include "transport/codec/symbol_packer.h"

namespace strandcast {

/// Outcome of decoding a payload.
enum class DecodeResult {
  kDone,
  kDamaged,
  kNoKey  ///< no fault was found, but it builds on a frame that is not the newest decoded here
};

/// Decodes the payloads of chunks. The payload is not trusted: memory and work are bounded by the groom (each
/// strand counted as long as the longest beside it in the lanes) and by the bytes received. Chunks that build
/// on others must come in the order in which they were encoded.
class GuideDecoder {
 public:
  /// Every `coder` decodes the same positions.
  explicit GuideDecoder(const StrandCoder& coder = strandCoder()) : coder_(coder), unpacker_(coder) {}
  /// Precondition: an assembler made `guides`, or checkAnnouncement() accepted them.
  void setGroom(const StrandSet& guides);
  /// Writes the world positions (m, finite) of the chunk's vertices to `positions`, which holds
  /// chunk.vertex_count. Precondition: the header is valid, that is, the run lies within the groom and the
  /// head's rotation is of unit length. The content of `positions` is unspecified unless the result is kDone.
  DecodeResult decode(const GuideChunk& chunk, std::span<Vec3> positions);

 private:
  struct Memory {
    uint32_t strand_count = 0;
    DirectionRows rest;
    TangentHistory history;
  };
  /// The part of a payload before its symbols, in every encoding but kFloat32.
  struct Preamble {
    uint8_t mode = 0;
    float step = 0;                            // m
    std::vector<uint16_t> exact;               // strands of the run that are sent as float32, ascending
    std::span<const uint8_t> exact_positions;  // float32
    std::span<const uint8_t> symbols;
  };
  bool readPreamble(const GuideChunk& chunk, const StrandRun& run);
  DecodeResult decodeSymbols(const GuideChunk& chunk, const StrandRun& run, std::span<Vec3> positions);
  DecodeResult decodeTangents(const GuideChunk& chunk, const StrandRun& run, std::span<Vec3> positions);
  /// Converts symbols to positions.
  void placeStrands(const GuideChunk& chunk, const StrandRun& run, const DirectionRows* rest,
                    const TangentHistory* history, std::span<Vec3> positions);
  void placeRoots(const StrandRun& run, Encoding encoding);
  Memory& resetHistory(const StrandRun& run);

  StrandCoder coder_;
  GuideGeometry geometry_;
  std::map<uint32_t, Memory> histories_;  // by first strand
  uint64_t history_strands_ = 0;
  Preamble preamble_;
  GuideSymbols symbols_;
  SymbolUnpacker unpacker_;
  LaneRows rows_;
  // Of the current chunk:
  std::vector<Vec3> roots_;  // per strand: StrandDecoding::roots
  DirectionRows directions_;
  DirectionRows rest_;  // of a run that has no entry in histories_
};

}  // namespace strandcast
