#pragma once
#include <deque>
#include <mutex>
#include <optional>

#include "transport/messages.h"

namespace strandcast {

inline constexpr size_t kMaxQueuedCommands = 1024;
/// That a daemon obeys before it casts the next frame: a flood of them does not hold the hair. The others
/// wait.
inline constexpr size_t kMaxCommandsPerFrame = 64;
static_assert(kMaxCommandsPerFrame <= kMaxQueuedCommands, "a recording's frame has no more inputs");

/// Commands that a daemon has yet to take, in the order of arrival. One that arrives again, because its
/// sender heard no answer, is taken once. Thread-safe.
class CommandQueue {
 public:
  /// Beyond kMaxQueuedCommands the oldest go.
  void push(Command command);
  std::optional<Command> take();

 private:
  std::mutex mutex_;
  std::deque<Command> waiting_;
  std::deque<uint64_t> seen_;  // ids of the last kMaxQueuedCommands that came
};

}  // namespace strandcast
