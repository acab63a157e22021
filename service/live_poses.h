// Live sources of poses: programs that move the head, joints, pinned bones and bodies of a daemon's
// simulation (PoseSamples, docs/wire.md).
#pragma once
#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "options/settings.h"
#include "scenes/scene.h"
#include "service/collider_registry.h"
#include "service/pose_clock.h"
#include "service/pose_track.h"
#include "transport/pose_inbox.h"
#include "transport/publisher.h"

namespace strandcast {

class HeadMotionControl;

/// What poses of a message move in one simulation.
class PoseTargets {
 public:
  /// The objects must outlive this.
  PoseTargets(const Scene& scene, Simulation& simulation, HeadMotionControl& head,
              ColliderRegistry& colliders);

  struct Target {
    PosedKind kind = PosedKind::kOther;
    size_t index = 0;           ///< joint of the skinned body, or bone of the model
    std::string body;           ///< name of a collider, which may come later
    Vec3 pivot = Vec3::Zero();  ///< m, at rest
  };
  /// kOther where the simulation has nothing of this name.
  Target find(const PosedName& name) const;
  /// Whether the body's file has this joint or morph target, and it was not read.
  bool isUnreadJoint(const PosedName& name) const;
  bool isUnreadWeight(const std::string& name) const;
  /// Whether the body's file has joints.
  bool hasJoints() const { return !rig_.joints.empty(); }
  /// Indices of the morph targets of a name: each mesh of the skinned body may have one.
  std::vector<size_t> findWeights(const std::string& name) const;
  /// Of a sender's targets the one that carries the hair: the nearest of the joint on which hair grows and
  /// its ancestors, else the head.
  std::optional<size_t> carrier(const std::vector<Target>& targets) const;

  /// Sets the poses of the only sample of `poses` for the end of the next step. What is named stays until
  /// other poses or commands move it; joints and weights until others are named.
  void apply(const PoseSamples& poses);

  /// Something that apply() has set and that stays. `name`: as in a message, or `weight:NAME`.
  struct Held {
    std::string name;
    /// Head and bones: position (m), rotation x y z w. Joints: the first three rows of the matrix of their
    /// motion from rest, and 1 where joints carry the hair, else 0. Weights: one number.
    std::vector<double> values;
  };
  /// All but bodies, which are colliders.
  std::vector<Held> held() const;
  /// Sets it. What the simulation does not have is left out. Throws Error, naming `where`, on values that are
  /// out of range, and changes nothing.
  void restore(const Held& held, const std::string& where);

 private:
  void resolve(const PoseSamples& poses);
  /// Index of the first bone of the model that pins have.
  size_t firstPinned() const;

  Simulation& simulation_;
  HeadMotionControl& head_;
  ColliderRegistry& colliders_;
  const std::shared_ptr<const SkinnedBody> skinned_;
  const BodyRig rig_;
  const Vec3 head_pivot_;
  // Of the poses that apply() had last:
  std::string names_, weight_names_;
  std::vector<Target> targets_;
  std::vector<std::vector<size_t>> weights_;
};

/// Counters since the start, and the latest times, of all live sources.
struct PoseMetrics {
  PoseState state = PoseState::kNone;  ///< of the source that moves the hair
  uint32_t sources = 0;
  uint64_t samples = 0;   ///< taken into tracks
  uint64_t late = 0;      ///< came after their step
  uint64_t lost = 0;      ///< never came; gaps of more than 10,000 samples are jumps of the numbers
  uint64_t repeated = 0;  ///< were here already
  uint64_t refused = 0;   ///< messages: of too many sources, without known names, or for what others move
  uint64_t jumps = 0;     ///< steps that were cuts
  uint64_t relocks = 0;   ///< a source's clock was set, or the daemon skipped poses
  uint64_t interpolated = 0, extrapolated = 0, rested = 0;  ///< steps of that source
  double delay_ms = 0;   ///< for which steps wait behind the fastest samples
  double jitter_ms = 0;  ///< by which the latest sample of the last ten seconds came after the fastest ones
  double age_ms = 0;     ///< of the sample that is shown
  /// From the sample to the frame that shows it, without the least one-way delay; last 1000 frames
  double latency_ms_p50 = 0, latency_ms_p99 = 0;
  double clock_ms = 0;  ///< from sending to arrival by both system clocks, median
};

/// Takes the messages of live sources and sets their poses step by step. A step takes the poses of a sender's
/// time: the end of the step less a delay, which is constant but for the phase of the samples (PoseLock). The
/// daemon's pace follows the sender (wantedAt()).
///
/// Several sources may move different things. What two of them name is moved by the first until that has been
/// silent for 0.5 s. A source that has been silent for 3 s is dropped; what it moved stays where it is. The
/// first step of what carries the hair by another source is a cut.
///
/// Not thread-safe.
class LivePoses {
 public:
  /// The objects must outlive this.
  LivePoses(const Scene& scene, const PoseOptions& options, Simulation& simulation, HeadMotionControl& head,
            ColliderRegistry& colliders, Publisher& publisher);
  ~LivePoses();
  LivePoses(const LivePoses&) = delete;
  LivePoses& operator=(const LivePoses&) = delete;

  /// Takes the messages that are here, and sets the poses for the step that ends at `end`, s of simulation.
  /// True where the motion jumps: the caller calls Simulation::jumpToPoses() once all poses are set.
  /// `now`: ns, steady clock.
  bool advance(double end, int64_t now);
  /// In place of advance() in the frames of a paused simulation: the next step takes the newest poses.
  void idle(double end, int64_t now);
  /// The machine does not keep the pace of the sources: they are locked anew.
  void release();
  /// A source's delay, ns: simulation time less the sender's.
  struct Delay {
    uint64_t source = 0;
    int64_t ns = 0;
    uint32_t locks = 0;  ///< of this daemon to the source, since its first message
  };
  /// Of all sources that are locked.
  std::vector<Delay> delays() const;
  /// Takes the delay of the daemon that casts, so that a standby's steps take the same samples. Nothing
  /// happens where the source is not heard here.
  void adopt(const Delay& delay);
  /// What sources have left that are no longer heard. Bodies are left out: they are colliders.
  std::vector<PoseTargets::Held> held() const;
  /// Takes that of another daemon, but for what a source moves here. Throws Error, naming `where`.
  void restore(const PoseTargets::Held& held, const std::string& where);
  /// In place of messages, the poses of a recording: those for a step, by Simulation::steps() before it.
  using Recorded = std::function<std::optional<StepPoses>(uint64_t step)>;
  void setRecorded(Recorded recorded) { recorded_ = std::move(recorded); }

  /// Steady time at which the poses of the step that ends at `end` are here, of the slowest source; none
  /// without sources.
  std::optional<std::chrono::steady_clock::time_point> wantedAt(double end) const;
  /// The source and time of the newest sample in the present poses of what carries the hair; 0 where it has
  /// none.
  uint64_t source() const { return shown_source_; }
  uint64_t time() const { return shown_time_; }
  /// Counts a frame that is published at `now`.
  void countFrame(int64_t now);
  PoseMetrics metrics(int64_t now) const;

  /// Throw Error, naming `where`, while a source moves the head or a joint that carries it, or this collider.
  void checkHeadFree(const std::string& where) const;
  void checkBodyFree(const std::string& name, const std::string& where) const;

 private:
  struct Source;

  void receive(double end, int64_t now);
  void receive(PoseSamples message, int64_t end_ns);
  Source* sourceOf(const PoseSamples& message);
  /// Adopts the names of a message. False where they are not known.
  bool adoptNames(Source& source, const PoseSamples& message);
  void addSamples(Source& source, const PoseSamples& message);
  /// Decides which source moves what.
  void assign(int64_t now);
  /// Takes the poses of a source into step_. True where they are a cut.
  bool take(Source& source, int64_t end_ns, int64_t step_ns);
  void append(const Source& source, const PoseSample& shown);
  /// The source that moves the hair.
  const Source* carrier() const;
  /// Warns of what the simulation does not have of a sender's names.
  void warnOfNames(const Source& source, const PoseSamples& message) const;
  [[noreturn]] static void refuse(uint64_t source, const std::string& what, const std::string& where);

  const PoseOptions options_;
  Simulation& simulation_;
  Publisher& publisher_;
  PoseTargets targets_;
  Recorded recorded_;
  std::vector<std::unique_ptr<Source>> sources_;  ///< in the order in which they came
  std::map<std::string, uint64_t> owners_;        ///< source by what it moves: a name of its messages
  StepPoses step_;
  uint64_t shown_source_ = 0, shown_time_ = 0;
  PoseMetrics counters_;                          ///< those that count
  std::vector<double> latencies_ms_, clocks_ms_;  ///< rings
  size_t latencies_ = 0, clocks_ = 0;
  bool has_refused_source_ = false;
};

}  // namespace strandcast
