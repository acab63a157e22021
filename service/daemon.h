#pragma once
#include <array>
#include <atomic>
#include <chrono>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/simulation.h"
#include "options/settings.h"
#include "service/colliders.h"
#include "service/controls.h"
#include "service/network.h"
#include "transport/publisher.h"

namespace strandcast {

constexpr int kMaxRequestedSteps = 1000;  ///< limit on outstanding steps requested by commands

/// Results of a daemon's run.
struct DaemonSummary {
  Status status;
  double seconds = 0;        ///< wall time
  uint64_t late_frames = 0;  ///< frames published late, because the machine was too slow
  std::string failure;       ///< why the daemon ended on its own; empty after a stop or its duration
};

/// Simulates one scene at a steady rate and publishes it: executes commands, steps, publishes frames and
/// statuses. Simulation time follows wall time. On a machine that is too slow, simulation time falls behind;
/// steps keep their length. `publisher` must outlive the daemon.
class Daemon {
 public:
  /// Throws Error.
  Daemon(const Settings& settings, Scene scene, Publisher& publisher, uint64_t session);
  Daemon(const Daemon&) = delete;
  Daemon& operator=(const Daemon&) = delete;
  /// Announces groom and body. Call once, before the first frame. Throws Error.
  void announce();
  const Status& status() const { return status_; }
  const std::vector<NamedWindSource>& windSources() const { return wind_.sources(); }

  /// Runs until `stop`, a shutdown command, settings.duration, or a failure (DaemonSummary::failure).
  DaemonSummary run(const std::atomic<bool>& stop);
  /// The work of run() for one frame: executes up to kMaxCommandsPerFrame commands, steps to the frame's
  /// time, publishes the frame. False when `stop` came first.
  bool castFrame(const std::atomic<bool>& stop);
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

 private:
  void execute(const Command& command);
  void answer(uint64_t command, const std::string& refusal);
  void apply(const Command& command);
  void reset();
  /// Warns once of a parameter that was set but has no effect with the other parameters.
  void warnIfUnused(const std::string& parameter);
  void pull(const Command& command, const std::string& where);
  void moveHead(const Command& command, const std::string& where);
  /// The head pose of the motion alone, without the clip, which goes on and carries the head.
  Pose motionPose() const;
  void setHeadControl(HeadControl control);
  void addCollider(const Command& command, const std::string& where);
  void addColliderFile(const Command& command, const std::string& where);
  /// A collider that commands may move or remove; throws Error otherwise.
  BodyId namedCollider(const std::string& name, const std::string& where) const;
  /// Throws Error where the name is empty or in use.
  void checkColliderName(const std::string& name, const std::string& where) const;
  /// Adds a named body and announces the colliders. Throws Error where the limits on colliders are exceeded.
  void addNamed(const std::string& name, RigidBody body, const std::string& where);
  /// Poses colliders that commands are moving for `time`, s of simulation.
  void advanceColliderMotions(double time);
  /// Adds the bodies made from files so far and answers their commands.
  void addMadeBodies();
  /// Waits until all bodies from files are made. False when `stop` came first.
  bool waitUntilBodiesMade(const std::atomic<bool>& stop);
  /// Refuses the bodies from files that are not made yet.
  void dropBodies();
  void moveCollider(const Command& command, const std::string& where);
  void removeCollider(const Command& command, const std::string& where);
  void announceColliders();
  void fillStatus();
  void placeColliders();
  void requestSteps(const Command& command, const std::string& where);
  bool runRequestedSteps(const std::atomic<bool>& stop);
  void dropSteps(const std::string& why);
  void advance();
  void publishFrame();
  /// Measures the next `strands` strands of those not measured since the last status.
  void measureSlice(size_t strands);
  /// Measures the remaining strands and fills in the status: hair, time and step durations.
  void measure();
  void publishStatus();

  // Daemons that share a groom: daemon_show.cc.
  /// The state that a standby needs to go on in place of this daemon. `with_hair`: including the strand
  /// state.
  Show makeShow(bool with_hair);
  void addColliderEntries(std::vector<ShowEntry>& entries) const;
  void publishShow(bool with_hair);
  /// Publishes the show where this daemon casts and the show is due or hair is wanted.
  void publishShowIfDue();
  /// True once this daemon has the casting daemon's show, or nobody casts. False: keep waiting.
  bool hasShow(CastingState turn);
  /// After this daemon stood still and lost its turn: waits for the show again.
  void waitForShow();
  /// While another daemon casts: applies its show, and queues commands in case this daemon takes over.
  void followShow();
  /// Applies a show. Throws Error where it is not of this scene.
  void restoreFrom(const Show& show);
  void applyColliders(const Show& show);
  void applyCollider(const ShowEntry& entry);
  /// Records a collider of the show that could not be made from its file, with a warning. Empty refusal: no
  /// effect.
  void recordMissingCollider(const ShowEntry& entry, const std::string& refusal);
  /// Throws Error where the show's mesh hash differs from that of the collider made here.
  void checkMesh(const ColliderMaker::Made& made) const;
  /// Whether the mesh of a collider added by command matches the show's; true where the show has no hash.
  bool hasMeshOf(const Show& show, const std::string& collider) const;
  void syncTime(double time);
  /// Takes over casting: repeats recent answers and executes the queued commands.
  void becomeCaster();
  /// Executes the commands of one frame. False when `stop` came first.
  bool executeCommands(const std::atomic<bool>& stop);

  /// The role of a daemon that shares its groom.
  enum class ShareState {
    kWaiting,       ///< waits for the show; claims nothing
    kCatchingUp,    ///< has the show and catches up with its time; claims nothing
    kParticipating  ///< claims, and casts on its turn
  };
  ShareState share_state_ = ShareState::kParticipating;
  bool is_following_ = false;           ///< another daemon casts
  std::vector<ShowEntry> fingerprint_;  ///< of scene and settings; equal for all daemons that share the groom
  std::vector<Command> queued_commands_;                   ///< commands received while another daemon casts
  std::deque<std::pair<uint64_t, std::string>> answered_;  ///< newest commands and their refusals, empty =
                                                           ///< accepted
  std::map<std::string, Command>
      collider_commands_;  ///< command that added a collider, by the collider's name
  std::map<uint64_t, Command>
      pending_colliders_;  ///< commands whose colliders are being made from files, by id
  std::map<uint64_t, ShowEntry>
      show_entries_;  ///< the show's entries for pending_colliders_, by the same ids
  /// Colliders of the show that could not be made here, with the show's mesh hash; 0 = the show has none.
  std::map<std::string, uint64_t> missing_colliders_;
  std::map<std::string, uint64_t>
      mesh_hashes_;  ///< mesh hashes of the collider_commands_ that are made from files
  std::map<std::string, uint64_t> show_mesh_hashes_;  ///< those of the newest show; 0 = the show has none
  std::array<double, 8> last_pull_{};                 ///< values of the newest pull
  uint32_t resets_ = 0;
  std::optional<uint64_t> show_session_;  ///< session of the show applied last
  std::chrono::steady_clock::time_point show_due_{}, waits_since_ = std::chrono::steady_clock::now();
  int shows_in_tolerance_ = 0;  ///< shows without hair received within tolerance since the hair
  double show_lag_ = 0;         ///< s of simulation time to the newest show
  bool logged_wait_ = false, warned_wait_ = false, logged_equal_ = false;
  bool has_own_hair_ = false;  ///< has cast and then stood still: a show without hair suffices

  Settings settings_;
  Publisher& publisher_;
  ConflictDetector conflict_detector_;
  GroomDescription groom_;  ///< emptied by announce()
  BodyDescription body_;
  /// The motion of a collider by command, until its end.
  struct PoseTween {
    Pose from, to;
    double start, seconds;  ///< s of simulation time
  };
  std::map<std::string, BodyId> named_;  ///< colliders added by commands or named by the scene
  std::string body_name_;                ///< of the body that hair grows on; may be empty
  size_t named_parts_;                   ///< the body's colliders are the first named_parts_
  ColliderMaker maker_;                  ///< makes the colliders that come from files
  bool waits_for_bodies_ = false;
  std::map<BodyId, PoseTween> tweens_;
  uint32_t collider_revision_ = 0;
  std::shared_ptr<const SkinnedBody> skinned_;
  HeadMotion scene_motion_, motion_;
  HeadControl head_control_;  ///< the source of motion_
  Vec3 head_pivot_;           ///< m, the pivot of procedural motions
  Simulation simulation_;
  WindControl wind_;
  GuideFrame frame_;
  Status status_;
  Measurement measured_;  ///< of the first strands_measured_ strands, since the last status
  size_t strands_measured_ = 0;
  std::vector<double> step_ms_;  ///< durations of the newest steps, a ring of kStepWindow
  size_t step_count_ = 0;
  double time_accumulator_ = 0;  ///< s of simulation time
  bool shutdown_ = false;
  std::string failure_;                               ///< why the daemon ends on its own
  std::chrono::steady_clock::time_point cast_since_;  ///< start of run()
  bool paused_ = false;
  /// Steps that a command has requested while paused and that are outstanding.
  struct Steps {
    uint64_t command;
    std::string where;  ///< for errors
    int left;
  };
  std::deque<Steps> steps_;
  std::function<bool(const Simulation&)> takes_another_;
  double pull_until_ = 0;  ///< s of simulation time
  std::set<std::string> unused_parameters_;
  std::function<void(Simulation&)> observer_;
};

/// A random session number that identifies one start of a daemon; never 0.
uint64_t newSession();

}  // namespace strandcast
