#include "service/daemon.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <time.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <thread>
#include <utility>

#include "core/error.h"
#include "core/srgb.h"
#include "service/colliders.h"
#include "service/frame_pacer.h"
#include "transport/commands.h"
#include "transport/frame_queue.h"

namespace strandcast {
namespace {

using Clock = std::chrono::steady_clock;

uint8_t storedOf(float linear) {
  return static_cast<uint8_t>(std::lround(255 * srgbOf(std::clamp(linear, 0.0f, 1.0f))));
}

/// The channel sets groom, session and revision.
HairDescription described(SceneHairs hairs) {
  HairDescription out;
  for (const Vec3& colour : hairs.strands.colours)
    out.colours.push_back({storedOf(colour.x()), storedOf(colour.y()), storedOf(colour.z())});
  hairs.strands.colours.clear();
  out.ids = std::exchange(hairs.strands.ids, {});
  out.hairs = std::move(hairs.strands);
  out.bindings = std::move(hairs.bindings);
  out.source = std::move(hairs.source);
  return out;
}

double millisecondsOf(Clock::duration d) { return std::chrono::duration<double, std::milli>(d).count(); }

/// Measures the cost of a frame, ms, from its construction on. On a processor that is time of this thread,
/// which takes part in all its work: wall time would include what others do meanwhile. A thread that waits
/// for a GPU takes none, so there wall time counts.
class FrameClock {
 public:
  explicit FrameClock(bool is_on_gpu)
      : clock_(is_on_gpu ? CLOCK_MONOTONIC : CLOCK_THREAD_CPUTIME_ID), start_(now()) {}
  double milliseconds() const { return now() - start_; }

 private:
  double now() const {
    timespec time{};
    clock_gettime(clock_, &time);
    return 1e3 * static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_nsec);
  }
  clockid_t clock_;
  double start_;
};

/// Guides of a simulation. A device that cannot pack them is told once, and then not asked again.
class SimulationGuides final : public GuideSource {
 public:
  explicit SimulationGuides(Simulation& simulation) : simulation_(simulation) {}
  size_t vertices() const override { return simulation_.model().vertices(); }
  std::span<const Vec3> positions(size_t first, size_t count) override {
    return simulation_.guidesOf(first, count);
  }
  std::span<const PackedRun> packed(const GuideGrid& grid, const PackingFrame& frame) override {
    if (grid.number == unpackable_grid_) return {};
    std::span<const PackedRun> out;
    const std::string why = errorTextOf([&] { out = simulation_.packGuides(grid, frame); });
    if (why.empty()) return out;
    unpackable_grid_ = grid.number;
    spdlog::warn("guides are packed on the processor: {}", why);
    return {};
  }

 private:
  Simulation& simulation_;
  uint64_t unpackable_grid_ = 0;
};

}  // namespace

Daemon::Daemon(const Settings& settings, Scene scene, Publisher& publisher, uint64_t session)
    : settings_(settings),
      publisher_(publisher),
      conflict_detector_(settings.groom_id),
      controlled_(settings, scene, publisher, session),
      guides_(std::make_unique<SimulationGuides>(controlled_.simulation)),
      report_(settings.groom_id, session, scene.name, controlled_.simulation),
      sharing_(settings, scene, controlled_, report_, publisher),
      executor_(controlled_, report_,
                [this](uint64_t command, const std::string& refusal) { answer(command, refusal); }) {
  frame_.groom_id = settings.groom_id;
  frame_.session = session;
  frame_.revision = 1;
  report_.setParameters(controlled_.table());

  groom_.groom_id = settings.groom_id;
  groom_.session = session;
  groom_.revision = frame_.revision;
  groom_.name = scene.name;
  groom_.hair_radius = controlled_.simulation.parameters().hair_radius;
  groom_.guides = std::move(scene.groom.strands);
  hairs_ = described(std::move(scene.hairs));
  if (hairs_.hairs.strands() > 0) groom_.growth = GroomDescription::kHairs;
  body_.groom_id = settings.groom_id;
  body_.session = session;
  body_.mesh = std::move(scene.body);
  body_.head_weights = std::move(scene.head_weights);
}

void Daemon::announce() {
  const size_t free = placedColliders(controlled_.simulation).size();
  if (free > kMaxPlacedColliders)
    throw Error(fmt::format("{} bodies do not follow the head", free), status().groom_name,
                fmt::format("at most {} are published: leave out the names of standing [[body.primitives]], "
                            "which then form one body",
                            kMaxPlacedColliders));
  publisher_.announce(groom_, body_);
  if (hairs_.hairs.strands() > 0) publisher_.announceHairs(hairs_);
  controlled_.colliders.announce();
  groom_ = {};
  body_ = {};
  hairs_ = {};
}

void Daemon::answer(uint64_t command, const std::string& refusal) {
  if (sharing_.keepAnswer(command, refusal)) return;
  report_.setTime();
  report_.setAnswer(command, refusal);
  sharing_.recordAnswer(command, refusal);
  if (!refusal.empty()) spdlog::warn("refused: {}", refusal);
  publisher_.publishStatus(status());  // measured values are those of the last measure()
}

bool Daemon::runRequestedSteps(const std::atomic<bool>& stop) {
  StepSchedule& steps = controlled_.steps;
  const auto end = Clock::now() + std::chrono::duration<double>(0.5 / settings_.rate);
  do {
    if (stop) return false;
    advance();
    if (!steps.countStep()) continue;
    report_.measure();  // the answer to a step command carries current measurements
    answer(steps.requests().front().command, {});
    steps.pop();
  } while (!steps.requests().empty() &&
           (takes_another_ ? takes_another_(controlled_.simulation) : Clock::now() < end));
  return true;
}

void Daemon::advance() {
  const Clock::time_point start = Clock::now();
  const size_t strands_reset = controlled_.advance();
  report_.addStep(millisecondsOf(Clock::now() - start), strands_reset);
}

void Daemon::publishFrame() {
  Simulation& simulation = controlled_.simulation;
  ++frame_.frame;
  frame_.simulation_time = simulation.time();
  frame_.head = simulation.headPose();
  frame_.pose_source = controlled_.poses.source();
  frame_.pose_time = controlled_.poses.time();
  frame_.continuity = controlled_.cuts + controlled_.resets;
  frame_.colliders = controlled_.colliders.placed();
  frame_.publish_time = static_cast<uint64_t>(std::chrono::duration_cast<std::chrono::nanoseconds>(
                                                  std::chrono::system_clock::now().time_since_epoch())
                                                  .count());
  if (sharing_.isParticipating()) publisher_.publishFrom(frame_, *guides_);
  controlled_.poses.countFrame(static_cast<int64_t>(steadyTime()));
  report_.setFrames(frame_.frame);
  report_.measureSlice(static_cast<size_t>(std::ceil(static_cast<double>(simulation.model().strands()) /
                                                     std::max(kStatusInterval * settings_.rate, 1.0))));
  if (observer_) observer_(simulation);
}

void Daemon::publishStatus() {
  report_.setParameters(controlled_.table());
  report_.setPoses(controlled_.poses.metrics(static_cast<int64_t>(steadyTime())));
  const ReaderSummary readers = publisher_.readers();
  report_.metrics().rate = settings_.rate;
  report_.metrics().budget_ms = budget_ ? budget_->budget() : 0;
  report_.metrics().largest_pixels = readers.largest_pixels;
  report_.metrics().readers_lost = static_cast<double>(readers.frames_lost);
  report_.measure();
  report_.setChannel(publisher_.matchedReaders(), publisher_.encoding());
  publisher_.publishStatus(status());
  if (const auto why =
          conflict_detector_.check(publisher_, status().session, status().frames, Clock::now() - cast_since_))
    failure_ = *why;
}

bool Daemon::executeCommands(const std::atomic<bool>& stop) {
  for (const Command& command : sharing_.takeOver()) executor_.execute(command);
  for (size_t taken = 0; taken < kMaxCommandsPerFrame; ++taken) {
    const std::optional<Command> command = publisher_.takeCommand();
    if (!command) break;
    executor_.execute(*command);
    if (waits_for_bodies_ && !executor_.waitUntilBodiesMade(stop)) return false;
  }
  return true;
}

bool Daemon::joinShow(CastingState turn) {
  bool has_show = false;
  failure_ = errorTextOf([&] { has_show = sharing_.join(turn, time_accumulator_); });
  return has_show;
}

bool Daemon::castFrame(const std::atomic<bool>& stop) {
  if (publisher_.pollClaimLoss()) sharing_.waitForShow();
  const CastingState turn = publisher_.castingState();
  if (sharing_.isWaiting() && !joinShow(turn)) return true;
  executor_.addMadeBodies();
  if (sharing_.mustFollow(turn)) {
    failure_ = errorTextOf([&] { sharing_.follow(time_accumulator_); });
    if (!failure_.empty()) return true;
  } else if (!executeCommands(stop)) {
    return false;
  }
  const double step = controlled_.simulation.parameters().time_step;
  const bool is_paused = controlled_.steps.isPaused();
  if (is_paused)
    controlled_.poses.idle(controlled_.simulation.time() + step, static_cast<int64_t>(steadyTime()));
  if (is_paused && !sharing_.isFollowing()) {
    if (!controlled_.steps.requests().empty() && !runRequestedSteps(stop)) return false;
    publishFrame();
    sharing_.publishShowIfDue();
    return true;
  }
  for (time_accumulator_ += is_paused ? 0 : 1 / settings_.rate; time_accumulator_ > step * (1 - 1e-6);
       time_accumulator_ -= step) {
    if (stop) return false;
    advance();
  }
  publishFrame();
  if (turn == CastingState::kOwn) sharing_.publishShowIfDue();
  return true;
}

double Daemon::nextFrameEnd() const {
  const double step = double{controlled_.simulation.parameters().time_step};
  const double ahead = time_accumulator_ + 1 / settings_.rate;
  return controlled_.simulation.time() + step * std::floor(ahead / step + 1e-6);
}

DaemonSummary Daemon::run(const std::atomic<bool>& stop) {
  DaemonSummary summary;
  const Clock::time_point start = Clock::now();
  FramePacer pacer(settings_.rate, start);
  Clock::time_point status_due = start;
  cast_since_ = start;
  while (!stop && !executor_.isShutDown() && !sharing_.isShutDown() && failure_.empty()) {
    const FrameClock cost(status().backend == "gpu");
    if (!castFrame(stop)) break;
    const double cost_ms = cost.milliseconds();
    const Clock::time_point now = Clock::now();
    if (now >= status_due) {
      report_.metrics().frames_late = static_cast<double>(pacer.lateFrames());
      publishStatus();
      status_due =
          now + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(kStatusInterval));
    }
    if (settings_.duration > 0 && std::chrono::duration<double>(now - start).count() >= settings_.duration)
      break;
    const Clock::time_point due = pacer.next(Clock::now(), controlled_.poses.wantedAt(nextFrameEnd()));
    if (pacer.isTooSlow()) controlled_.poses.release();
    if (budget_) pacer.setSlowdown(budget_->addFrame(cost_ms, pacer.isLate(), Clock::now()));
    std::this_thread::sleep_until(due);
  }
  executor_.dropSteps("the daemon ends");
  executor_.dropBodies();
  publishStatus();
  summary.seconds = std::chrono::duration<double>(Clock::now() - start).count();
  summary.late_frames = pacer.lateFrames();
  summary.status = status();
  summary.poses = report_.poses();
  summary.failure = failure_;
  return summary;
}

}  // namespace strandcast
