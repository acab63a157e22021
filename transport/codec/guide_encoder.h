#pragma once
#include <functional>
#include <memory>
#include <vector>

#include "transport/codec/chunk_encoder.h"

namespace strandcast {

/// Writes the guides of one groom into chunks. Memory is that of the groom's rest shape, for kTemporal of two
/// frames, and of two chunks for each thread that encodes.
class GuideEncoder {
 public:
  /// `options` as checkCodecOptions accepts them. Any `coder` writes the same bytes.
  explicit GuideEncoder(const CodecOptions& options, const StrandCoder& coder = strandCoder());
  ~GuideEncoder();
  GuideEncoder(const GuideEncoder&) = delete;
  GuideEncoder& operator=(const GuideEncoder&) = delete;

  /// `guides` of a checked announcement.
  void setGroom(const StrandSet& guides);
  /// One chunk each; a frame is these in order.
  const std::vector<StrandRun>& runs() const { return groom_.runs; }
  /// Chunk `index` of `frame`, header and payload, into `chunk`, whose memory is used again. The frame has
  /// the positions of all runs and a head pose with a unit quaternion. Does not allocate once it has seen a
  /// frame or two.
  void encode(const GuideFrame& frame, uint32_t index, GuideChunk& chunk);
  /// All chunks of `frame`, encoded on as many threads as the options say: send(chunk) for one after another
  /// in order, on this thread, while others are still encoded. It may exchange the chunk's memory; what it
  /// throws comes out of here.
  void encodeAll(const GuideFrame& frame, const std::function<void(GuideChunk&)>& send);
  /// Of the chunks of the newest frame number that was encoded.
  const EncodingReport& report() const { return report_; }

 private:
  class Crew;
  void add(const GuideFrame& frame, const GuideChunk& chunk, const ChunkReport& report);

  EncodedGroom groom_;
  const StrandCoder coder_;
  const int threads_;
  ChunkEncoder own_;  // for what one thread encodes
  GuideChunk own_chunk_;
  std::unique_ptr<Crew> crew_;
  EncodingReport report_;
  uint64_t reported_frame_ = 0;
};

}  // namespace strandcast
