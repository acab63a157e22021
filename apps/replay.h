#pragma once
#include <atomic>
#include <chrono>
#include <memory>
#include <optional>
#include <string>

#include "apps/rival_watch.h"
#include "transport/publisher.h"
#include "transport/recording/recording.h"

namespace strandcast {

struct ReplayOptions {
  double speed = 1;  ///< see isReplaySpeed()
  bool loops = false;
  double from = 0;  ///< s of the recording, where it begins and loops to
  double to = 0;    ///< s, where it ends; 0 = at its end
};
inline constexpr double kMinReplaySpeed = 0.001, kMaxReplaySpeed = 100;
/// 0 stands still.
inline bool isReplaySpeed(double speed) {
  return speed == 0 || (speed >= kMinReplaySpeed && speed <= kMaxReplaySpeed);
}

/// Throws Error when there is no frame to show.
void checkReplay(const Recording& recording, const ReplayOptions& options);

struct ReplaySummary {
  uint64_t frames = 0;   ///< published
  uint64_t damaged = 0;  ///< that could not be read and were left out
  double seconds = 0;    ///< of wall time
  std::string failure;   ///< why it has ended by itself, before its end; else empty
};

/// Casts a recording as a daemon casts its simulation: readers need not know. Commands move it: set `speed`,
/// `position` (s) or `loop` (0 or 1); reset goes to the beginning, stop ends it.
class Replay {
 public:
  /// Both outlive it. `session` of this replay, not 0.
  Replay(Recording& recording, Publisher& publisher, uint32_t groom_id, uint64_t session,
         const ReplayOptions& options);
  /// Until `stop`, the command to stop, or the end. Throws Error when the recording has no frame to show.
  ReplaySummary run(const std::atomic<bool>& stop);

 private:
  void obey(const Command& command);
  void apply(const Command& command);
  void tellParameters();
  void show(uint64_t number, double elapsed);
  void publish(double elapsed);
  void publishStatus();
  double end() const { return options_.to > 0 ? options_.to : recording_.seconds(); }

  Recording& recording_;
  Publisher& publisher_;
  RivalWatch rival_watch_;
  ReplayOptions options_;
  RecordedFrame read_;
  GuideFrame frame_;
  Status status_;
  ReplaySummary summary_;
  std::shared_ptr<const GroomDescription> announced_;
  uint32_t revision_ = 0;
  uint64_t number_ = 0;           ///< of the frame that is shown
  std::optional<double> target_;  ///< s, where to go next
  bool shutdown_ = false;
  std::chrono::steady_clock::time_point cast_since_;
};

}  // namespace strandcast
