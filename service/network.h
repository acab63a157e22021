// Joining the network that settings name, the claim to a groom, and daemons that conflict over it.
#pragma once
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "options/settings.h"
#include "transport/publisher.h"
#include "transport/subscriber.h"

namespace strandcast {

/// A random session number that identifies one start of a daemon; never 0.
uint64_t newSession();

/// The network of these settings for messages: "DDS domain 3".
std::string networkName(const Settings& settings);
/// Joins the network as a reader of settings.groom_id.
std::unique_ptr<Subscriber> subscribe(const Settings& settings);
/// Joins the network to send commands to the daemon of settings.groom_id. Receives statuses and answers, no
/// frames.
std::unique_ptr<Subscriber> joinForCommands(const Settings& settings);
/// Joins the network as the daemon of settings.groom_id. Throws Error.
std::unique_ptr<Publisher> joinAsDaemon(const Settings& settings, uint64_t session);
/// A daemon's claim to settings.groom_id while it starts. Other daemons hear the claim from the beginning,
/// and it listens for theirs while the scene loads. An LCM log has no other daemons: await() returns at once.
class GroomClaim {
 public:
  /// Joins the network. Throws Error.
  GroomClaim(const Settings& settings, uint64_t session)
      : GroomClaim(settings, session, joinAsDaemon(settings, session)) {}
  /// `channel`: of the groom and the session.
  GroomClaim(const Settings& settings, uint64_t session, std::unique_ptr<Publisher> channel);
  /// Throws Error where another daemon that has been heard so far holds the groom. Callable from any thread,
  /// one at a time.
  void check();
  /// Listens until any conflicting daemon would have been heard, and logs a line where that takes over 0.3 s.
  /// Throws as check(), and Interrupted on Ctrl-C.
  void await();
  /// Transfers ownership of the channel; call once. The channel must outlive this claim.
  std::unique_ptr<Publisher> take() { return std::move(owned_); }

 private:
  const Settings settings_;
  const uint64_t session_;
  std::chrono::steady_clock::time_point joined_;
  std::optional<std::chrono::steady_clock::time_point> conflict_heard_;
  std::unique_ptr<Publisher> owned_;
  Publisher* publisher_;
};
/// Claims without a scene to load meanwhile: joins, awaits, and returns the channel. Throws as GroomClaim.
std::unique_ptr<Publisher> claimGroom(const Settings& settings, uint64_t session);

/// Period after a daemon's first frame in which it gives way to a daemon that has cast the same groom for
/// longer.
inline constexpr std::chrono::seconds kConflictWindow{10};

/// Detects other daemons that cast the same groom. A starting daemon listens for them first (GroomClaim),
/// but a busy network may delay their messages, and a third-party daemon may not listen at all.
class ConflictDetector {
 public:
  explicit ConflictDetector(uint32_t groom_id) : groom_id_(groom_id) {}
  /// Returns why the daemon of `session`, which has cast `frames` frames for `casting`, must end: a
  /// conflicting daemon was heard late that has cast for longer, or equally long with the lower session. For
  /// any other one it logs a warning, once each, and returns empty.
  std::optional<std::string> check(const Publisher& publisher, uint64_t session, uint64_t frames,
                                   std::chrono::steady_clock::duration casting);

 private:
  uint32_t groom_id_;
  uint64_t warned_ = 0;  ///< session of the daemon warned of last
};

}  // namespace strandcast
