#include "apps/conflict_detector.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "core/error.h"

namespace strandcast {
namespace {

/// Frame counts that differ by no more than this count as equal: statuses come only twice a second.
constexpr uint64_t kFrameTolerance = 120;

/// Both daemons reach the same decision, because the frame count that a status carries is never ahead of the
/// real count.
bool mustYield(uint64_t session, uint64_t frames, const ConflictingDaemon& conflict) {
  if (conflict.frames > frames + kFrameTolerance) return true;
  if (frames > conflict.frames + kFrameTolerance) return false;
  return session > conflict.session;
}

}  // namespace

std::optional<std::string> ConflictDetector::check(const Publisher& publisher, uint64_t session,
                                                   uint64_t frames,
                                                   std::chrono::steady_clock::duration casting) {
  const std::optional<ConflictingDaemon> conflict = publisher.conflict();
  if (!conflict || !conflict->casts) return std::nullopt;
  if (casting < kConflictWindow && mustYield(session, frames, *conflict))
    return Error(fmt::format("another daemon also publishes groom {}, and was discovered late", groom_id_),
                 fmt::format("session {:016x}", conflict->session),
                 "stop it (`strandcast ctl stop`) or choose another --groom-id")
        .what();
  if (conflict->session == warned_) return std::nullopt;
  warned_ = conflict->session;
  spdlog::warn(
      "another daemon, session {:016x}, also publishes groom {}, and readers may receive either: stop one of "
      "them",
      warned_, groom_id_);
  return std::nullopt;
}

}  // namespace strandcast
