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

/// A frame with the groom and body it is drawn with, which another daemon may have replaced since.
struct CapturedFrame {
  std::shared_ptr<const GuideFrame> frame;
  StreamScene scene;
};

/// Picks frames off the stream in its own thread, evenly spaced in simulation time, interpolating between two
/// frames where none is due. Frames wait in a bounded queue, so slow drawing loses none while the queue has
/// space.
class FrameCapture {
 public:
  struct Plan {
    int frames;                     ///< number of frames to pick
    double fps;                     ///< 1/s of simulation time
    double skip;                    ///< s of simulation time before the first
    double timeout;                 ///< s without progress of simulation time until the capture ends
    size_t room = size_t{1} << 30;  ///< bytes of guides that may be queued
  };
  FrameCapture(Stream& stream, const Plan& plan);
  ~FrameCapture();

  /// Waits for the next frame to draw; empty at the end or on Ctrl-C. Throws Error as Stream::checkAlive().
  std::optional<CapturedFrame> next();
  /// Whether the capture ended because the daemon is paused. The frame of that moment is then captured, even
  /// before `skip`.
  bool isPaused() const { return is_paused_; }
  /// Number of frames dropped because the queue was full.
  int skippedFrames() const { return skipped_frames_; }

 private:
  void run();
  /// Queues the frame; false where the queue is full.
  bool keep(CapturedFrame frame);

  Stream& stream_;
  const Plan plan_;
  std::mutex mutex_;
  std::deque<CapturedFrame> queue_;
  size_t held_ = 0;  ///< bytes, in queue_
  bool done_ = false;
  std::atomic<int> skipped_frames_{0};
  std::atomic<bool> is_paused_{false}, stop_{false};
  std::thread thread_;
};

}  // namespace strandcast
