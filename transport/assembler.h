#pragma once
#include <list>
#include <map>
#include <memory>
#include <vector>

#include "transport/chunks.h"
#include "transport/codec/guide_decoder.h"
#include "transport/concealment.h"
#include "transport/frame_queue.h"
#include "transport/frame_sequence.h"
#include "transport/messages.h"

namespace strandcast {

/// Put chunks back together, in any order, repeated or damaged. Every field is checked before it is used;
/// memory grows with what was received, never with what a count promises. Not thread-safe.

/// Collects the chunks of up to two descriptions at a time (of different sessions or revisions; the one not
/// fed for longest gives way). `Chunk` is GroomChunk, BodyChunk or ColliderChunk, `Description` what it is
/// part of.
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
using ColliderAssembler = DescriptionAssembler<ColliderChunk, ColliderSet>;

/// Puts frames together that fit one groom. Chunks that come before there is a groom are dropped uncounted.
class GuideAssembler {
 public:
  /// With `conceals`, takes note of where strands are for concealOverdue().
  explicit GuideAssembler(bool conceals = false) : conceals_(conceals) {}
  /// `groom` as an assembler or a checked announcement made it. Frames under way are dropped and the count of
  /// lost frames starts anew with the first complete frame.
  void setGroom(std::shared_ptr<const GroomDescription> groom);
  /// By which concealOverdue() knows what carries strands. `colliders` as an assembler made them; those of
  /// another session than the groom's are kept until there is one of theirs.
  void setColliders(std::shared_ptr<const ColliderSet> colliders);
  /// The next frame may have any number: who reads a file goes where it likes. Frames under way are dropped.
  void beginAnew();
  /// The frame that this chunk completed, or null. Its number is less than those before it where the stream
  /// is found to go on from there (FrameSequence).
  std::shared_ptr<const GuideFrame> add(const GuideChunk& chunk);
  /// A frame that will not be completed any more, its lost strands concealed; null when there is none. Call
  /// after add() on links that do not repair losses: a frame is given up once a quarter of a later one is
  /// here.
  std::shared_ptr<const GuideFrame> concealOverdue();

  /// All but the latencies; chunks_rejected are the guides'.
  const ReceiveStatistics& statistics() const { return statistics_; }
  uint64_t chunksRejected() const { return statistics_.chunks_rejected; }

 private:
  struct Pending {
    GuideChunk header;  // of the first chunk received, without payload
    FramePool::Buffer frame;
    std::vector<StrandRun> runs;  // by chunk index; strand_count 0 = not received
    uint32_t received = 0;
    uint64_t bytes = 0;
    uint64_t fed = 0;  // frames that had been begun when its last chunk came
  };
  bool fits(const GuideChunk& chunk) const;
  Pending* pendingFor(const GuideChunk& chunk);
  std::shared_ptr<const GuideFrame> complete(std::list<Pending>::iterator pending);
  std::shared_ptr<const GuideFrame> release(std::list<Pending>::iterator pending);
  void drop(std::list<Pending>::iterator pending);

  const bool conceals_;
  std::shared_ptr<const GroomDescription> groom_;
  std::shared_ptr<const ColliderSet> colliders_;
  Concealment concealment_;
  FramePool pool_;
  GuideDecoder decoder_;
  std::vector<Vec3> decoded_;   // of the chunk under way
  std::list<Pending> pending_;  // fed last first; at most kFramesUnderWay
  uint64_t begun_ = 0;          // frames of which a chunk came
  FrameSequence sequence_;      // of the complete frames of this groom
  ReceiveStatistics statistics_;
};

}  // namespace strandcast
