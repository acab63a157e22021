#pragma once
#include <chrono>
#include <optional>

#include "transport/messages.h"

namespace strandcast {

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
