#include "apps/answer_wait.h"

#include <utility>

#include "transport/parameter_table.h"

namespace strandcast {
namespace {

double timeStepOf(const Status& status) {
  for (const auto& [name, values] : namedValues(status.parameters))
    if (name == "time_step") return values.front();
  return 0;
}

}  // namespace

bool AnswerWait::isOver(const std::optional<Status>& status) {
  const auto now = std::chrono::steady_clock::now();
  if (steps_ > 0 && status) {
    const double time = status->simulation_time;
    if (!begin_) begin_ = reached_ = time;
    const bool goes_on = std::exchange(reached_, time) != time;
    const double rounding = 0.5 * timeStepOf(*status);
    if (goes_on && time - *begin_ < steps_ * timeStepOf(*status) + rounding) heard_ = now;
  }
  return std::chrono::duration<double>(now - heard_).count() > timeout_;
}

}  // namespace strandcast
