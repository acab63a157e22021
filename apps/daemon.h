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

#include "apps/collider_files.h"
#include "apps/rival_watch.h"
#include "apps/settings.h"
#include "apps/steered_head.h"
#include "apps/wind_control.h"
#include "core/simulation.h"
#include "transport/publisher.h"

namespace strandcast {

constexpr int kMostSteps = 1000;  ///< that a daemon may still have to take for commands

/// What a daemon has to say when it ends.
struct DaemonSummary {
  Status status;
  double seconds = 0;        ///< of wall time
  uint64_t late_frames = 0;  ///< frames that came after their time, because the machine was too slow
  std::string failure;       ///< why it has ended by itself; empty where it was told to end
};

/// Simulates one scene at a steady rate and publishes it: commands in, steps, frames and status out.
/// Simulation time follows wall time; when the machine is too slow it falls behind rather than taking longer
/// steps.
class Daemon {
 public:
  /// Throws Error.
  Daemon(const Settings& settings, Scene scene, Publisher& publisher, uint64_t session);
  Daemon(const Daemon&) = delete;
  Daemon& operator=(const Daemon&) = delete;
  /// Announces the groom and body: once, before the first frame. Throws Error.
  void announce();
  const Status& status() const { return status_; }
  const std::vector<NamedWindSource>& windSources() const { return wind_.sources(); }

  /// Until `stop`, a shutdown command, or settings.duration.
  DaemonSummary run(const std::atomic<bool>& stop);
  /// What run() does for each frame: obeys up to kMaxCommandsPerFrame commands, steps to its time, publishes
  /// it. False when `stop` came first.
  bool castFrame(const std::atomic<bool>& stop);
  /// Called in the thread of run() after each frame, with the simulation as the frame has it.
  void setObserver(std::function<void(Simulation&)> observer) { observer_ = std::move(observer); }
  /// Whether a frame takes another of the steps that commands have asked for. Else the clock says it: a frame
  /// takes as many as half the time between frames has room for, at least one.
  void setStepping(std::function<bool(const Simulation&)> takes_another) {
    takes_another_ = std::move(takes_another);
  }

  /// From now on a frame waits for the bodies that its commands have made of files, so that a run is repeated
  /// as it was. Else they are there some frames later, when they are made.
  void waitForBodies() { waits_for_bodies_ = true; }

 private:
  void obey(const Command& command);
  void answer(uint64_t command, const std::string& refusal);
  void apply(const Command& command);
  void reset();
  /// Warns, once, of a parameter that was set and does nothing beside the others.
  void tellWhatIsVoid(const std::string& parameter);
  void pull(const Command& command, const std::string& where);
  void moveHead(const Command& command, const std::string& where);
  /// Where the motion has the head; a clip goes on, and carries it there.
  Pose motionPose() const;
  void setCourse(SteeredHead course);
  void addCollider(const Command& command, const std::string& where);
  void addColliderFile(const Command& command, const std::string& where);
  /// One that can be moved or removed by command; else throws Error.
  BodyId namedCollider(const std::string& name, const std::string& where) const;
  /// Throws Error where the name is taken.
  void checkColliderName(const std::string& name, const std::string& where) const;
  /// Throws Error where there is no room for it.
  void addNamed(const std::string& name, RigidBody body, const std::string& where);
  /// Where a collider that commands have moved is on its way at `time`.
  void goOnWithWays(double time);
  /// Adds the bodies of files that are made by now, and answers their commands.
  void takeMadeBodies();
  /// Until none is still to be made. False when `stop` came first.
  bool awaitBodies(const std::atomic<bool>& stop);
  /// Those that are still to be made are not.
  void dropBodies();
  void moveCollider(const Command& command, const std::string& where);
  void removeCollider(const Command& command, const std::string& where);
  void announceColliders();
  void tellParameters();
  void placeColliders();
  void askForSteps(const Command& command, const std::string& where);
  bool takeSteps(const std::atomic<bool>& stop);
  void dropSteps(const std::string& why);
  void advance();
  void publishFrame();
  /// Measures so many strands more of those that status tells of.
  void lookAt(size_t strands);
  /// The rest of them: what status tells of hair, time and steps is that of now.
  void measure();
  void publishStatus();

  // Of daemons that share a groom, in daemon_show.cc.
  /// What another daemon needs to go on with the show.
  Show showNow(bool with_hair);
  void addColliderEntries(std::vector<ShowEntry>& entries) const;
  void publishShow(bool with_hair);
  /// On this daemon's turn, tells the others the show where it is time to.
  void tellShow();
  /// Until this daemon has the show of the one that casts, or there is none. False: wait on.
  bool hasShow(SharedTurn turn);
  /// Of a daemon that stood still: it joins the show anew.
  void waitForShow();
  /// Another one casts: keeps to what that one tells, and keeps commands for the case that it takes over.
  void followShow();
  /// Throws Error where the show is not of this scene.
  void goOnWith(const Show& show);
  void takeColliders(const Show& show);
  void takeCollider(const ShowEntry& entry);
  /// A collider of the show was made of its file, or was not and why.
  void noteMade(const ShowEntry& entry, const std::string& refusal);
  /// Throws Error where the show tells of another mesh than the one that this collider was made of here.
  void checkMesh(const ColliderMaker::Made& made) const;
  /// Whether the mesh of a collider that a command had made is the one of the show, as far as that tells it.
  bool hasMeshOf(const Show& show, const std::string& collider) const;
  void keepTime(double time);
  /// What came to this daemon while another one cast, and was not carried out.
  void takeOver();
  /// False when `stop` came first.
  bool obeyCommands(const std::atomic<bool>& stop);

  /// Of a daemon that shares its groom.
  enum class Part {
    kWaits,      ///< for the show; claims nothing
    kCatchesUp,  ///< has it, and comes to the time at which it is by now; claims nothing
    kTakesPart   ///< claims, and casts on its turn
  };
  Part part_ = Part::kTakesPart;
  bool follows_ = false;                ///< another one casts
  std::vector<ShowEntry> fingerprint_;  ///< of scene and settings: of who shares the groom they are the same
  std::vector<Command> held_;           ///< that came while another one cast
  std::deque<std::pair<uint64_t, std::string>> answered_;  ///< the newest commands, and why they were refused
  std::map<std::string, Command> made_by_;  ///< the command that added a collider, by the collider's name
  std::map<uint64_t, Command> being_made_;  ///< commands whose colliders are made of files, by id
  std::map<uint64_t, ShowEntry> of_show_;   ///< what the show has of being_made_, by the same ids
  /// Colliders of the show that could not be made here, and the hash of the mesh that it tells of; 0 = none.
  std::map<std::string, uint64_t> missing_;
  std::map<std::string, uint64_t> mesh_hashes_;   ///< of made_by_ that are made of files
  std::map<std::string, uint64_t> shown_hashes_;  ///< the same as the newest show tells them; 0 = it does not
  std::array<double, 8> pulled_{};                ///< of the newest pull
  uint32_t resets_ = 0;
  std::optional<uint64_t> show_session_;  ///< whose show it went on with last
  std::chrono::steady_clock::time_point show_due_{}, waits_since_ = std::chrono::steady_clock::now();
  int news_ = 0;       ///< of the show that came in time, since the hair did
  double behind_ = 0;  ///< s of simulation, the show at its newest news
  bool said_wait_ = false, warned_wait_ = false, said_equal_ = false;
  bool has_own_hair_ = false;  ///< it has cast, and stood still: a show without hair will do

  Settings settings_;
  Publisher& publisher_;
  RivalWatch rival_watch_;
  GroomDescription groom_;  ///< until announce()
  BodyDescription body_;
  /// Of a collider that a command has moved, until it is there.
  struct Way {
    Pose from, to;
    double start, seconds;  ///< of simulation time
  };
  std::map<std::string, BodyId> named_;  ///< colliders that commands have added, or the scene names
  std::string body_name_;                ///< of the body that hair grows on; may be empty
  size_t named_parts_;                   ///< colliders that it consists of, the first
  ColliderMaker maker_;                  ///< of those that will be added
  bool waits_for_bodies_ = false;
  std::map<BodyId, Way> ways_;
  uint32_t collider_revision_ = 0;
  std::shared_ptr<const SkinnedBody> skinned_;
  HeadMotion scene_motion_, motion_;
  SteeredHead course_;  ///< what motion_ is made of
  Vec3 head_pivot_;     ///< m, the joint that procedural motions turn about
  Simulation simulation_;
  WindControl wind_;
  GuideFrame frame_;
  Status status_;
  Measurement looked_;  ///< of the first looked_at_ strands, since the last status
  size_t looked_at_ = 0;
  std::vector<double> step_ms_;  ///< of the newest steps, a ring
  size_t step_count_ = 0;
  double owed_ = 0;  ///< s of simulation time
  bool shutdown_ = false;
  std::string failure_;                               ///< why it ends by itself
  std::chrono::steady_clock::time_point cast_since_;  ///< of the first frame
  bool paused_ = false;
  /// That a command has asked for while paused, and that are still to be taken.
  struct Steps {
    uint64_t command;
    std::string where;  ///< for errors
    int left;
  };
  std::deque<Steps> steps_;
  std::function<bool(const Simulation&)> takes_another_;
  double pull_until_ = 0;  ///< s of simulation time
  std::set<std::string> told_void_;
  std::function<void(Simulation&)> observer_;
};

/// A number that names one start of a daemon: never 0, different each time.
uint64_t newSession();

}  // namespace strandcast
