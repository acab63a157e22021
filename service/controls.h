// What commands control of a simulation, a class each: parameters, the head's motion, the hand, pause and
// single steps, and the sources of wind. In all of them a refused command throws Error, naming `where`, and
// changes nothing (strong exception guarantee). A Simulation that is passed to a constructor must outlive the
// object.
#pragma once
#include <array>
#include <deque>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "air/wind_source.h"
#include "core/simulation.h"
#include "options/settings.h"
#include "scenes/head_motion.h"
#include "scenes/skinned_body.h"
#include "service/collider_registry.h"
#include "service/live_poses.h"
#include "transport/messages.h"
#include "transport/publisher.h"

namespace strandcast {

/// The motion of a daemon's head as set by commands and the scene. Plain data, so that another daemon can
/// take it over.
struct HeadControl {
  enum class Kind {
    kScene,  ///< the scene's own motion
    kNamed,  ///< blends from `from` into the procedural motion `name`
    kPose    ///< moves from `from` to `to`, then stays
  };
  Kind kind = Kind::kScene;
  std::string name;
  Pose from, to;
  double start = 0;  ///< s of simulation time

  bool operator==(const HeadControl& other) const;
};

/// The motion as a function of seconds since control.start. `scene`: the scene's own motion; procedural
/// motions turn about `pivot`, m. Throws Error on an unknown motion.
HeadMotion motionOf(const HeadControl& control, const HeadMotion& scene, const Vec3& pivot);

/// The head's motion by commands: docs/wire.md, kinds 1 and 2. A clip of the body goes on and carries the
/// head.
class HeadMotionControl {
 public:
  /// Procedural motions turn about `pivot`, m. `skinned`: the body that the head's motion moves; may be null.
  HeadMotionControl(HeadMotion scene_motion, const Vec3& pivot, std::shared_ptr<const SkinnedBody> skinned,
                    Simulation& simulation)
      : scene_motion_(std::move(scene_motion)),
        motion_(scene_motion_),
        pivot_(pivot),
        skinned_(std::move(skinned)),
        simulation_(simulation) {}

  /// Execute the commands of kinds 1 and 2. Only procedural motions have names: files belong to another
  /// machine.
  void moveTo(const Command& command, const std::string& where);
  void play(const Command& command);
  /// Throws Error on an unknown motion.
  void set(HeadControl control);
  const HeadControl& control() const { return control_; }

  // Poses by live sources (LivePoses), in place of the motion and of the body's clip. They stay until set().
  // The indices are those of the skinned body.
  void poseHead(const Pose& head) { posed_.head = head; }
  /// Joints without a motion follow their ancestors: SkinnedBody::fromPalette(). Where the joint carries the
  /// hair, no motion of the head is added.
  void poseJoint(size_t joint, const Placement& motion);
  void releaseJoints() {
    posed_.joints.clear();
    posed_.joints_carry_hair = false;
  }
  /// Targets without a weight are as at rest.
  void weigh(size_t target, float weight);
  void releaseWeights() { posed_.weights.clear(); }
  /// What these poses have set and is in force.
  struct Posed {
    std::optional<Pose> head;
    std::vector<std::optional<Placement>> joints;  ///< per joint, or empty: the clip's
    bool joints_carry_hair = false;                ///< they have the whole motion of the head
    std::vector<float> weights;                    ///< per morph target, or empty: the clip's
  };
  const Posed& posed() const { return posed_; }
  /// Says in place of poseJoint() whether the joints carry the hair: set() has ended that, or has not.
  void carryHairByJoints(bool is_carried) { posed_.joints_carry_hair = is_carried; }

  /// Sets the poses of head, roots and parts of the body for `time`, s of simulation: the end of the next
  /// step.
  void advance(double time);

 private:
  /// The head pose of the motion alone, without clip or palette.
  Pose motionPose() const;
  /// State of the skinned body at `time`, with the head's motion at `head`.
  SkinnedBody::Moment momentAt(double time, const Pose& head) const;

  HeadMotion scene_motion_, motion_;
  HeadControl control_;  ///< the source of motion_
  Posed posed_;
  bool has_warned_ = false;
  Vec3 pivot_;
  std::shared_ptr<const SkinnedBody> skinned_;
  Simulation& simulation_;
};

/// Parameters by commands: docs/wire.md, kind 0.
class ParameterControl {
 public:
  explicit ParameterControl(Simulation& simulation) : simulation_(simulation) {}

  /// Executes the command. Warns once of a parameter that has no effect with the other parameters.
  void set(const Command& command, const std::string& where);
  /// Appends the parameters that were set and have no effect now.
  void appendUnused(ParameterTable& table) const;

 private:
  Simulation& simulation_;
  std::set<std::string> unused_;  ///< parameters that had no effect when they were set
};

/// The hand that pulls hair by commands: docs/wire.md, kind 7.
class HandControl {
 public:
  explicit HandControl(Simulation& simulation) : simulation_(simulation) {}

  /// Executes the command; one without values releases the hair.
  void pull(const Command& command, const std::string& where);
  /// Releases the hair where the newest pull is over: a second of simulation time after its command.
  void releaseIfOver();

  static constexpr size_t kStateValues = 9;
  /// The values of the newest pull and its end, s of simulation time; empty where no hair is pulled.
  std::vector<double> state() const;
  /// Continues a pull from a state(). Throws Error.
  void restoreFrom(std::span<const double> state);

 private:
  void apply(std::span<const double> pull);

  Simulation& simulation_;
  std::array<double, kStateValues - 1> last_pull_{};
  double end_ = 0;  ///< s of simulation time
};

/// Pause, and the single steps that commands request meanwhile: docs/wire.md, kinds 5 and 6.
class StepSchedule {
 public:
  /// Steps that a command has requested and that are outstanding.
  struct Request {
    uint64_t command;
    std::string where;  ///< for errors
    int left;
  };

  void pause(bool paused) { paused_ = paused; }
  bool isPaused() const { return paused_; }
  /// Throws Error unless the simulation is paused.
  void checkPaused(const std::string& where) const;
  /// Throws Error where more than kMaxRequestedSteps would be outstanding.
  void request(uint64_t command, const std::string& where, int count);
  const std::deque<Request>& requests() const { return requests_; }
  /// Counts a step of the first request. True where it was the last one; the caller answers, then calls
  /// pop().
  bool countStep() { return --requests_.front().left <= 0; }
  void pop() { requests_.pop_front(); }

  /// Continues the schedule of another daemon: clear(), then its requests.
  void clear();
  void restore(Request request) { requests_.push_back(std::move(request)); }

 private:
  bool paused_ = false;
  std::deque<Request> requests_;
};

/// A daemon's wind sources as commands change them: docs/wire.md, kinds 11 to 13.
class WindControl {
 public:
  /// `sources`: those that `simulation` was made with.
  WindControl(std::vector<NamedWindSource> sources, Simulation& simulation)
      : sources_(std::move(sources)), simulation_(simulation) {}

  /// Execute the commands of kinds 11, 12 and 13.
  void add(const Command& command, const std::string& where);
  void move(const Command& command, const std::string& where);
  void remove(const Command& command, const std::string& where);
  /// Moves sources to `time`, s of simulation: the end of the next step.
  void advance(double time);

  const std::vector<NamedWindSource>& sources() const { return sources_; }
  /// The motion of some parts of a source, until its end.
  struct Ramp {
    std::string name;
    WindSourceParts parts;
    WindSource from, to;
    double start, seconds;  ///< of simulation time
  };
  const std::vector<Ramp>& tweens() const { return tweens_; }
  /// Replaces sources and motions by those of another daemon. Throws Error, naming `where`, on invalid ones,
  /// and changes nothing.
  void restoreFrom(std::vector<NamedWindSource> sources, std::vector<Ramp> tweens, const std::string& where);

 private:
  NamedWindSource& find(const std::string& name, const std::string& where);
  /// Sets the simulation's sources; sources_ takes them only where that succeeds.
  void replace(std::vector<NamedWindSource> sources, const std::string& where);

  std::vector<NamedWindSource> sources_;
  std::vector<Ramp> tweens_;
  Simulation& simulation_;
};

/// The values of a command that adds a source: kind, position, direction, and windSourceNumbers() in SI.
std::vector<double> windSourceValues(const WindSource& source);
/// Parses such values. Throws Error, naming `where`, on invalid ones.
WindSource windSourceOf(const std::vector<double>& values, const std::string& where);
/// The values of a command that moves a source: parts, duration in s, and these parts of `to`, in the order
/// of windSourceValues().
std::vector<double> windMoveValues(const WindSource& to, WindSourceParts parts, double seconds);

/// A daemon's simulation with all that commands control of it, and that a show is a snapshot of. Each part
/// keeps its own invariants, so the parts are public.
struct ControlledSimulation {
  /// Makes the simulation. Colliders are announced to `publisher`, which must outlive this. Throws Error.
  ControlledSimulation(const Settings& settings, const Scene& scene, Publisher& publisher, uint64_t session);
  ControlledSimulation(const ControlledSimulation&) = delete;
  ControlledSimulation& operator=(const ControlledSimulation&) = delete;

  /// Takes a step: live sources, head, colliders and wind move to its end. Returns the number of strands that
  /// were reset because they had diverged.
  size_t advance();
  /// Moves head and colliders to where they are at `time`, s of simulation.
  void moveTo(double time);
  /// Resets the hair. Motions of head and bodies, parameters, wind and simulation time are kept.
  void reset();
  /// What commands control, by name: docs/wire.md, "Status".
  ParameterTable table() const;

  Simulation simulation;
  ParameterControl parameters;
  HeadMotionControl head;
  WindControl wind;
  HandControl hand;
  ColliderRegistry colliders;
  LivePoses poses;
  StepSchedule steps;
  uint32_t resets = 0;  ///< since the start of the show
  uint32_t cuts = 0;    ///< jumps of the motion by live sources
};

}  // namespace strandcast
