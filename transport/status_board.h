#pragma once
#include <array>
#include <cstdint>
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

  /// False where it was not taken: there are too many daemons.
  bool post(const WriterId& writer, Status status);
  void remove(const WriterId& writer);
  void clear();

  std::vector<Status> all() const;  ///< by groom id, the newest last within one
  /// Of `session` when it is there, else the newest of this groom.
  std::optional<Status> ofGroom(uint32_t groom_id, uint64_t session) const;
  /// Who casts this groom besides session `own`, as Publisher::rival().
  std::optional<Rival> rivalOf(uint32_t groom_id, uint64_t own) const;

 private:
  struct Entry {
    Status status;
    uint64_t order = 0;  // of arrival
  };
  mutable std::mutex mutex_;
  std::map<WriterId, Entry> entries_;
  uint64_t arrived_ = 0;
};

}  // namespace strandcast
