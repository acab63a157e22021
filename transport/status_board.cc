#include "transport/status_board.h"

#include <algorithm>
#include <utility>

namespace strandcast {
namespace {
constexpr size_t kMaxDaemons = 1024;
}

bool StatusBoard::post(const WriterId& writer, Status status) {
  const std::lock_guard lock(mutex_);
  if (entries_.size() >= kMaxDaemons && !entries_.contains(writer)) return false;
  Entry& entry = entries_[writer];
  entry.status = std::move(status);
  entry.order = ++arrived_;
  return true;
}

void StatusBoard::remove(const WriterId& writer) {
  const std::lock_guard lock(mutex_);
  entries_.erase(writer);
}

void StatusBoard::clear() {
  const std::lock_guard lock(mutex_);
  entries_.clear();
}

std::vector<Status> StatusBoard::all() const {
  const std::lock_guard lock(mutex_);
  std::vector<const Entry*> sorted;
  for (const auto& [writer, entry] : entries_) sorted.push_back(&entry);
  std::sort(sorted.begin(), sorted.end(), [](const Entry* a, const Entry* b) {
    return std::pair(a->status.groom_id, a->order) < std::pair(b->status.groom_id, b->order);
  });
  std::vector<Status> statuses;
  for (const Entry* entry : sorted) statuses.push_back(entry->status);
  return statuses;
}

std::optional<Status> StatusBoard::ofGroom(uint32_t groom_id, uint64_t session) const {
  const std::lock_guard lock(mutex_);
  const Entry* best = nullptr;
  for (const auto& [writer, entry] : entries_) {
    if (entry.status.groom_id != groom_id) continue;
    if (entry.status.session == session) return entry.status;
    if (!best || entry.order > best->order) best = &entry;
  }
  return best ? std::optional(best->status) : std::nullopt;
}

std::optional<ConflictingDaemon> StatusBoard::conflictOf(uint32_t groom_id, uint64_t own,
                                                         const Condition& counts) const {
  const auto now = std::chrono::steady_clock::now();
  const std::lock_guard lock(mutex_);
  std::optional<ConflictingDaemon> strongest;
  for (const auto& [writer, entry] : entries_) {
    if (entry.status.groom_id != groom_id || entry.status.session == own ||
        (counts && !counts(writer, now - entry.since)))
      continue;
    const ConflictingDaemon conflict = ConflictingDaemon::of(entry.status);
    if (!strongest ||
        std::pair(!conflict.casts, conflict.session) < std::pair(!strongest->casts, strongest->session))
      strongest = conflict;
  }
  return strongest;
}

}  // namespace strandcast
