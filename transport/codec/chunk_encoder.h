#pragma once
#include <vector>

#include "transport/chunks.h"
#include "transport/codec/codec.h"
#include "transport/codec/guide_payload.h"
#include "transport/codec/strand_coder.h"
#include "transport/codec/symbol_packer.h"

namespace strandcast {

/// State that all chunks of a groom's frames share.
struct EncodedGroom {
  CodecOptions options;
  GuideGeometry geometry;
  std::vector<StrandRun> runs;            ///< one per chunk
  std::vector<DirectionRows> rests;       ///< per run; empty until they are needed
  std::vector<TangentHistory> histories;  ///< per run; kTemporal only
};

/// As EncodingReport, of one chunk.
struct ChunkReport {
  uint64_t strands_sent_finer = 0;
  double worst_error = 0;  ///< m, of the other strands
};

/// Encodes the guides of a run into a chunk. Several encoders may work on one groom at the same time, each on
/// another chunk. Memory: that of the largest chunk.
class ChunkEncoder {
 public:
  /// `groom` must outlive it and its options must not change. Every `coder` writes the same bytes.
  ChunkEncoder(EncodedGroom& groom, const StrandCoder& coder);
  /// As GuideEncoder::encode.
  ChunkReport encode(const GuideFrame& frame, uint32_t index, GuideChunk& chunk);

 private:
  void encodeTangents(const GuideFrame& frame, uint32_t index, GuideChunk& chunk);
  void quantize(const GuideFrame& frame, uint32_t index, Encoding encoding, const TangentHistory* history);
  void quantizeRoots(const GuideFrame& frame, const StrandRun& run, const HeadFrame& head, Encoding encoding);
  void findStrandEnds(const StrandRun& run);
  void forgetExactStrands(const StrandRun& run);
  void writePreamble(const GuideFrame& frame, const StrandRun& run, uint8_t mode, float step,
                     std::vector<uint8_t>& bytes) const;
  void writeSymbols(const GuideFrame& frame, const StrandRun& run, GuideChunk& chunk);

  EncodedGroom* groom_;
  float squared_limit_;  // m^2
  float step_;           // m, of the grid of positions
  float tangent_step_;   // m, of the tangent plane's grid
  StrandCoder coder_;
  // Of the current chunk:
  GuideSymbols symbols_;
  std::vector<uint32_t> strand_ends_;  // SymbolPrediction::strand_ends; not of tangents
  std::vector<uint16_t> exact_;        // strands of the run that are sent as float32
  float worst_squared_ = 0;            // m^2, of the other strands
  SymbolPacker packer_;
  LaneRows rows_;
  std::vector<Vec3> roots_;   // per strand: StrandEncoding::roots
  std::vector<float> worst_;  // per strand: StrandEncoding::worst
  DirectionRows directions_;  // kTemporal only
};

}  // namespace strandcast
