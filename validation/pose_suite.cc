#include "validation/pose_suite.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <unistd.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <set>
#include <span>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "core/error.h"
#include "core/quantile.h"
#include "options/console.h"
#include "options/number_range.h"
#include "options/settings.h"
#include "service/daemon.h"
#include "service/network.h"
#include "service/process.h"
#include "service/replay.h"
#include "service/scene_simulation.h"
#include "transport/commands.h"
#include "transport/dds.h"
#include "transport/frame_queue.h"
#include "transport/lcm.h"
#include "transport/recording/recorder.h"
#include "validation/walker.h"

namespace strandcast {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr auto kGroomWait = 20s, kReadyWait = 30s;
constexpr int kStrands = 200, kVertices = 10;   // of the hair
constexpr double kLoss = 0.01, kJitter = 0.05;  // share of messages; s, evenly distributed
constexpr double kLimitMm = 0.5, kJumpMm = 1;
// Percent of steps; where the sender is slower than the steps, every other one lies between samples.
constexpr double kInterpolated = 5, kSlowInterpolated = 55;
// After each lock the pace gives way by 2 % until steps wait for the latest samples.
constexpr double kLockSeconds = 1.5 * kJitter / 0.02;
constexpr double kRestSeconds = 1;  // of the time at rest from the silence
// Of the age of poses; where the sender is slower than the steps, these also wait for the sample after them.
constexpr double kMedianMs = 100, kWorstMs = 250, kSlowMedianMs = 170, kSlowWorstMs = 300;

struct SenderOptions {
  std::string transport;
  int domain = 0;
  double rate = 60;
  uint64_t from = 0;  ///< ns, steady clock, of the first sample
};

uint64_t toNanoseconds(double seconds) { return static_cast<uint64_t>(std::llround(1e9 * seconds)); }

int sendPoses(const SenderOptions& o) {
  const LcmOptions lcm{o.transport == "lcm" ? lcmUrl(o.domain) : "", 1, 0, {}};
  const DdsOptions dds{o.domain, 1, 0, {}};
  const bool over_lcm = o.transport == "lcm";
  const std::unique_ptr<Subscriber> subscriber = over_lcm ? makeLcmSubscriber(lcm) : makeDdsSubscriber(dds);
  const std::unique_ptr<PoseSender> sender = over_lcm ? makeLcmPoseSender(lcm) : makeDdsPoseSender(dds);
  if (!subscriber->waitForGroom(kGroomWait))
    throw Error("the groom did not arrive", fmt::format("{}, domain {}", o.transport, o.domain),
                "is the network interface lo up?");
  sender->setNames(walkerNames());
  fmt::print("ready\n");
  std::fflush(stdout);

  // Samples are at whole multiples of the period, so that the next sender goes on where this one stops.
  const uint64_t period = toNanoseconds(1 / o.rate);
  uint64_t number = std::max(o.from, steadyTime()) / period + 1, shown = 0;
  std::shared_ptr<const GuideFrame> last;
  std::vector<double> ages;
  uint64_t told = steadyTime();
  while (!g_interrupted && !inputHasEnded()) {
    const uint64_t due = number * period;
    for (uint64_t now = steadyTime(); now < due && due - now < 1'000'000'000; now = steadyTime()) {
      const auto wait = std::chrono::ceil<std::chrono::milliseconds>(std::chrono::nanoseconds(due - now));
      const std::shared_ptr<const GuideFrame> frame =
          subscriber->waitForNext(last.get(), std::min(wait, 5ms));
      if (!frame) continue;
      last = frame;
      if (frame->pose_source != sender->source() || frame->pose_time == shown) continue;
      shown = frame->pose_time;
      ages.push_back(1e-6 * static_cast<double>(frame->arrival_time - shown));
    }
    if (steadyTime() < due) {  // it has yet to begin
      std::this_thread::sleep_for(50ms);
      continue;
    }
    sender->send(due, walkerAt(due));
    ++number;
    if (due - std::min(due, told) < 1'000'000'000) continue;
    told = due;
    fmt::print("{}\n", nlohmann::json(ages).dump());
    std::fflush(stdout);
    ages.clear();
  }
  fmt::print("{}\n", nlohmann::json(ages).dump());
  return 0;
}

/// The poses that a step took.
struct PosedStep {
  StepPoses taken;
  uint64_t newest = 0;     ///< ns, sender's clock: the newest sample that the source had brought by then
  int64_t delay = 0;       ///< ns, simulation time less the sender's
  uint32_t locks = 0;      ///< of the daemon to the source
  bool is_framed = false;  ///< samples around the step are near enough for interpolation within kLimitMm
};

/// A bad link between senders and a daemon, at the daemon's end: it drops messages of poses and holds the
/// others back, so that they overtake each other. A message counts as arriving when it is let through. Keeps
/// the poses of all steps.
class BadLink final : public Publisher {
 public:
  /// `rate`: samples per second.
  BadLink(std::unique_ptr<RecordingPublisher> publisher, double rate)
      : publisher_(std::move(publisher)), period_(toNanoseconds(1 / rate)) {}

  std::optional<PoseSamples> takePoses() override {
    while (std::optional<PoseSamples> message = publisher_->takePoses()) {
      const uint64_t arrival = message->arrival_time;
      if (message->source != source_) {
        if (source_ != 0) silence_ += 1e-9 * static_cast<double>(arrival - last_arrival_);
        source_ = message->source;
        ++sources_;
      }
      last_arrival_ = arrival;
      ++messages_;
      if (even_(random_) < kLoss)
        ++dropped_;
      else
        held_.emplace(arrival + toNanoseconds(kJitter * even_(random_)), std::move(*message));
    }
    if (held_.empty() || held_.begin()->first > steadyTime()) return std::nullopt;
    auto next = held_.extract(held_.begin());
    PoseSamples message = std::move(next.mapped());
    message.arrival_time = next.key();
    Known& known = known_[message.source];
    known.last.clear();
    for (const uint32_t age : message.ages) known.last.insert(message.time - age);
    known.times.insert(known.last.begin(), known.last.end());
    return message;
  }
  void recordPoses(const StepPoses& poses) override {
    Known& known = known_[poses.poses.source];
    PosedStep& step = steps_.emplace_back(poses, *known.times.rbegin());
    for (const LivePoses::Delay& delay : daemon->poseDelays()) {
      if (delay.source != poses.poses.source) continue;
      step.delay = delay.ns;
      step.locks = delay.locks;
    }
    if (std::exchange(known.locks, step.locks) != step.locks) known.times = known.last;  // as LivePoses
    step.is_framed = isFramed(known.times, poses.poses.time);
    publisher_->recordPoses(poses);
  }
  void announce(const GroomDescription& groom, const BodyDescription& body) override {
    publisher_->announce(groom, body);
  }
  void announceColliders(const ColliderSet& colliders) override { publisher_->announceColliders(colliders); }
  void publish(const GuideFrame& frame) override { publisher_->publish(frame); }
  void publishStatus(const Status& status) override { publisher_->publishStatus(status); }
  std::optional<Command> takeCommand() override { return publisher_->takeCommand(); }
  uint32_t matchedReaders() const override { return publisher_->matchedReaders(); }
  EncodingReport encoding() const override { return publisher_->encoding(); }
  std::optional<ConflictingDaemon> conflict() const override { return publisher_->conflict(); }

  const Daemon* daemon = nullptr;  ///< must be set before its first frame
  RecordingPublisher& recording() { return *publisher_; }
  const std::vector<PosedStep>& steps() const { return steps_; }
  uint64_t messages() const { return messages_; }
  uint64_t dropped() const { return dropped_; }
  int sources() const { return sources_; }
  double silence() const { return silence_; }  ///< s, between the messages of senders that follow each other

 private:
  /// Samples of a source that the daemon has.
  struct Known {
    std::set<uint64_t> times, last;  ///< ns, sender's clock: since the lock; of the last message
    uint32_t locks = 0;
  };
  /// PoseTrack interpolates between two samples with the three before them. One period or two may lie between
  /// neighbours; where more are missing, the motion between them is not known within kLimitMm.
  bool isFramed(const std::set<uint64_t>& times, uint64_t base) const {
    auto at = times.upper_bound(base);
    for (int i = 0; i < 4; ++i, --at)
      if (at == times.end() || at == times.begin() || *at - *std::prev(at) > 2 * period_ + period_ / 2)
        return false;
    return true;
  }

  const std::unique_ptr<RecordingPublisher> publisher_;
  const uint64_t period_;  ///< ns, of the samples
  std::mt19937 random_{1};
  std::uniform_real_distribution<double> even_{0, 1};
  std::multimap<uint64_t, PoseSamples> held_;  ///< by the time at which each is let through
  std::map<uint64_t, Known> known_;            ///< by source
  std::vector<PosedStep> steps_;
  uint64_t messages_ = 0, dropped_ = 0, source_ = 0, last_arrival_ = 0;
  int sources_ = 0;
  double silence_ = 0;
};

struct TrialRow {
  std::string transport;
  double rate = 60;     ///< samples per second
  double seconds = 20;  ///< from the first sample to the last

  std::string name() const { return fmt::format("{} {:g} Hz", transport, rate); }
};

/// A folder for the character and the recording, removed by the destructor.
class TrialFolder {
 public:
  TrialFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "strandcast_XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr)
      throw Error("the folder of the trial cannot be made", name, std::strerror(errno));
    path_ = name;
  }
  ~TrialFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TrialFolder(const TrialFolder&) = delete;
  TrialFolder& operator=(const TrialFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// Only errors are logged during its lifetime: a sender that takes over is worth a warning elsewhere.
class QuietLog {
 public:
  QuietLog() { spdlog::set_level(spdlog::level::err); }
  ~QuietLog() { spdlog::set_level(before_); }
  QuietLog(const QuietLog&) = delete;
  QuietLog& operator=(const QuietLog&) = delete;

 private:
  const spdlog::level::level_enum before_ = spdlog::get_level();
};

/// Measurements while the daemon cast.
struct LiveRun {
  std::vector<PosedStep> steps;
  std::vector<double> ages_ms;  ///< as senders measured them
  PoseMetrics poses;
  uint64_t messages = 0, dropped = 0, late_frames = 0;
  int sources = 0;
  double silence = 0;   ///< s, between senders
  std::string failure;  ///< if not empty, all other members are invalid
};

/// The senders of a row, one after the other. Each but the last is killed.
class Senders {
 public:
  /// `stop` is set when the row is over.
  Senders(const TrialRow& row, int domain, const std::function<void(double part)>& progress,
          std::atomic<bool>& stop)
      : row_(row), domain_(domain), progress_(progress), stop_(stop), thread_([this] { run(); }) {}

  std::vector<double> ages;  ///< ms; valid after finish(), as is `failure`
  std::string failure;
  void finish() { thread_.join(); }

 private:
  void run() {
    failure = errorTextOf([this] { send(); });
    stop_ = true;
  }
  void send() {
    const double seconds = row_.seconds;
    const double silences[] = {std::min(3.0, seconds / 20), std::min(12.0, seconds / 5)};
    const double ends[] = {0.25 * seconds, 0.6 * seconds, seconds};
    auto sender = start(steadyTime());
    const uint64_t begin = steadyTime();
    for (size_t i = 0; i < 3; ++i) {
      const uint64_t end = begin + toNanoseconds(ends[i]);
      // The next one is ready before this one ends, so that the silence has the length that was chosen.
      auto next = i < 2 ? start(end + toNanoseconds(silences[i])) : nullptr;
      while (steadyTime() < end && !stop_ && !g_interrupted) {
        take(*sender);
        progress_(1e-9 * static_cast<double>(steadyTime() - begin) / seconds);
      }
      if (stop_ || g_interrupted) return;
      if (next)
        sender->kill();
      else
        sender->endInput();
      take(*sender, 2s);
      sender = std::move(next);
    }
  }
  std::unique_ptr<ChildProcess> start(uint64_t from) {
    auto sender = std::make_unique<ChildProcess>(std::vector<std::string>{
        "pose-sender", "--transport", row_.transport, "--domain", std::to_string(domain_), "--rate",
        fmt::format("{:g}", row_.rate), "--from", std::to_string(from)});
    if (sender->line(kReadyWait) != "ready" && !g_interrupted)
      throw Error("the sender " + sender->end(), row_.name(), "");
    return sender;
  }
  /// Takes what a sender measured.
  void take(ChildProcess& sender, std::chrono::milliseconds patience = 50ms) {
    while (const std::optional<std::string> line = sender.line(patience)) {
      const nlohmann::json read = nlohmann::json::parse(*line, nullptr, false);
      if (!read.is_array()) continue;  // the sender was killed within the line
      for (const double age : read) ages.push_back(age);
    }
  }

  const TrialRow row_;
  const int domain_;
  const std::function<void(double part)> progress_;
  std::atomic<bool>& stop_;
  std::thread thread_;
};

/// The daemon's settings and where they came from.
struct WalkerSettings {
  explicit WalkerSettings(const TrialFolder& folder)
      : words({"--groom", (folder.path() / "hair.obj").string(), "--unit-meters", "1", "--up", "y", "--body",
               (folder.path() / "walker.glb").string(), "--body-joint", "head", "--body-cell", "0.02",
               "--motion", "still", "--backend", "simd", "--threads", "1"}),
        options(app, SettingsUse::kServe) {
    app.parse(std::vector<std::string>(words.rbegin(), words.rend()));
    settings = options.resolve();
  }
  std::vector<std::string> words;
  CLI::App app;
  SettingsOptions options;
  Settings settings;
};

std::unique_ptr<Publisher> makeRowPublisher(const TrialRow& row, int domain, uint64_t session) {
  if (row.transport == "lcm") return makeLcmPublisher({lcmUrl(domain), 1, session, {}});
  return makeDdsPublisher({domain, 1, session, {}});
}

LiveRun castLive(const TrialRow& row, const WalkerSettings& walker, const std::filesystem::path& file,
                 const std::function<void(double part)>& progress) {
  const int domain = 3 + static_cast<int>(getpid() % 98);  // as the suite "wire"
  const uint64_t session = newSession();
  BadLink link(std::make_unique<RecordingPublisher>(makeRowPublisher(row, domain, session)), row.rate);
  Daemon daemon(walker.settings, makeScene(walker.settings.scene), link, session);
  link.daemon = &daemon;
  link.recording().open(file, {1, {}, simulationSource(walker.words, walker.options, "simd", "")});
  daemon.announce();
  std::atomic<bool> stop{false};
  Senders senders(row, domain, progress, stop);
  const DaemonSummary summary = daemon.run(stop);
  stop = true;
  senders.finish();
  LiveRun out{link.steps(),        std::move(senders.ages), summary.poses,  link.messages(), link.dropped(),
              summary.late_frames, link.sources(),          link.silence(), summary.failure};
  if (out.failure.empty()) out.failure = senders.failure;
  if (const std::string why = link.recording().close(); out.failure.empty()) out.failure = why;
  return out;
}

/// As the wire has it: in float, with rotations of unit length.
Pose received(Pose pose) {
  auto& numbers = pose.rotation.coeffs();
  float square = 0;
  for (const float n : numbers) square += n * n;
  for (float& n : numbers) n /= std::sqrt(square);
  return pose;
}

double farthestOf(std::span<const Vec3> a, std::span<const Vec3> b) {
  double worst = a.size() == b.size() ? 0 : std::numeric_limits<double>::quiet_NaN();
  for (size_t i = 0; i < std::min(a.size(), b.size()); ++i)
    worst = worse(worst, static_cast<double>((a[i] - b[i]).norm()));
  return worst;
}

/// The same hair without daemon and network, moved by the sender's own motion: at each step that takes a
/// sample the motion at the sample's time, else what the daemon showed.
class OfflineRun {
 public:
  OfflineRun(const Settings& settings, std::span<const PosedStep> steps)
      : scene_(makeScene(settings.scene)),
        simulation_(makeSimulation(scene_, settings)),
        steps_(steps),
        step_ns_(std::llround(1e9 * double{simulation_.parameters().time_step})) {
    shown_ = rootsOf(scene_.skinned->at(0, Pose{}));
    // The gait repeats itself after ten seconds.
    for (int64_t time = 0; time < 10'000'000'000; time += step_ns_)
      largest_motion_ = std::max(largest_motion_, farthestOf(skinAt(time), skinAt(time + step_ns_)));
  }

  void advanceTo(uint64_t steps) {
    while (simulation_.steps() < steps) advance();
  }
  std::span<const Vec3> hair() { return simulation_.guides(); }

  uint64_t exact() const { return exact_; }  ///< steps that took a sample bit for bit
  /// Largest distance of roots from the sender's skin, m, of steps at samples and of framed ones between
  /// them, unless they rejoin.
  double farthestFromSkin() const { return farthest_; }
  uint64_t judged() const { return judged_; }  ///< those steps
  /// Largest motion of a root in a step beyond what the sender's motion and the gap before explain, m.
  double largestJump() const { return jump_; }
  double largestMotion() const { return largest_motion_; }  ///< m, of a root in a step, of the sender
  double stepSeconds() const { return 1e-9 * static_cast<double>(step_ns_); }
  double secondsWithoutSource() const { return 1e-9 * static_cast<double>(lonely_ * step_ns_); }

 private:
  std::vector<Vec3> rootsOf(const SkinnedBody::Moment& moment) const {
    const StrandModel& model = simulation_.model();
    const std::vector<Pose> bones = scene_.skinned->placedRoots(moment);
    std::vector<Vec3> roots;
    for (size_t s = 0; s < model.strands(); ++s) {
      const uint16_t bone = model.rootBone(s);
      const Pose& pose = bone == 0 ? moment.carried : bones[bone - 1u];
      roots.push_back(pose.apply(model.restPosition(s, model.offsets[s])));
    }
    return roots;
  }
  SkinnedBody::Moment momentOf(std::span<const Pose> poses) const {
    static const std::vector<std::string> names = walkerNames();
    const Skeleton& skeleton = scene_.skinned->skin().skeleton;
    std::vector<std::optional<Placement>> palette(skeleton.joints.size());
    for (size_t i = 0; i < names.size(); ++i) {
      Placement motion = Placement::Identity();
      motion.translate(poses[i].position.cast<double>());
      motion.rotate(poses[i].rotation.cast<double>());
      palette[static_cast<size_t>(skeleton.find(names[i].substr(names[i].find(':') + 1)))] = motion;
    }
    return scene_.skinned->fromPalette(palette, {}, Pose{});
  }
  /// Roots on the sender's skin.
  std::vector<Vec3> skinAt(int64_t time) const { return rootsOf(momentOf(sentAt(time))); }
  static std::vector<Pose> sentAt(int64_t time) {
    std::vector<Pose> poses = walkerAt(static_cast<uint64_t>(time));
    std::transform(poses.begin(), poses.end(), poses.begin(), received);
    return poses;
  }
  static std::vector<Pose> posesOf(const PoseSamples& samples) {
    std::vector<Pose> poses(samples.poses.size() / 7);
    for (size_t i = 0; i < poses.size(); ++i) {
      const float* const n = samples.poses.data() + 7 * i;
      poses[i] = {Vec3(n[0], n[1], n[2]), Quat(n[6], n[3], n[4], n[5])};
    }
    return poses;
  }
  static bool areSame(const std::vector<Pose>& a, const std::vector<Pose>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Pose)) == 0;
  }

  void advance() {
    const uint64_t step = simulation_.steps();
    const double end = simulation_.time() + double{simulation_.parameters().time_step};
    if (next_ < steps_.size() && steps_[next_].taken.step == step)
      take(steps_[next_++], std::llround(1e9 * end));
    else if (next_ == 0)
      moveTo(scene_.skinned.get(), end, Pose{}, simulation_);
    else
      ++lonely_;  // all poses stay
    simulation_.step();
    simulation_.resetDiverged();
  }

  void take(const PosedStep& posed, int64_t end) {
    const auto time = static_cast<int64_t>(posed.taken.poses.time);
    const std::vector<Pose> sent = sentAt(time), taken = posesOf(posed.taken.poses);
    const bool is_exact = areSame(sent, taken);
    const SkinnedBody::Moment moment = momentOf(is_exact ? sent : taken);
    place(*scene_.skinned, moment, Pose{}, simulation_);
    if (posed.taken.is_cut) simulation_.jumpToPoses();
    exact_ += is_exact ? 1 : 0;
    std::vector<Vec3> roots = rootsOf(moment);
    measure(posed, is_exact ? time : end - posed.delay, is_exact, roots);
    shown_ = std::move(roots);
  }

  /// `now`: sender's time of the step, ns.
  void measure(const PosedStep& posed, int64_t now, bool is_exact, const std::vector<Vec3>& roots) {
    const auto time = static_cast<int64_t>(posed.taken.poses.time);
    // PoseTrack does not interpolate between samples farther apart, and PoseLock leaves far ones out.
    constexpr int64_t kFarthestSample = 250'000'000;
    const auto ahead = static_cast<int64_t>(posed.newest) - time;
    const bool has_next = ahead > 0 && ahead <= kFarthestSample;
    const bool is_held = !is_exact && !has_next && now - time > step_ns_ / 10;
    const bool is_relocked =
        posed.locks != locks_ || std::abs(now - now_ - step_ns_) > step_ns_ / 10;  // or another source
    const double step = 1e-9 * static_cast<double>(step_ns_);
    const std::vector<Vec3> skin = skinAt(now), skin_before = skinAt(now - step_ns_);
    double explained = is_held ? largest_motion_ : farthestOf(skin, skin_before);
    const bool is_new = !is_held || time != base_ || posed.newest != newest_;
    if (posed.taken.is_cut) {
      explained = farthestOf(shown_, skin);
      rejoin_speed_ = 0;
    } else if (is_relocked || (held_ > 0 && is_new)) {  // PoseTrack has this duration, and longer ones
      rejoin_speed_ = 1.9 * farthestOf(shown_, skin_before) / std::clamp(held_, 2 * step, 0.25);
    }
    explained += rejoin_speed_ * step;
    held_ = is_held ? step + (time == base_ ? held_ : 0) : 0;
    if (is_exact) rejoin_speed_ = 0;
    now_ = now;
    locks_ = posed.locks;
    base_ = time;
    newest_ = posed.newest;
    jump_ = worse(jump_, std::max(0.0, farthestOf(shown_, roots) - explained));
    if (rejoin_speed_ != 0 || !(is_exact || (has_next && posed.is_framed))) return;
    farthest_ = worse(farthest_, farthestOf(roots, skin));
    ++judged_;
  }

  Scene scene_;
  Simulation simulation_;
  const std::span<const PosedStep> steps_;
  size_t next_ = 0;  ///< of steps_
  const int64_t step_ns_;
  int64_t now_ = 0, base_ = 0;  ///< ns, sender's time of the step before and of its newest sample
  uint64_t newest_ = 0;         ///< ns, of the newest sample that was known
  double held_ = 0;             ///< s for which no newer sample was known
  double rejoin_speed_ = 0;     ///< m/s, greatest of what rejoining adds; 0: steps do not rejoin
  std::vector<Vec3> shown_;     ///< roots of the step before
  uint32_t locks_ = 0;          ///< at the step before
  uint64_t exact_ = 0, judged_ = 0;
  int64_t lonely_ = 0;
  double largest_motion_ = 0, farthest_ = 0, jump_ = 0;
};

std::vector<std::string> rowCaseNames(const TrialRow& row) {
  std::vector<std::string> names;
  for (const char* what : {"repeated", "offline", "skin", "jump", "exact", "interpolated", "extrapolated",
                           "at rest", "latency p50", "latency p99"})
    names.push_back(row.name() + " " + what);
  return names;
}

std::vector<Case> casesOfRow(const TrialRow& row) {
  constexpr double kNoLimit = std::numeric_limits<double>::infinity();
  double load = 0;
  (void)getloadavg(&load, 1);
  const QuietLog quiet;
  const TrialFolder folder;
  writeWalker(folder.path(), kStrands, kVertices);
  const WalkerSettings walker(folder);
  ProgressBar bar;
  const std::filesystem::path file = folder.path() / "live.rec";
  const LiveRun live =
      castLive(row, walker, file, [&](double part) { bar.show(row.name() + ", live", 0.8 * part); });
  if (g_interrupted) throw Laboratory::Stopped();

  ResimulationReport again;
  double hair = 0;
  OfflineRun offline(walker.settings, live.steps);
  if (live.failure.empty()) {
    Recording recording(file);
    again = resimulate(recording, file, g_interrupted, [&](uint64_t frames, Simulation& simulation) {
      offline.advanceTo(simulation.steps());
      hair = worse(hair, farthestOf(offline.hair(), simulation.guides()));
      if (frames % 60 == 0)
        bar.show(row.name() + ", again",
                 0.8 + 0.2 * static_cast<double>(frames) / static_cast<double>(recording.frames()));
    });
  }
  if (g_interrupted) throw Laboratory::Stopped();

  const std::vector<std::string> names = rowCaseNames(row);
  std::vector<Case> cases;
  const auto add = [&](const char* quantity, const char* unit, double measured, double truth, double limit) {
    const bool is_known = live.failure.empty();
    cases.push_back(absoluteCase({names[cases.size()], quantity, unit},
                                 is_known ? measured : std::numeric_limits<double>::quiet_NaN(), truth,
                                 limit));
    cases.back().note = live.failure;
  };
  const auto note = [&](const std::string& text) {
    if (live.failure.empty()) cases.back().note = text;
  };
  const auto posed = static_cast<double>(live.steps.size());
  const auto percent = [&](uint64_t steps) { return 100 * static_cast<double>(steps) / posed; };
  add("frames that differ when the recording is simulated again", "frames",
      static_cast<double>(again.different), 0, 0);
  note(fmt::format("of {} frames; {} late; {} of {} messages dropped; load average {:.2f} before",
                   again.frames, live.late_frames, live.dropped, live.messages, load));
  add("hair against an offline run of the sender's motion, largest distance", "mm", 1e3 * hair, 0, kLimitMm);
  add("roots against the sender's skin, largest distance", "mm", 1e3 * offline.farthestFromSkin(), 0,
      kLimitMm);
  note(fmt::format("{} of {} steps: at samples, or with near ones around them", offline.judged(),
                   live.steps.size()));
  add("largest motion of a root in a step beyond what the sender's and the gap explain", "mm",
      1e3 * offline.largestJump(), 0, kJumpMm);
  note(fmt::format("{} cuts, {} relocks; the sender moves roots by {:.1f} mm in a step at most",
                   live.poses.jumps, live.poses.relocks, 1e3 * offline.largestMotion()));
  add("steps that took a sample bit for bit", "%", percent(offline.exact()), 100, kNoLimit);
  const bool waits = row.rate < 60;
  add("steps between samples", "%", percent(live.poses.interpolated), 0,
      waits ? kSlowInterpolated : kInterpolated);
  add("steps after the last sample", "%", percent(live.poses.extrapolated), 0,
      std::min(100.0, 1 + 100 * kLockSeconds * live.sources / (posed * offline.stepSeconds())));
  note(fmt::format("{} of {}; {} samples came after their step", live.poses.extrapolated, live.steps.size(),
                   live.poses.late));
  add("time at rest", "s",
      static_cast<double>(live.poses.rested) * offline.stepSeconds() + offline.secondsWithoutSource(),
      live.silence, kRestSeconds);
  note(fmt::format("against {:.2f} s of silence; {} senders", live.silence, live.sources));
  add("age of poses when their hair is decoded, median", "ms", quantileOf(live.ages_ms, 0.5), 0,
      waits ? kSlowMedianMs : kMedianMs);
  note(fmt::format("of {} frames", live.ages_ms.size()));
  add("age of poses when their hair is decoded, 99th percentile", "ms", quantileOf(live.ages_ms, 0.99), 0,
      waits ? kSlowWorstMs : kWorstMs);
  return cases;
}

}  // namespace

Suite poseSuite(double seconds) {
  Suite suite{"poses",
              "hair of a walking character that another process moves over a bad link, and that is killed "
              "twice (4 minutes)",
              {}};
  std::vector<std::string> transports;
  if (ddsAvailable()) transports.emplace_back("dds");
  if (lcmAvailable()) transports.emplace_back("lcm");
  for (const std::string& transport : transports) {
    for (const double rate : {30.0, 60.0, 120.0}) {
      const TrialRow row{transport, rate, seconds};
      suite.experiments.push_back(
          {row.name(), rowCaseNames(row), [row](const Laboratory&) { return casesOfRow(row); }});
    }
  }
  return suite;
}

std::function<int()> addPoseSender(CLI::App& app) {
  const auto o = std::make_shared<SenderOptions>();
  app.add_option("--transport", o->transport, "dds or lcm")->check(CLI::IsMember({"dds", "lcm"}))->required();
  app.add_option("--domain", o->domain, "domain of the transport")->transform(wholeRange(0, 232))->required();
  app.add_option("--rate", o->rate, "samples per second")
      ->check(CLI::IsMember({30.0, 60.0, 120.0}))
      ->required();
  app.add_option("--from", o->from, "time of the first sample, ns of the steady clock")->required();
  return [o] { return sendPoses(*o); };
}

}  // namespace strandcast
