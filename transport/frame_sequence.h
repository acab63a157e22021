#pragma once
#include <cstdint>

namespace strandcast {

/// Which frame numbers a stream may go on with. One wrong number must not leave all that follow behind it;
/// but who casts may have run on while nobody here listened.
class FrameSequence {
 public:
  static constexpr uint64_t kMostAhead = 4096, kMostBehind = 64;  // frames
  static constexpr int kWitnesses = 3;

  enum class Place {
    kNext,  ///< newer than the newest
    kLate,  ///< the newest, or a little older
    kFar,   ///< further off than frames get lost or come late: a wrong number
    kAnew   ///< so far off, but so were the frames just before it, in order: take it as the first
  };
  /// Of a chunk's frame, 1 or more.
  Place look(uint64_t frame) {
    if (newest_ == 0 || (frame > newest_ && frame - newest_ <= kMostAhead)) {
      witnesses_ = 0;
      return Place::kNext;
    }
    if (frame <= newest_ && newest_ - frame <= kMostBehind) return Place::kLate;
    if (witnesses_ > 0 && frame <= far_ && far_ - frame <= kMostBehind) return Place::kFar;  // the same again
    const bool goes_on = witnesses_ > 0 && frame > far_ && frame - far_ <= kMostAhead;
    witnesses_ = goes_on ? witnesses_ + 1 : 1;
    far_ = frame;
    if (witnesses_ < kWitnesses) return Place::kFar;
    beginAnew();
    return Place::kAnew;
  }
  /// The next frame may have any number.
  void beginAnew() { newest_ = 0, witnesses_ = 0; }
  void take(uint64_t frame) { newest_ = frame; }
  /// 0 = none.
  uint64_t newest() const { return newest_; }

 private:
  uint64_t newest_ = 0;
  uint64_t far_ = 0;  // the last of them
  int witnesses_ = 0;
};

}  // namespace strandcast
