// Commands of users and clients: limits, values, names, and how long an answer may take.
#pragma once
#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry.h"
#include "transport/messages.h"

namespace strandcast {

constexpr double kFarthestPlace = 1000;   ///< m, per axis, for positions in commands
constexpr double kRampSeconds = 0.2;      ///< default duration of a smooth motion by command
constexpr double kLongestWay = 3600;      ///< s, longest duration of a motion by command
constexpr int kMaxRequestedSteps = 1000;  ///< limit on outstanding steps requested by commands
constexpr size_t kMaxWindSources = 64;    ///< limit on the sources that commands may leave a daemon with

/// A command's name in errors, in the words of `strandcast ctl`: "strandcast ctl collider move rod".
std::string commandText(const Command& command);
/// Reads a pose from a command's values at `first`: position x y z (m, each within kFarthestPlace), rotation
/// x y z w (length 0.5 to 1.5, then normalised). Precondition: values has first + 7 elements. Throws Error,
/// naming `where`.
Pose commandedPose(const std::vector<double>& values, size_t first, const std::string& where);
/// Appends the seven values of a pose.
void appendPose(std::vector<double>& values, const Pose& pose);

/// The pose after `seconds` of a motion by command from one pose to another over `of` seconds, then still.
/// Velocity is continuous.
Pose poseBetween(const Pose& from, const Pose& to, double seconds, double of);

/// Decides how long to wait for the answer to a command. The daemon answers a step command after its last
/// step, and after all steps requested before; until then simulation time advances. A daemon whose time
/// advances by more than `steps` time steps has not received the command.
class AnswerWait {
 public:
  /// `timeout`: s, of silence from the daemon. `steps`: steps that may be taken before the answer; 0 for
  /// commands other than step.
  AnswerWait(double timeout, double steps) : timeout_(timeout), steps_(steps) {}
  /// `status`: the daemon's newest status. True once the timeout has passed without progress.
  bool isOver(const std::optional<Status>& status);

 private:
  const double timeout_, steps_;
  std::optional<double> begin_;  ///< s of simulation time, as is reached_
  double reached_ = 0;
  std::chrono::steady_clock::time_point heard_ = std::chrono::steady_clock::now();
};

}  // namespace strandcast
