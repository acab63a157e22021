#pragma once
#include <cstdint>
#include <list>
#include <map>
#include <memory>
#include <vector>

#include "transport/chunks.h"
#include "transport/codec/guide_decoder.h"
#include "transport/concealment.h"
#include "transport/frame_queue.h"
#include "transport/messages.h"

namespace strandcast {

/// Decides which frame number may come next in a stream. A single wrong number must not make all later frames
/// appear old; but a daemon may have published many frames while none was received here.
class FrameSequence {
 public:
  static constexpr uint64_t kMaxAhead = 4096, kMaxBehind = 64;  // frames
  static constexpr int kResyncFrames = 3;

  enum class Order {
    kNext,    ///< newer than the newest
    kLate,    ///< the newest, or a little older
    kFar,     ///< outside the range of lost and late frames: a wrong number
    kRestart  ///< outside that range, like the frames just before it, which were in order: restart the stream
              ///< here
  };
  /// Classifies the frame number of a chunk; `frame` is 1 or more.
  Order classify(uint64_t frame) {
    if (newest_ == 0 || (frame > newest_ && frame - newest_ <= kMaxAhead)) {
      resync_frames_ = 0;
      return Order::kNext;
    }
    if (frame <= newest_ && newest_ - frame <= kMaxBehind) return Order::kLate;
    if (resync_frames_ > 0 && frame <= far_ && far_ - frame <= kMaxBehind)
      return Order::kFar;  // a repetition of a far number, or older
    const bool goes_on = resync_frames_ > 0 && frame > far_ && frame - far_ <= kMaxAhead;
    resync_frames_ = goes_on ? resync_frames_ + 1 : 1;
    far_ = frame;
    if (resync_frames_ < kResyncFrames) return Order::kFar;
    restart();
    return Order::kRestart;
  }
  /// Accepts any number for the next frame.
  void restart() { newest_ = 0, resync_frames_ = 0; }
  void take(uint64_t frame) { newest_ = frame; }
  /// 0 = none.
  uint64_t newest() const { return newest_; }

 private:
  uint64_t newest_ = 0;
  uint64_t far_ = 0;  // the last far number
  int resync_frames_ = 0;
};

/// Assemble messages from chunks that arrive in any order, repeated or damaged. Every field is checked before
/// it is used. Memory grows with the bytes received, never with the counts in a chunk. Not thread-safe.

/// Collects the chunks of up to two descriptions of different session or revision; a third replaces the one
/// that was fed least recently. `Chunk` is GroomChunk, BodyChunk, ColliderChunk or HairChunk;
/// `Description` is what it is a part of.
template <class Chunk, class Description>
class DescriptionAssembler {
 public:
  explicit DescriptionAssembler(uint32_t groom_id) : groom_id_(groom_id) {}
  /// The description that this chunk completed, or null. Moves the chunk's arrays.
  std::shared_ptr<const Description> add(Chunk&& chunk);
  uint64_t chunksRejected() const { return chunks_rejected_; }

 private:
  struct Pending {
    std::map<uint32_t, Chunk> chunks;  // by index; all agree with the first one received
  };
  Pending* pendingFor(const Chunk& chunk);
  const uint32_t groom_id_;
  std::list<Pending> pending_;  // most recently fed first
  uint64_t chunks_rejected_ = 0;
};

/// All chunks of a groom's hairs, in order.
using HairChunks = std::vector<HairChunk>;

using GroomAssembler = DescriptionAssembler<GroomChunk, GroomDescription>;
using BodyAssembler = DescriptionAssembler<BodyChunk, BodyDescription>;
using ColliderAssembler = DescriptionAssembler<ColliderChunk, ColliderSet>;

/// Assembles the hairs that follow the guides of a groom. They decode against the guides: complete hairs
/// wait, encoded, for the groom of their session and revision.
class HairAssembler {
 public:
  explicit HairAssembler(uint32_t groom_id) : chunks_(groom_id) {}
  /// The hairs of the groom that was set, when this chunk completed them; else null.
  std::shared_ptr<const HairDescription> add(HairChunk&& chunk);
  /// The hairs of this groom, where they are waiting; else null. Precondition: an assembler made `groom`, or
  /// checkAnnouncement() accepted it.
  std::shared_ptr<const HairDescription> setGroom(std::shared_ptr<const GroomDescription> groom);
  uint64_t chunksRejected() const { return chunks_.chunksRejected() + chunks_rejected_; }

 private:
  std::shared_ptr<const HairDescription> decode();

  DescriptionAssembler<HairChunk, HairChunks> chunks_;
  std::shared_ptr<const HairChunks> waiting_;  // complete, and not decoded yet
  std::shared_ptr<const GroomDescription> groom_;
  uint64_t chunks_rejected_ = 0;
};

/// Assembles frames of one groom. Chunks that come before the groom are dropped and not counted.
class GuideAssembler {
 public:
  /// With `conceals`, tracks the motion of strands for concealOverdue().
  explicit GuideAssembler(bool conceals = false) : conceals_(conceals) {}
  /// Precondition: an assembler made `groom`, or checkAnnouncement() accepted it. Drops incomplete frames;
  /// the count of lost frames restarts with the first complete frame.
  void setGroom(std::shared_ptr<const GroomDescription> groom);
  /// Sets the carriers of strands for concealOverdue(). Precondition: an assembler made `colliders`. Those of
  /// another session than the groom's are kept until a groom of theirs is set.
  void setColliders(std::shared_ptr<const ColliderSet> colliders);
  /// Drops incomplete frames and accepts any number for the next frame, as after a seek in a file.
  void restart();
  /// The frame that this chunk completed, or null. Its number is lower than the last one's where the stream
  /// restarted (FrameSequence).
  std::shared_ptr<const GuideFrame> add(const GuideChunk& chunk);
  /// An incomplete frame whose missing chunks are overdue, with its lost strands concealed; null when there
  /// is none. A frame is overdue once a quarter of a later one is here. Call after add() on links that do not
  /// repair losses.
  std::shared_ptr<const GuideFrame> concealOverdue();

  /// All but the latencies; chunks_rejected counts chunks of guides only.
  const ReceiveStatistics& statistics() const { return statistics_; }
  uint64_t chunksRejected() const { return statistics_.chunks_rejected; }

 private:
  struct Pending {
    GuideChunk header;  // of the first chunk received, without payload
    FramePool::Buffer frame;
    std::vector<StrandRun> runs;  // by chunk index; strand_count 0 = not received
    uint32_t received = 0;
    uint64_t bytes = 0;
    uint64_t fed = 0;  // value of begun_ when its last chunk came
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
  std::vector<Vec3> decoded_;   // of the current chunk
  std::list<Pending> pending_;  // most recently fed first; at most kMaxPendingFrames
  uint64_t begun_ = 0;          // number of frames of which a chunk came
  FrameSequence sequence_;      // of the complete frames of this groom
  ReceiveStatistics statistics_;
};

}  // namespace strandcast
