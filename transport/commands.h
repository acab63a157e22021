// Commands: the queue from which a daemon takes them, and their answers.
#pragma once
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <string>

#include "core/error.h"
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

/// The text of the Error that `apply` throws; empty where it throws none.
template <class Apply>
std::string errorTextOf(const Apply& apply) {
  try {
    apply();
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

/// Executes a command by `apply`, which throws Error to refuse it, and writes the answer to `status`.
template <class Apply>
void answerCommand(const Command& command, const Apply& apply, Status& status) {
  status.last_command = command.id;
  status.last_command_error = errorTextOf(apply);
}

/// The newest answers of daemons, kept after their next status and after their end. Thread-safe.
class Answers {
 public:
  /// Records the answer that a status has, if it has one.
  void post(const Status& status);
  /// Empty text when `command` was executed, the reason when it was refused, nothing on timeout.
  std::optional<std::string> wait(uint64_t command, std::chrono::milliseconds timeout) const;

 private:
  struct Answer {
    uint64_t command = 0;
    std::string error;
  };
  const Answer* find(uint64_t command) const;

  mutable std::mutex mutex_;
  mutable std::condition_variable arrived_;
  std::deque<Answer> answers_;
};

}  // namespace strandcast
