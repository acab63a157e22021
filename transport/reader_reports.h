// What a daemon knows of its readers.
#pragma once
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>

#include "transport/publisher.h"
#include "transport/wire_fields.h"

namespace strandcast {

/// The newest report of each reader. A reader that was silent for 3 s is forgotten. Thread-safe.
class ReaderReports {
 public:
  using Clock = std::chrono::steady_clock;
  /// Drops reports that are not sound, and those of further readers beyond 4096.
  void add(const ReaderReport& report, Clock::time_point now = Clock::now());
  size_t count(Clock::time_point now = Clock::now()) const;
  ReaderSummary summary(Clock::time_point now = Clock::now()) const;
  /// Bits of ReaderReport::Wants: what some reader has lacked for more than a second. Each lack is returned
  /// again after another second.
  uint32_t takeOverdue(Clock::time_point now = Clock::now());

 private:
  struct Entry {
    ReaderReport report;
    Clock::time_point heard;
    Clock::time_point lacks_since;  // since it lacks something, or was returned by takeOverdue()
  };
  void forgetSilent(Clock::time_point now) const;

  mutable std::mutex mutex_;
  mutable std::map<uint64_t, Entry> readers_;  // by ReaderReport::reader
};

}  // namespace strandcast
