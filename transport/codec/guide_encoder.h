#pragma once
#include <vector>

#include "transport/chunks.h"
#include "transport/codec/codec.h"
#include "transport/codec/guide_payload.h"
#include "transport/codec/strand_coder.h"
#include "transport/codec/symbol_packer.h"

namespace strandcast {

/// Writes the guides of one groom into chunks. Memory is that of the largest chunk, of the groom's rest shape
/// and, for kTemporal, of two frames; encode() does not allocate once it has seen a frame or two.
class GuideEncoder {
 public:
  /// `options` as checkCodecOptions accepts them. Any `coder` writes the same bytes.
  explicit GuideEncoder(const CodecOptions& options, const StrandCoder& coder = strandCoder())
      : options_(options), coder_(coder), packer_(coder) {}
  /// `guides` of a checked announcement.
  void setGroom(const StrandSet& guides);
  /// One chunk each; a frame is these in order.
  const std::vector<StrandRun>& runs() const { return runs_; }
  /// Chunk `index` of `frame`, header and payload, into `chunk`, whose memory is used again. The frame has
  /// the positions of all runs and a head pose with a unit quaternion.
  void encode(const GuideFrame& frame, uint32_t index, GuideChunk& chunk);
  /// Of the chunks of the newest frame number that encode() was given.
  const EncodingReport& report() const { return report_; }

 private:
  void encodeTangents(const GuideFrame& frame, const StrandRun& run, uint32_t index, GuideChunk& chunk);
  void quantize(const GuideFrame& frame, const StrandRun& run, Encoding encoding,
                const TangentHistory* history);
  void quantizeRoots(const GuideFrame& frame, const StrandRun& run, const HeadFrame& head, Encoding encoding);
  void forgetExactStrands(const StrandRun& run);
  void packTangents(const TangentHistory* history, std::vector<uint8_t>& bytes);
  void writePreamble(const GuideFrame& frame, const StrandRun& run, uint8_t mode, float step,
                     std::vector<uint8_t>& bytes) const;
  void writeSymbols(const GuideFrame& frame, const StrandRun& run, GuideChunk& chunk);

  CodecOptions options_;
  StrandCoder coder_;
  GuideGeometry geometry_;
  std::vector<StrandRun> runs_;
  std::vector<TangentHistory> histories_;  // per run; kTemporal only
  EncodingReport report_;
  uint64_t reported_frame_ = 0;
  // Of the chunk under way.
  float squared_limit_ = 0;  // m^2
  float step_ = 0;           // m, of the grid
  float tangent_step_ = 0;   // m
  GuideSymbols symbols_;
  std::vector<uint32_t> strand_ends_;
  std::vector<uint16_t> exact_;  // strands of the run that are sent as they are
  float worst_squared_ = 0;      // m^2, of the others
  SymbolPacker packer_;
  LaneRows rows_;
  std::vector<Vec3> roots_;       // per strand: StrandEncoding::roots
  std::vector<float> worst_;      // per strand: StrandEncoding::worst
  std::vector<Vec3> directions_;  // per edge; kTemporal only
  TangentSizes sizes_;
};

}  // namespace strandcast
