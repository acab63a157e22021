#pragma once
#include <atomic>
#include <chrono>
#include <exception>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "apps/daemon.h"
#include "apps/settings.h"
#include "transport/subscriber.h"

namespace strandcast {

class ProgressBar;

/// The network of these settings for messages: "DDS domain 3".
std::string networkName(const Settings& settings);
/// Joins the network as a reader of settings.groom_id.
std::unique_ptr<Subscriber> subscribe(const Settings& settings);
/// Joins the network to send commands to the daemon of settings.groom_id. Receives statuses and answers, no
/// frames.
std::unique_ptr<Subscriber> joinForCommands(const Settings& settings);
/// A daemon's claim to settings.groom_id while it starts. Other daemons hear the claim from the beginning,
/// and it listens for theirs while the scene loads. An LCM log has no other daemons: await() returns at once.
class GroomClaim {
 public:
  /// Joins the network. Throws Error.
  GroomClaim(const Settings& settings, uint64_t session);
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

/// Called with the simulation after each frame, in the daemon's thread.
using SimulationObserver = std::function<void(Simulation&)>;

/// A daemon in a thread of this process that publishes over the in-process channel: `strandcast view
/// --scene`.
class EmbeddedDaemon {
 public:
  /// Makes the scene first, with a progress bar; throws Error.
  explicit EmbeddedDaemon(const Settings& settings, SimulationObserver observer = {});
  ~EmbeddedDaemon();
  Subscriber& subscriber() { return *subscriber_; }
  /// Rethrows the Error that ended the daemon, if any.
  void checkAlive() const;
  /// Whether the daemon has stopped casting.
  bool hasEnded() const { return has_ended_; }

 private:
  std::unique_ptr<Publisher> publisher_;
  std::unique_ptr<Subscriber> subscriber_;
  std::unique_ptr<Daemon> daemon_;
  std::atomic<bool> stop_{false}, has_ended_{false};
  mutable std::mutex mutex_;
  std::exception_ptr failure_;
  std::thread thread_;
};

/// The source of a renderer's frames: a daemon on the network or, with `here`, one in this process. The
/// subscriber interface is the same for both.
class Stream {
 public:
  /// Waits for groom and body; throws Error after `timeout` seconds. `observer` is called only for a daemon
  /// in this process.
  Stream(const Settings& settings, bool here, double timeout, SimulationObserver observer = {});
  Subscriber& subscriber() { return embedded_ ? embedded_->subscriber() : *remote_; }
  /// As EmbeddedDaemon::checkAlive(). Does nothing for a daemon on the network, which may stop and return.
  void checkAlive() const {
    if (embedded_) embedded_->checkAlive();
  }
  bool hasEnded() const { return embedded_ && embedded_->hasEnded(); }

 private:
  std::unique_ptr<EmbeddedDaemon> embedded_;
  std::unique_ptr<Subscriber> remote_;
};

/// Logs the expected duration of a bake where it is a second or more, for output without a progress bar.
/// `bar` must outlive the result.
BakeAnnouncement announceBakes(ProgressBar& bar);
/// The user's cache folder of distance fields; empty, with a warning, where there is none.
std::filesystem::path fieldCacheWithProgress();
/// makeScene() with a progress bar, the user's field cache and logged notes. Ctrl-C stops it: throws
/// BakeStopped. `meanwhile` (may be empty) is called periodically; an exception from it stops the work and
/// propagates.
Scene makeSceneWithProgress(SceneOptions options, const std::function<void()>& meanwhile = {});

}  // namespace strandcast
