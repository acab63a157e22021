#pragma once
#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/simulation.h"
#include "options/settings.h"
#include "service/command_executor.h"
#include "service/controls.h"
#include "service/groom_sharing.h"
#include "service/network.h"
#include "service/rate_budget.h"
#include "service/status_report.h"
#include "transport/publisher.h"

namespace strandcast {

/// Results of a daemon's run.
struct DaemonSummary {
  Status status;
  double seconds = 0;        ///< wall time
  uint64_t late_frames = 0;  ///< frames published late, because the machine was too slow
  PoseMetrics poses;
  std::string failure;  ///< why the daemon ended on its own; empty after a stop or its duration
};

/// Simulates one scene at a steady rate and publishes it: takes commands, steps, publishes frames and
/// statuses. CommandExecutor executes the commands, GroomSharing hands the show over between daemons of one
/// groom. Simulation time follows wall time. On a machine that is too slow, simulation time falls behind;
/// steps keep their length. `publisher` must outlive the daemon.
class Daemon {
 public:
  /// Throws Error.
  Daemon(const Settings& settings, Scene scene, Publisher& publisher, uint64_t session);
  Daemon(const Daemon&) = delete;
  Daemon& operator=(const Daemon&) = delete;
  /// Announces groom, body and the hairs that follow the groom. Call once, before the first frame. Throws
  /// Error.
  void announce();
  const Status& status() const { return report_.status(); }
  const std::vector<NamedWindSource>& windSources() const { return controlled_.wind.sources(); }

  /// Runs until `stop`, a shutdown command, settings.duration, or a failure (DaemonSummary::failure).
  DaemonSummary run(const std::atomic<bool>& stop);
  /// The work of run() for one frame: executes up to kMaxCommandsPerFrame commands, steps to the frame's
  /// time, publishes the frame. False when `stop` came first.
  bool castFrame(const std::atomic<bool>& stop);
  /// From now on run() lowers the pace under pressure, as `budget` says. By default it never does.
  void setBudget(const RateBudget& budget) { budget_.emplace(budget); }
  /// `observer` is called in the thread of run() after each frame, with the simulation at the frame's time.
  void setObserver(std::function<void(Simulation&)> observer) { observer_ = std::move(observer); }
  /// `takes_another` decides whether a frame takes another of the steps that commands have requested. By
  /// default a frame takes steps for half the frame interval, at least one.
  void setStepping(std::function<bool(const Simulation&)> takes_another) {
    takes_another_ = std::move(takes_another);
  }

  /// From now on a frame waits for the bodies that its commands make from files, so that runs are
  /// reproducible. By default such a body appears some frames later, once it is made.
  void waitForBodies() { waits_for_bodies_ = true; }
  /// Of the live sources that are heard. Callable within Publisher::recordPoses(), for the step that is
  /// taken.
  std::vector<LivePoses::Delay> poseDelays() const { return controlled_.poses.delays(); }
  /// Steps take these poses in place of those of live sources.
  void setRecordedPoses(LivePoses::Recorded recorded) { controlled_.poses.setRecorded(std::move(recorded)); }

 private:
  /// Answers a command, unless another daemon does.
  void answer(uint64_t command, const std::string& refusal);
  /// False where this daemon goes on waiting for the show, or has failed.
  bool joinShow(CastingState turn);
  /// Executes the commands of one frame. False when `stop` came first.
  bool executeCommands(const std::atomic<bool>& stop);
  /// Takes this frame's share of the steps that commands have requested. False when `stop` came first.
  bool runRequestedSteps(const std::atomic<bool>& stop);
  void advance();
  /// End of the last step of the next frame, s of simulation.
  double nextFrameEnd() const;
  void publishFrame();
  void publishStatus();

  const Settings settings_;
  Publisher& publisher_;
  ConflictDetector conflict_detector_;
  ControlledSimulation controlled_;
  std::unique_ptr<GuideSource> guides_;  ///< of the simulation
  StatusReport report_;
  GroomSharing sharing_;
  CommandExecutor executor_;
  GroomDescription groom_;  ///< emptied by announce(), as are body_ and hairs_
  BodyDescription body_;
  HairDescription hairs_;
  GuideFrame frame_;
  double time_accumulator_ = 0;                       ///< s of simulation time that steps have yet to cover
  std::chrono::steady_clock::time_point cast_since_;  ///< start of run()
  std::string failure_;                               ///< why the daemon ends on its own
  bool waits_for_bodies_ = false;
  std::optional<RateBudget> budget_;
  std::function<bool(const Simulation&)> takes_another_;
  std::function<void(Simulation&)> observer_;
};

}  // namespace strandcast
