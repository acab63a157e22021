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

/// Why `apply` refuses, by an Error; empty where it carries out what it is to.
template <class Apply>
std::string refusalOf(const Apply& apply) {
  try {
    apply();
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

/// Carries out a command by `apply`, which throws Error where it refuses, and answers it in `status`.
template <class Apply>
void answerCommand(const Command& command, const Apply& apply, Status& status) {
  status.last_command = command.id;
  status.last_command_error = refusalOf(apply);
}

/// What daemons answered to the newest commands: kept when their next status, or their end, comes before
/// anyone has looked. Thread-safe.
class Answers {
 public:
  void post(const Status& status);
  /// Empty text when `command` was carried out, the reason when it was refused, nothing on timeout.
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
