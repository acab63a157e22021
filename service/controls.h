// The head's motion and the sources of wind as commands control them.
#pragma once
#include <string>
#include <vector>

#include "air/wind_source.h"
#include "core/simulation.h"
#include "scenes/head_motion.h"
#include "transport/messages.h"

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

/// The pose after `seconds` of a motion from one pose to another over `of` seconds, then still. Velocity is
/// continuous.
Pose poseBetween(const Pose& from, const Pose& to, double seconds, double of);

/// A daemon's wind sources as commands change them: docs/wire.md, kinds 11 to 13. A refused command throws
/// Error, naming `where`, and changes nothing (strong exception guarantee).
class WindControl {
 public:
  /// `sources`: those that `simulation` was made with. `simulation` must outlive this.
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

}  // namespace strandcast
