#include "apps/channel.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <chrono>

#include "apps/console.h"
#include "apps/hair_outlook.h"
#include "apps/interrupt.h"
#include "core/error.h"
#include "scenes/field_cache.h"
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
    throw Error("LCM looks for nobody", "--transport lcm with --peers or --discovery-server",
                "say with --lcm-url where frames go, or use --transport dds");
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
std::unique_ptr<Subscriber> steer(const Settings& settings) { return join(settings, false); }

std::unique_ptr<Publisher> claimGroom(const Settings& settings, uint64_t session) {
  if (settings.claim && usesLcm(settings))
    throw Error("daemons cannot share a groom over LCM", "--claim", "use --transport dds");
  std::unique_ptr<Publisher> publisher = usesLcm(settings) ? makeLcmPublisher(lcmOptions(settings, session))
                                                           : makeDdsPublisher(ddsOptions(settings, session));
  // Nobody else writes into a log.
  if (usesLcm(settings) && isLcmLog(settings.lcm_url)) return publisher;
  const auto listen_time = (settings.keys.empty() ? kRivalListenTime : kSecureRivalListenTime) *
                           (settings.claim ? kSharedListens : 1);
  const auto start = std::chrono::steady_clock::now();
  for (;;) {
    if (g_interrupted) throw Interrupted();
    const auto listened = std::chrono::steady_clock::now() - start;
    const std::optional<Rival> rival = publisher->rival();
    if (!rival && listened >= listen_time) return publisher;
    // One that starts too and has the higher session hears of this one and goes. Others stay, and it may have
    // begun to cast before it heard.
    const bool goes = rival && !rival->casts && rival->session > session && listened < 3 * listen_time;
    if (rival && !goes)
      throw Error(fmt::format("another daemon already casts groom {}", settings.groom_id),
                  fmt::format("{}, session {:016x}", networkName(settings), rival->session),
                  "stop it (`strandcast ctl stop`) or choose another --groom-id");
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
}

BakeAnnouncement announceBakes(ProgressBar& bar) {
  return [&](const std::string& outlook, double seconds) {
    bar.clear();
    if (seconds >= kBakeWorthSaying) spdlog::info("{}", outlook);
  };
}

std::filesystem::path fieldCacheAloud() {
  try {
    return defaultFieldCache();
  } catch (const Error& error) {
    spdlog::warn("{}; every run bakes the body anew", error.what());
    return {};
  }
}

namespace {

void tellOutlook(const SceneOptions& options) {
  const HairOutlook outlook = outlookOfGroom(options);
  if (!outlook.isWorthSaying()) return;
  if (outlook.file_bytes > 0)
    spdlog::info("reading {:.0f} MiB of groom files takes {}",
                 static_cast<double>(outlook.file_bytes) / (1 << 20), outlook.text());
  else
    spdlog::info("{} strands, {} vertices: growing and simulating them takes {}", outlook.strands,
                 outlook.vertices, outlook.text());
}

}  // namespace

Scene makeSceneAloud(SceneOptions options) {
  if (options.field_cache.empty()) options.field_cache = fieldCacheAloud();
  tellOutlook(options);
  Scene scene;
  {
    ProgressBar bar;
    options.bake_begins = announceBakes(bar);
    scene = makeScene(options, [&](const std::string& what, double part) {
      bar.show(what, part);
      return !g_interrupted.load();
    });
  }
  for (const std::string& warning : scene.warnings) spdlog::warn("{}: {}", scene.name, warning);
  for (const std::string& note : scene.notes) spdlog::info("{}: {}", scene.name, note);
  return scene;
}

EmbeddedDaemon::EmbeddedDaemon(const Settings& settings, SimulationObserver observer) {
  std::tie(publisher_, subscriber_) = makeInProcessChannel(settings.groom_id);
  daemon_ = std::make_unique<Daemon>(settings, makeSceneAloud(settings.scene), *publisher_, newSession());
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
  if (!subscriber().waitForGroom(std::chrono::milliseconds(static_cast<int>(1000 * timeout))))
    throw Error("no daemon casts this groom",
                fmt::format("groom {} on {}", settings.groom_id, networkName(settings)),
                "start strandcastd, or name a --scene or --groom to simulate here");
}

}  // namespace strandcast
