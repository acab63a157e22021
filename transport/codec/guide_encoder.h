#pragma once
#include <functional>
#include <memory>
#include <vector>

#include "transport/codec/chunk_encoder.h"

namespace strandcast {

/// Encodes the guides of one groom into chunks. Memory: that of the groom's rest shape, of two frames for
/// kTemporal, and of two chunks for each encoding thread.
class GuideEncoder {
 public:
  /// Precondition: checkCodecOptions() accepts `options`. Every `coder` writes the same bytes.
  explicit GuideEncoder(const CodecOptions& options, const StrandCoder& coder = strandCoder());
  ~GuideEncoder();
  GuideEncoder(const GuideEncoder&) = delete;
  GuideEncoder& operator=(const GuideEncoder&) = delete;

  /// Precondition: checkAnnouncement() accepted `guides`.
  void setGroom(const StrandSet& guides);
  /// One run per chunk; a frame is these chunks in order.
  const std::vector<StrandRun>& runs() const { return groom_.runs; }
  /// Encodes chunk `index` of `frame`, header and payload, into `chunk`, whose memory is reused.
  /// Precondition: the frame has the positions of all runs and a head pose with a unit quaternion. Allocates
  /// only in the first frames.
  void encode(const GuideFrame& frame, uint32_t index, GuideChunk& chunk);
  /// Encodes all chunks of `frame` on as many threads as the options say. Calls send(chunk) for each chunk in
  /// order on this thread, while later chunks are still encoded. `send` may swap the chunk's memory; its
  /// exceptions propagate.
  void encodeAll(const GuideFrame& frame, const std::function<void(GuideChunk&)>& send);
  /// Of the encoded chunks of the newest frame number.
  const EncodingReport& report() const { return report_; }

 private:
  class EncoderPool;
  void add(const GuideFrame& frame, const GuideChunk& chunk, const ChunkReport& report);

  EncodedGroom groom_;
  const StrandCoder coder_;
  const int threads_;
  ChunkEncoder own_;  // for encoding without the pool
  GuideChunk own_chunk_;
  std::unique_ptr<EncoderPool> pool_;
  EncodingReport report_;
  uint64_t reported_frame_ = 0;
};

}  // namespace strandcast
