#pragma once
#include <atomic>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "apps/channel.h"
#include "apps/stream_scene.h"

namespace strandcast {

/// A frame, and what it is drawn with, which another daemon may have replaced since.
struct CapturedFrame {
  std::shared_ptr<const GuideFrame> frame;
  StreamScene scene;
};

/// Picks frames off the stream in its own thread, evenly in simulation time, between two of them where none
/// is due at its time, and keeps them until they are drawn, so that drawing as slowly as it likes loses none
/// while there is room for those that wait.
class FrameCapture {
 public:
  struct Plan {
    int frames;                     ///< to pick
    double fps;                     ///< 1/s of simulation time
    double skip;                    ///< s of it before the first
    double timeout;                 ///< s without a new moment until it ends
    size_t room = size_t{1} << 30;  ///< bytes of guides that may wait
  };
  FrameCapture(Stream& stream, const Plan& plan);
  ~FrameCapture();

  /// The next frame to draw; nothing when there will be no more, or at Ctrl-C. Throws Error as
  /// Stream::checkAlive().
  std::optional<CapturedFrame> next();
  /// Whether it ended because the daemon is paused. The moment that this has is picked, also before `skip`.
  bool isPaused() const { return is_paused_; }
  /// How many were due while there was no room.
  int passedOver() const { return passed_over_; }

 private:
  void run();
  /// Whether there was room for it.
  bool keep(CapturedFrame frame);

  Stream& stream_;
  const Plan plan_;
  std::mutex mutex_;
  std::deque<CapturedFrame> queue_;
  size_t held_ = 0;  ///< bytes, in queue_
  bool done_ = false;
  std::atomic<int> passed_over_{0};
  std::atomic<bool> is_paused_{false}, stop_{false};
  std::thread thread_;
};

}  // namespace strandcast
