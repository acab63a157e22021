#pragma once
#include <deque>
#include <mutex>
#include <optional>

#include "transport/messages.h"

namespace strandcast {

inline constexpr size_t kMaxQueuedCommands = 1024;
/// Commands that a daemon executes before a frame, so that a flood of commands does not stop the simulation.
/// The others wait.
inline constexpr size_t kMaxCommandsPerFrame = 64;
static_assert(kMaxCommandsPerFrame <= kMaxQueuedCommands, "a recording's frame has no more inputs");

/// Commands that a daemon has yet to take, in the order of arrival. A repetition, sent because the sender
/// received no answer, is taken once. Thread-safe.
class CommandQueue {
 public:
  /// Beyond kMaxQueuedCommands the oldest are dropped.
  void push(Command command);
  /// The oldest command, or nothing.
  std::optional<Command> take();

 private:
  std::mutex mutex_;
  std::deque<Command> waiting_;
  std::deque<uint64_t> seen_;  // ids of the last kMaxQueuedCommands commands received
};

}  // namespace strandcast
