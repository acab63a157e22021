// A recording again: published as a daemon publishes, or simulated and compared.
#pragma once
#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "options/settings.h"
#include "service/network.h"
#include "transport/publisher.h"
#include "transport/recording/recording.h"

namespace strandcast {

/// The speed and range of a replay.
struct ReplayOptions {
  double speed = 1;  ///< see isReplaySpeed()
  bool loops = false;
  double from = 0;  ///< s of the recording at which it begins and to which it loops
  double to = 0;    ///< s at which it ends; 0 = at the recording's end
};
inline constexpr double kMinReplaySpeed = 0.001, kMaxReplaySpeed = 100;
/// Whether the speed is valid; 0 stands still.
inline bool isReplaySpeed(double speed) {
  return speed == 0 || (speed >= kMinReplaySpeed && speed <= kMaxReplaySpeed);
}

/// Throws Error where the recording has no frame within the range.
void checkReplay(const Recording& recording, const ReplayOptions& options);

/// The results of a replay.
struct ReplaySummary {
  uint64_t frames = 0;   ///< published
  uint64_t damaged = 0;  ///< frames that could not be read and were skipped
  double seconds = 0;    ///< of wall time
  std::string failure;   ///< why the replay ended on its own before its end; else empty
};

/// Publishes a recording as a daemon publishes its simulation; subscribers see no difference. Commands
/// control it: set `speed`, `position` (s) or `loop` (0 or 1); reset returns to the beginning, stop ends it.
class Replay {
 public:
  /// `recording` and `publisher` must outlive this. `session`: of this replay, not 0.
  Replay(Recording& recording, Publisher& publisher, uint32_t groom_id, uint64_t session,
         const ReplayOptions& options);
  /// Runs until `stop`, a shutdown command, or the end. Throws Error where the recording has no frame to
  /// show.
  ReplaySummary run(const std::atomic<bool>& stop);

 private:
  void execute(const Command& command);
  void apply(const Command& command);
  void fillStatus();
  void show(uint64_t number, double elapsed);
  void publish(double elapsed);
  void publishStatus();
  double end() const { return options_.to > 0 ? options_.to : recording_.seconds(); }

  Recording& recording_;
  Publisher& publisher_;
  ConflictDetector conflict_detector_;
  ReplayOptions options_;
  RecordedFrame read_;
  GuideFrame frame_;
  Status status_;
  ReplaySummary summary_;
  std::shared_ptr<const GroomDescription> announced_;
  std::vector<std::string> warnings_;  ///< of damaged descriptions, each logged once
  uint32_t revision_ = 0;
  uint64_t number_ = 0;           ///< of the frame that is shown
  std::optional<double> target_;  ///< s, position to seek to
  bool shutdown_ = false;
  std::chrono::steady_clock::time_point cast_since_;
};

/// The source that a daemon's recording keeps for resimulation: the daemon's arguments, the folder of
/// relative paths, and the text of the configuration file. `backend` and `device` as in Status. `character`:
/// groom id of the [[character]] table that was recorded; 0 where the file has none.
std::string simulationSource(const std::vector<std::string>& words, const SettingsOptions& options,
                             const std::string& backend, const std::string& device, uint32_t character = 0);

/// The results of a resimulation.
struct ResimulationReport {
  std::string backend, device, recorded_device;
  uint64_t frames = 0;     ///< frames compared
  uint64_t different = 0;  ///< frames whose positions differ from the recorded ones in any bit
  uint64_t first_different = 0;
  uint64_t inputs = 0;  ///< commands that were replayed
};

/// Simulates a daemon's recording (`strandcastd --record`) again, with the same settings and the same
/// commands before the same frames, and compares the hash of each frame. Throws Error where the recording has
/// no source, or where its groom differs from the one that the settings make now. `frame_done` is called with
/// the number of frames compared and the simulation; an Error from it ends the resimulation.
ResimulationReport resimulate(Recording& recording, const std::string& name, const std::atomic<bool>& stop,
                              const std::function<void(uint64_t frames, Simulation&)>& frame_done);

}  // namespace strandcast
