#include "apps/channel.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <chrono>

#include "apps/console.h"
#include "apps/hair_estimate.h"
#include "apps/interrupt.h"
#include "collision/field_cache.h"
#include "core/error.h"
#include "transport/dds.h"
#include "transport/in_process.h"
#include "transport/lcm.h"

namespace strandcast {
namespace {

DdsOptions ddsOptions(const Settings& settings, uint64_t session, bool frames = true) {
  if (!settings.lcm_url.empty())
    throw Error("DDS has no URL", "--lcm-url " + settings.lcm_url, "add --transport lcm");
  return {settings.domain, settings.groom_id,
          session,         settings.codec,
          settings.claim,  ddsProfileNamed(settings.profile, "--profile"),
          settings.peers,  settings.discovery_server,
          settings.keys,   frames};
}

LcmOptions lcmOptions(const Settings& settings, uint64_t session, bool frames = true) {
  if (ddsProfileNamed(settings.profile, "--profile") == DdsProfile::kSecure || !settings.keys.empty())
    throw Error("LCM has no security", "--transport lcm with --profile secure or --keys",
                "use --transport dds");
  if (!settings.peers.empty() || !settings.discovery_server.empty())
    throw Error("LCM has no discovery", "--transport lcm with --peers or --discovery-server",
                "name the destination with --lcm-url, or use --transport dds");
  return {settings.lcm_url.empty() ? lcmUrl(settings.domain) : settings.lcm_url, settings.groom_id, session,
          settings.codec, frames};
}

bool usesLcm(const Settings& settings) { return settings.transport == "lcm"; }

std::unique_ptr<Subscriber> join(const Settings& settings, bool frames) {
  if (usesLcm(settings)) return makeLcmSubscriber(lcmOptions(settings, 0, frames));
  return makeDdsSubscriber(ddsOptions(settings, 0, frames));
}

}  // namespace

std::string networkName(const Settings& settings) {
  return usesLcm(settings) ? "LCM " + lcmOptions(settings, 0).url
                           : fmt::format("DDS domain {}", settings.domain);
}

std::unique_ptr<Subscriber> subscribe(const Settings& settings) { return join(settings, true); }
std::unique_ptr<Subscriber> joinForCommands(const Settings& settings) { return join(settings, false); }

GroomClaim::GroomClaim(const Settings& settings, uint64_t session) : settings_(settings), session_(session) {
  if (settings.claim && usesLcm(settings))
    throw Error("daemons cannot share a groom over LCM", "--claim", "use --transport dds");
  owned_ = usesLcm(settings) ? makeLcmPublisher(lcmOptions(settings, session))
                             : makeDdsPublisher(ddsOptions(settings, session));
  publisher_ = owned_.get();
  joined_ = std::chrono::steady_clock::now();
}

void GroomClaim::check() {
  if (publisher_->hasUnreachableDaemonOfGroom())
    throw Error(fmt::format("another daemon of groom {} is present, but its shared memory cannot be read; it "
                            "may run as another user",
                            settings_.groom_id),
                networkName(settings_),
                "start both daemons as one user, or this daemon with --profile reliable-lan; or stop the "
                "other daemon or choose another --groom-id");
  const std::optional<ConflictingDaemon> conflict = publisher_->conflict();
  const auto now = std::chrono::steady_clock::now();
  if (!conflict) {
    conflict_heard_.reset();
    return;
  }
  if (!conflict_heard_) conflict_heard_ = now;
  // A conflicting daemon that also starts and has the higher session exits once it hears this daemon: wait
  // for it. Any other one stays. So does one that began to cast before it heard this daemon; the time limit
  // covers that case.
  const bool goes =
      !conflict->casts && conflict->session > session_ && now - *conflict_heard_ < 3 * kConflictListenTime;
  if (goes) return;
  throw Error(fmt::format("another daemon already {} groom {}",
                          conflict->casts ? "publishes" : "prepares to publish", settings_.groom_id),
              fmt::format("{}, session {:016x}", networkName(settings_), conflict->session),
              "stop it (`strandcast ctl stop`) or choose another --groom-id");
}

void GroomClaim::await() {
  constexpr std::chrono::milliseconds kPollInterval{5}, kNotableWait{300};
  // A log has no other writers.
  if (usesLcm(settings_) && isLcmLog(settings_.lcm_url)) return;
  const auto begin = std::chrono::steady_clock::now();
  for (bool said = false;; std::this_thread::sleep_for(kPollInterval)) {
    if (g_interrupted) throw Interrupted();
    check();
    const auto now = std::chrono::steady_clock::now();
    const auto listen_time = publisher_->listenTime();
    if (!conflict_heard_ && now - joined_ >= listen_time) return;
    if (said || now - begin < kNotableWait) continue;
    said = true;
    if (conflict_heard_)
      spdlog::info("waiting for another starting daemon, session {:016x}, to give up its claim",
                   publisher_->conflict().value_or(ConflictingDaemon{}).session);
    else
      spdlog::info(
          "listening for up to {:.1f} s for another daemon of groom {} on {}: {}",
          std::chrono::duration<double>(listen_time - (now - joined_)).count(), settings_.groom_id,
          networkName(settings_),
          publisher_->possibleConflicts() > 0
              ? fmt::format("{} of the programs on the network may be one", publisher_->possibleConflicts())
              : "its announcement would arrive within that time");
  }
}

std::unique_ptr<Publisher> claimGroom(const Settings& settings, uint64_t session) {
  GroomClaim claim(settings, session);
  claim.await();
  return claim.take();
}

BakeAnnouncement announceBakes(ProgressBar& bar) {
  return [&](const std::string& estimate, double seconds) {
    bar.clear();
    if (seconds >= kNotableBakeSeconds) spdlog::info("{}", estimate);
  };
}

std::filesystem::path fieldCacheWithProgress() {
  try {
    return defaultFieldCache();
  } catch (const Error& error) {
    spdlog::warn("{}; every run bakes the body's field again", error.what());
    return {};
  }
}

namespace {

void logEstimate(const SceneOptions& options) {
  const HairEstimate estimate = estimateOfGroom(options);
  if (!estimate.isNotable()) return;
  if (estimate.file_bytes > 0)
    spdlog::info("reading {:.0f} MiB of groom files takes {}",
                 static_cast<double>(estimate.file_bytes) / (1 << 20), estimate.text());
  else
    spdlog::info("{} strands, {} vertices: growing and simulating them takes {}", estimate.strands,
                 estimate.vertices, estimate.text());
}

}  // namespace

Scene makeSceneWithProgress(SceneOptions options, const std::function<void()>& meanwhile) {
  if (options.field_cache.empty()) options.field_cache = fieldCacheWithProgress();
  logEstimate(options);
  Scene scene;
  std::exception_ptr stops;  // exception of `meanwhile`, which runs in the bake's worker threads
  {
    ProgressBar bar;
    options.bake_begins = announceBakes(bar);
    const std::string name = options.groom.empty() ? options.name : options.groom.front().stem().string();
    options.warns_early = [&](const std::string& warning) {
      bar.clear();
      spdlog::warn("{}: {}", name, warning);
    };
    const auto goesOn = [&] {
      if (g_interrupted || stops) return false;
      try {
        if (meanwhile) meanwhile();
      } catch (...) {
        stops = std::current_exception();
      }
      return !stops;
    };
    try {
      scene = makeScene(options, [&](const std::string& what, double part) {
        bar.show(what, part);
        return goesOn();
      });
    } catch (const BakeStopped&) {
      if (stops) std::rethrow_exception(stops);
      throw;
    }
  }
  for (const std::string& warning : scene.warnings) spdlog::warn("{}: {}", scene.name, warning);
  for (const std::string& note : scene.notes) spdlog::info("{}: {}", scene.name, note);
  return scene;
}

EmbeddedDaemon::EmbeddedDaemon(const Settings& settings, SimulationObserver observer) {
  std::tie(publisher_, subscriber_) = makeInProcessChannel(settings.groom_id);
  daemon_ =
      std::make_unique<Daemon>(settings, makeSceneWithProgress(settings.scene), *publisher_, newSession());
  daemon_->setObserver(std::move(observer));
  daemon_->announce();
  thread_ = std::thread([this] {
    try {
      daemon_->run(stop_);
    } catch (...) {
      const std::lock_guard lock(mutex_);
      failure_ = std::current_exception();
    }
    has_ended_ = true;
  });
}

EmbeddedDaemon::~EmbeddedDaemon() {
  stop_ = true;
  thread_.join();
}

void EmbeddedDaemon::checkAlive() const {
  const std::lock_guard lock(mutex_);
  if (failure_) std::rethrow_exception(failure_);
}

Stream::Stream(const Settings& settings, bool here, double timeout, SimulationObserver observer) {
  if (here)
    embedded_ = std::make_unique<EmbeddedDaemon>(settings, std::move(observer));
  else
    remote_ = subscribe(settings);
  constexpr std::chrono::milliseconds kPollInterval{100};
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(timeout);
  bool found = false;
  while (!found && std::chrono::steady_clock::now() < end) {
    if (g_interrupted) throw Interrupted();
    found = subscriber().waitForGroom(kPollInterval);
  }
  if (!found)
    throw Error("no daemon publishes this groom",
                fmt::format("groom {} on {}", settings.groom_id, networkName(settings)),
                settings.keys.empty() ? "start strandcastd, or name a --scene or --groom to simulate here"
                                      : "start strandcastd, or check the keys: a daemon refuses keys of "
                                        "another CA, expired keys and keys that do not permit this groom");
}

}  // namespace strandcast
