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

/// The newest status of every daemon that is alive: those whose writer is matched. Thread-safe.
class StatusBoard {
 public:
  using WriterId = std::array<uint8_t, 16>;  ///< GUID of the status writer
  /// Of a writer, and for how long there has been a status of it.
  using Condition = std::function<bool(const WriterId& writer, std::chrono::steady_clock::duration heard)>;

  /// False where it was not taken: there are too many daemons.
  bool post(const WriterId& writer, Status status);
  void remove(const WriterId& writer);
  void clear();

  std::vector<Status> all() const;  ///< by groom id, the newest last within one
  /// Of `session` when it is there, else the newest of this groom.
  std::optional<Status> ofGroom(uint32_t groom_id, uint64_t session) const;
  /// Who casts this groom besides session `own`, as Publisher::rival(); with `counts`, of those that do.
  std::optional<Rival> rivalOf(uint32_t groom_id, uint64_t own, const Condition& counts = {}) const;

 private:
  struct Entry {
    Status status;
    uint64_t order = 0;                                                              // of arrival
    std::chrono::steady_clock::time_point since = std::chrono::steady_clock::now();  // of the first
  };
  mutable std::mutex mutex_;
  std::map<WriterId, Entry> entries_;
  uint64_t arrived_ = 0;
};

}  // namespace strandcast
