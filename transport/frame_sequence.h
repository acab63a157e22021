#pragma once
#include <cstdint>

namespace strandcast {

/// Decides which frame number may come next in a stream. A single wrong number must not make all later frames
/// appear old; but a daemon may have published many frames while none was received here.
class FrameSequence {
 public:
  static constexpr uint64_t kMostAhead = 4096, kMostBehind = 64;  // frames
  static constexpr int kResyncFrames = 3;

  enum class Place {
    kNext,  ///< newer than the newest
    kLate,  ///< the newest, or a little older
    kFar,   ///< outside the range of lost and late frames: a wrong number
    kAnew   ///< outside that range, like the frames just before it, which were in order: restart the stream
            ///< here
  };
  /// Classifies the frame number of a chunk; `frame` is 1 or more.
  Place look(uint64_t frame) {
    if (newest_ == 0 || (frame > newest_ && frame - newest_ <= kMostAhead)) {
      resync_frames_ = 0;
      return Place::kNext;
    }
    if (frame <= newest_ && newest_ - frame <= kMostBehind) return Place::kLate;
    if (resync_frames_ > 0 && frame <= far_ && far_ - frame <= kMostBehind)
      return Place::kFar;  // a repetition of a far number, or older
    const bool goes_on = resync_frames_ > 0 && frame > far_ && frame - far_ <= kMostAhead;
    resync_frames_ = goes_on ? resync_frames_ + 1 : 1;
    far_ = frame;
    if (resync_frames_ < kResyncFrames) return Place::kFar;
    beginAnew();
    return Place::kAnew;
  }
  /// Accepts any number for the next frame.
  void beginAnew() { newest_ = 0, resync_frames_ = 0; }
  void take(uint64_t frame) { newest_ = frame; }
  /// 0 = none.
  uint64_t newest() const { return newest_; }

 private:
  uint64_t newest_ = 0;
  uint64_t far_ = 0;  // the last far number
  int resync_frames_ = 0;
};

}  // namespace strandcast
