#pragma once
#include <string>
#include <vector>

#include "air/wind_source.h"
#include "core/simulation.h"
#include "transport/messages.h"

namespace strandcast {

/// The sources of wind of a daemon as commands change them: docs/wire.md, kinds 11 to 13. Commands
/// that it refuses throw Error, naming `where`, and leave everything as it was.
class WindControl {
 public:
  /// Those that `simulation` was made with. It outlives this.
  WindControl(std::vector<NamedWindSource> sources, Simulation& simulation)
      : sources_(std::move(sources)), simulation_(simulation) {}

  void add(const Command& command, const std::string& where);
  void move(const Command& command, const std::string& where);
  void remove(const Command& command, const std::string& where);
  /// Where moves have them at `time`, s of simulation: the end of the step that follows.
  void goOn(double time);

  const std::vector<NamedWindSource>& sources() const { return sources_; }
  /// Of some parts of a source, until they are there.
  struct Way {
    std::string name;
    WindSourceParts parts;
    WindSource from, to;
    double start, seconds;  ///< of simulation time
  };
  const std::vector<Way>& ways() const { return ways_; }
  /// These in place of its own, as another daemon has them. Throws Error, naming `where`, where they are not
  /// sound, and leaves everything as it was.
  void goOnWith(std::vector<NamedWindSource> sources, std::vector<Way> ways, const std::string& where);

 private:
  NamedWindSource& find(const std::string& name, const std::string& where);
  /// Has the simulation blow with these in place of sources_, from which one came or went.
  void replace(std::vector<NamedWindSource> sources, const std::string& where);

  std::vector<NamedWindSource> sources_;
  std::vector<Way> ways_;
  Simulation& simulation_;
};

/// The parts that a source of this kind uses: a cone no radius and swirl, a turbine no angle, a sphere
/// position, radius and speed alone.
WindSourceParts partsOf(WindSource::Kind kind);
/// "direction, angle" of those of `parts` that a source of this kind does not use; empty where it uses all.
std::string unusedParts(WindSource::Kind kind, WindSourceParts parts);

/// The numbers of a command that adds a source: kind, position, direction, and windSourceNumbers() in SI.
std::vector<double> windSourceValues(const WindSource& source);
/// The source of these values; throws Error, naming `where`, where they are not sound.
WindSource windSourceOf(const std::vector<double>& values, const std::string& where);
/// Those of one that moves it: which parts, the seconds that it takes, and these parts of `to`, in the order
/// of windSourceValues().
std::vector<double> windMoveValues(const WindSource& to, WindSourceParts parts, double seconds);

}  // namespace strandcast
