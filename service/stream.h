// The stream that a renderer draws: a daemon on the network or in this process, frames taken from it,
// recordings of it.
#pragma once
#include <atomic>
#include <chrono>
#include <deque>
#include <exception>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "options/settings.h"
#include "service/daemon.h"
#include "transport/recording/recorder.h"
#include "transport/subscriber.h"

namespace strandcast {

/// The groom, its body and hairs that a stream's frames are drawn or recorded with.
struct StreamScene {
  std::shared_ptr<const GroomDescription> groom;
  std::shared_ptr<const BodyDescription> body;
  std::shared_ptr<const HairDescription> hairs = nullptr;  ///< that follow the groom; null: none are here

  /// What has arrived so far. Groom and body arrive separately: one may be missing, or they may be of two
  /// daemons.
  static StreamScene of(const Subscriber& subscriber) {
    return {subscriber.groom(), subscriber.body(), subscriber.hairs()};
  }

  /// Whether all that is drawn has arrived and matches the frame's session and revision.
  bool fits(const GuideFrame& frame) const {
    const auto is_of_it = [&](const auto& description) {
      return description && description->session == frame.session && description->revision == frame.revision;
    };
    return is_of_it(groom) && is_of_it(body) &&
           ((groom->growth & GroomDescription::kHairs) == 0 || is_of_it(hairs));
  }
  bool operator==(const StreamScene&) const = default;
};

/// Called with the simulation after each frame, in the daemon's thread.
using SimulationObserver = std::function<void(Simulation&)>;

/// A daemon in a thread of this process that publishes over the in-process channel: `strandcast view
/// --scene`.
class EmbeddedDaemon {
 public:
  /// Makes the scene first, with a progress bar; throws Error.
  explicit EmbeddedDaemon(const Settings& settings, SimulationObserver observer = {});
  ~EmbeddedDaemon();
  Subscriber& subscriber() { return *subscriber_; }
  /// Rethrows the Error that ended the daemon, if any.
  void checkAlive() const;
  /// Whether the daemon has stopped casting.
  bool hasEnded() const { return has_ended_; }

 private:
  std::unique_ptr<Publisher> publisher_;
  std::unique_ptr<Subscriber> subscriber_;
  std::unique_ptr<Daemon> daemon_;
  std::atomic<bool> stop_{false}, has_ended_{false};
  mutable std::mutex mutex_;
  std::exception_ptr failure_;
  std::thread thread_;
};

/// The source of a renderer's frames: a daemon on the network or, with `here`, one in this process. The
/// subscriber interface is the same for both.
class Stream {
 public:
  /// Waits for groom and body; throws Error after `timeout` seconds. `observer` is called only for a daemon
  /// in this process.
  Stream(const Settings& settings, bool here, double timeout, SimulationObserver observer = {});
  Subscriber& subscriber() { return embedded_ ? embedded_->subscriber() : *remote_; }
  /// As EmbeddedDaemon::checkAlive(). Does nothing for a daemon on the network, which may stop and return.
  void checkAlive() const {
    if (embedded_) embedded_->checkAlive();
  }
  bool hasEnded() const { return embedded_ && embedded_->hasEnded(); }

 private:
  std::unique_ptr<EmbeddedDaemon> embedded_;
  std::unique_ptr<Subscriber> remote_;
};

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

/// Records the frames that a subscriber receives. An existing file of that name is kept until there is a
/// groom to write.
class StreamRecording {
 public:
  /// Frames that the subscriber queues meanwhile: about a second of a busy disk or processor at 60 a second.
  static constexpr size_t kFramesKept = 64;

  /// Throws Error where the file cannot be created. `subscriber` must outlive this.
  StreamRecording(Subscriber& subscriber, const std::filesystem::path& file, const RecordingOptions& options)
      : subscriber_(subscriber), recorder_(file, options, MakeFile::kWithGroom) {
    subscriber_.keepFrames(kFramesKept);
  }
  ~StreamRecording() { subscriber_.keepFrames(kFrameQueueLength); }
  StreamRecording(const StreamRecording&) = delete;
  StreamRecording& operator=(const StreamRecording&) = delete;

  /// Waits for the next frame and writes it unless its time equals the last one's; false on timeout. Throws
  /// Error as Recorder.
  bool take(std::chrono::milliseconds timeout);
  void close() { recorder_.close(); }

  const Recorder& recorder() const { return recorder_; }
  /// Frames lost on the network or dropped because writing was slower than the stream.
  uint64_t skipped() const { return skipped_; }

 private:
  bool describe(const GuideFrame& frame);

  Subscriber& subscriber_;
  Recorder recorder_;
  uint64_t session_ = 0, skipped_ = 0;
  std::shared_ptr<const GuideFrame> last_;
  uint32_t revision_ = 0;
};

}  // namespace strandcast
