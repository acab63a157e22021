#include "service/network.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <random>
#include <thread>

#include "core/error.h"
#include "options/console.h"
#include "transport/dds.h"
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

uint64_t newSession() {
  std::random_device entropy;
  const uint64_t clock = static_cast<uint64_t>(std::chrono::system_clock::now().time_since_epoch().count());
  const uint64_t session = clock ^ (static_cast<uint64_t>(entropy()) << 32 | entropy());
  return session == 0 ? 1 : session;
}

std::string networkName(const Settings& settings) {
  return usesLcm(settings) ? "LCM " + lcmOptions(settings, 0).url
                           : fmt::format("DDS domain {}", settings.domain);
}

std::unique_ptr<Subscriber> subscribe(const Settings& settings) { return join(settings, true); }
std::unique_ptr<Subscriber> joinForCommands(const Settings& settings) { return join(settings, false); }

std::unique_ptr<Publisher> joinAsDaemon(const Settings& settings, uint64_t session) {
  if (settings.claim && usesLcm(settings))
    throw Error("daemons cannot share a groom over LCM", "--claim", "use --transport dds");
  return usesLcm(settings) ? makeLcmPublisher(lcmOptions(settings, session))
                           : makeDdsPublisher(ddsOptions(settings, session));
}

GroomClaim::GroomClaim(const Settings& settings, uint64_t session, std::unique_ptr<Publisher> channel)
    : settings_(settings),
      session_(session),
      joined_(std::chrono::steady_clock::now()),
      owned_(std::move(channel)),
      publisher_(owned_.get()) {}

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
