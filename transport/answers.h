#pragma once
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <string>

#include "transport/messages.h"

namespace strandcast {

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
