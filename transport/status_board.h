#pragma once
#include <array>
#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <vector>

#include "transport/messages.h"
#include "transport/publisher.h"

namespace strandcast {

/// The newest status of every live daemon, that is, of every status writer that is matched. Thread-safe.
class StatusBoard {
 public:
  using WriterId = std::array<uint8_t, 16>;  ///< GUID of the status writer
  /// Predicate on a writer and on the time since its first status.
  using Condition = std::function<bool(const WriterId& writer, std::chrono::steady_clock::duration heard)>;

  /// False where it was dropped because the board has too many daemons.
  bool post(const WriterId& writer, Status status);
  /// Removes the status of a writer that has left.
  void remove(const WriterId& writer);
  void clear();

  std::vector<Status> all() const;  ///< by groom id, the newest last within one
  /// That of `session` if present, else the newest of this groom.
  std::optional<Status> ofGroom(uint32_t groom_id, uint64_t session) const;
  /// The rival of session `own` for this groom, as Publisher::rival(); with `counts`, only among those that
  /// satisfy it.
  std::optional<ConflictingDaemon> conflictOf(uint32_t groom_id, uint64_t own,
                                              const Condition& counts = {}) const;

 private:
  struct Entry {
    Status status;
    uint64_t order = 0;                                                              // of arrival
    std::chrono::steady_clock::time_point since = std::chrono::steady_clock::now();  // arrival of the first
  };
  mutable std::mutex mutex_;
  std::map<WriterId, Entry> entries_;
  uint64_t arrived_ = 0;
};

}  // namespace strandcast
