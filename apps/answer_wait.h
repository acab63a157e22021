#pragma once
#include <chrono>
#include <optional>

#include "transport/messages.h"

namespace strandcast {

/// How long the answer to a command is waited for. Steps are answered when the last is taken, and all that
/// were asked for before: until then the simulation goes on. One that goes on beyond kMostSteps has not heard
/// of the command.
class AnswerWait {
 public:
  /// `timeout`: s, of the daemon's silence. `steps`: that may be taken before the answer; 0 of other
  /// commands.
  AnswerWait(double timeout, double steps) : timeout_(timeout), steps_(steps) {}
  /// `status`: the daemon's newest.
  bool isOver(const std::optional<Status>& status);

 private:
  const double timeout_, steps_;
  std::optional<double> begin_;  ///< s of simulation, as are these
  double reached_ = 0;
  std::chrono::steady_clock::time_point heard_ = std::chrono::steady_clock::now();
};

}  // namespace strandcast
