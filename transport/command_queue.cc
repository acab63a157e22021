#include "transport/command_queue.h"

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

}  // namespace strandcast
