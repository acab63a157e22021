#include "apps/rival_watch.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "core/error.h"

namespace strandcast {
namespace {

/// Frame counts that differ by no more than this count as equal: statuses come only twice a second.
constexpr uint64_t kAlike = 120;

/// Both daemons reach the same decision, because the frame count that a status carries is never ahead of the
/// real count.
bool givesWay(uint64_t session, uint64_t frames, const Rival& rival) {
  if (rival.frames > frames + kAlike) return true;
  if (frames > rival.frames + kAlike) return false;
  return session > rival.session;
}

}  // namespace

std::optional<std::string> RivalWatch::look(const Publisher& publisher, uint64_t session, uint64_t frames,
                                            std::chrono::steady_clock::duration casting) {
  const std::optional<Rival> rival = publisher.rival();
  if (!rival || !rival->casts) return std::nullopt;
  if (casting < kSecondThoughts && givesWay(session, frames, *rival))
    return Error(fmt::format("another daemon also publishes groom {}, and was discovered late", groom_id_),
                 fmt::format("session {:016x}", rival->session),
                 "stop it (`strandcast ctl stop`) or choose another --groom-id")
        .what();
  if (rival->session == warned_) return std::nullopt;
  warned_ = rival->session;
  spdlog::warn(
      "another daemon, session {:016x}, also publishes groom {}, and readers may receive either: stop one of "
      "them",
      warned_, groom_id_);
  return std::nullopt;
}

}  // namespace strandcast
