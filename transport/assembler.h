#pragma once
#include <list>
#include <map>
#include <memory>
#include <vector>

#include "transport/chunks.h"
#include "transport/codec/guide_decoder.h"
#include "transport/frame_queue.h"
#include "transport/messages.h"

namespace strandcast {

/// Put chunks back together, in any order, repeated or damaged. Every field is checked before it is used;
/// memory grows with what was received, never with what a count promises. Not thread-safe.

/// Collects the chunks of up to two descriptions at a time (of different sessions or revisions; the one not
/// fed for longest gives way). `Chunk` is GroomChunk or BodyChunk, `Description` what it is part of.
template <class Chunk, class Description>
class DescriptionAssembler {
 public:
  explicit DescriptionAssembler(uint32_t groom_id) : groom_id_(groom_id) {}
  /// The description that this chunk completed, or null. Takes the chunk's arrays.
  std::shared_ptr<const Description> add(Chunk&& chunk);
  uint64_t chunksRejected() const { return chunks_rejected_; }

 private:
  struct Pending {
    std::map<uint32_t, Chunk> chunks;  // by index; all agree with the first one received
  };
  Pending* pendingFor(const Chunk& chunk);
  const uint32_t groom_id_;
  std::list<Pending> pending_;  // fed last first
  uint64_t chunks_rejected_ = 0;
};

using GroomAssembler = DescriptionAssembler<GroomChunk, GroomDescription>;
using BodyAssembler = DescriptionAssembler<BodyChunk, BodyDescription>;

/// Puts frames together that fit one groom. Chunks that come before there is a groom are dropped uncounted.
class GuideAssembler {
 public:
  /// `groom` as an assembler or a checked announcement made it. Frames under way are dropped and the count of
  /// lost frames starts anew with the first complete frame.
  void setGroom(std::shared_ptr<const GroomDescription> groom);
  /// The frame that this chunk completed, or null.
  std::shared_ptr<const GuideFrame> add(const GuideChunk& chunk);

  uint64_t framesReceived() const { return frames_received_; }
  uint64_t framesLost() const { return frames_lost_; }
  uint64_t chunksRejected() const { return chunks_rejected_; }
  /// Sound chunks that refer to a key frame that is not here: of frames from before this receiver joined, or
  /// behind a lost key frame.
  uint64_t chunksWithoutKey() const { return chunks_without_key_; }
  /// Payload bytes of the frames received.
  uint64_t bytesReceived() const { return bytes_received_; }

 private:
  struct Pending {
    GuideChunk header;  // of the first chunk received, without payload
    FramePool::Buffer frame;
    std::vector<StrandRun> runs;  // by chunk index; strand_count 0 = not received
    uint32_t received = 0;
    uint64_t bytes = 0;
  };
  bool fits(const GuideChunk& chunk) const;
  Pending* pendingFor(const GuideChunk& chunk);
  std::shared_ptr<const GuideFrame> complete(std::list<Pending>::iterator pending);

  std::shared_ptr<const GroomDescription> groom_;
  FramePool pool_;
  GuideDecoder decoder_;
  std::vector<Vec3> decoded_;   // of the chunk under way
  std::list<Pending> pending_;  // fed last first; at most kFramesUnderWay
  uint64_t newest_ = 0;         // complete frame of this groom, 0 = none
  uint64_t frames_received_ = 0, frames_lost_ = 0, chunks_rejected_ = 0, chunks_without_key_ = 0;
  uint64_t bytes_received_ = 0;
};

}  // namespace strandcast
