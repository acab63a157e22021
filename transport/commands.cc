#include "transport/commands.h"

#include <algorithm>
#include <utility>

namespace strandcast {

void CommandQueue::push(Command command) {
  const std::lock_guard lock(mutex_);
  if (std::find(seen_.begin(), seen_.end(), command.id) != seen_.end()) return;
  seen_.push_back(command.id);
  if (seen_.size() > kMaxQueuedCommands) seen_.pop_front();
  waiting_.push_back(std::move(command));
  if (waiting_.size() > kMaxQueuedCommands) waiting_.pop_front();
}

std::optional<Command> CommandQueue::take() {
  const std::lock_guard lock(mutex_);
  if (waiting_.empty()) return std::nullopt;
  Command command = std::move(waiting_.front());
  waiting_.pop_front();
  return command;
}

namespace {
constexpr size_t kMaxAnswers = 256;
}

void Answers::post(const Status& status) {
  const std::lock_guard lock(mutex_);
  if (status.last_command == 0 || find(status.last_command)) return;
  if (answers_.size() == kMaxAnswers) answers_.pop_front();
  answers_.push_back({status.last_command, status.last_command_error});
  arrived_.notify_all();
}

std::optional<std::string> Answers::wait(uint64_t command, std::chrono::milliseconds timeout) const {
  std::unique_lock lock(mutex_);
  const Answer* answer = nullptr;
  arrived_.wait_for(lock, timeout, [&] { return (answer = find(command)) != nullptr; });
  return answer ? std::optional(answer->error) : std::nullopt;
}

const Answers::Answer* Answers::find(uint64_t command) const {
  const auto found = std::find_if(answers_.begin(), answers_.end(),
                                  [&](const Answer& answer) { return answer.command == command; });
  return found == answers_.end() ? nullptr : &*found;
}

}  // namespace strandcast
