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

/// The network of these settings, for messages: "DDS domain 3".
std::string networkName(const Settings& settings);
/// Joins the network as a reader of settings.groom_id.
std::unique_ptr<Subscriber> subscribe(const Settings& settings);
/// Joins the network to steer the daemon of settings.groom_id: no hair comes, statuses and answers alone.
std::unique_ptr<Subscriber> steer(const Settings& settings);
/// A daemon's claim to settings.groom_id while it gets ready: others hear of it from the beginning, and it
/// listens for them while the scene is loaded. Into a log it casts at once.
class GroomClaim {
 public:
  /// Joins the network. Throws Error.
  GroomClaim(const Settings& settings, uint64_t session);
  /// Throws an Error where another daemon that was heard by now has the groom. Any thread, one at a time.
  void check();
  /// Listens on for as long as another may take to be heard, and says so where that takes time. Throws as
  /// check(), and Interrupted where Ctrl-C comes.
  void await();
  /// The channel, once; it outlives this.
  std::unique_ptr<Publisher> take() { return std::move(owned_); }

 private:
  const Settings settings_;
  const uint64_t session_;
  std::chrono::steady_clock::time_point joined_;
  std::optional<std::chrono::steady_clock::time_point> rival_heard_;
  std::unique_ptr<Publisher> owned_;
  Publisher* publisher_;
};
/// The same at once, without a scene to load meanwhile.
std::unique_ptr<Publisher> claimGroom(const Settings& settings, uint64_t session);

/// Looks at a simulation after each frame, in the daemon's thread.
using SimulationObserver = std::function<void(Simulation&)>;

/// A daemon in a thread of this process, cast over the in-process channel: what `strandcast view --scene`
/// runs on.
class EmbeddedDaemon {
 public:
  /// Makes the scene first, with a progress bar; throws Error.
  explicit EmbeddedDaemon(const Settings& settings, SimulationObserver observer = {});
  ~EmbeddedDaemon();
  Subscriber& subscriber() { return *subscriber_; }
  /// Throws the Error that has ended the daemon, if one has.
  void checkAlive() const;
  /// Whether it casts no more.
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

/// Where a renderer's frames come from: a daemon on the network or, with `here`, one in this process. The
/// renderer's side sees no difference.
class Stream {
 public:
  /// Waits until groom and body are known; throws Error after `timeout` seconds.
  /// `observer` is called where the daemon is in this process.
  Stream(const Settings& settings, bool here, double timeout, SimulationObserver observer = {});
  Subscriber& subscriber() { return embedded_ ? embedded_->subscriber() : *remote_; }
  /// As EmbeddedDaemon's; a daemon on the network may fail and come back.
  void checkAlive() const {
    if (embedded_) embedded_->checkAlive();
  }
  bool hasEnded() const { return embedded_ && embedded_->hasEnded(); }

 private:
  std::unique_ptr<EmbeddedDaemon> embedded_;
  std::unique_ptr<Subscriber> remote_;
};

/// Logs what a bake is to take where that is a second or more, for those who see no progress bar. `bar`
/// outlives it.
BakeAnnouncement announceBakes(ProgressBar& bar);
/// The user's cache of fields; empty, with a warning, where there is no folder for it.
std::filesystem::path fieldCacheAloud();
/// makeScene with a progress bar and the user's cache of fields, its notes logged. Ctrl-C stops it:
/// BakeStopped. `meanwhile` (may be empty) is called now and then; what it throws stops it too.
Scene makeSceneAloud(SceneOptions options, const std::function<void()>& meanwhile = {});

}  // namespace strandcast
