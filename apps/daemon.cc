#include "apps/daemon.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <random>
#include <thread>

#include "apps/scene_simulation.h"
#include "core/error.h"
#include "transport/answers.h"

namespace strandcast {
namespace {

using Clock = std::chrono::steady_clock;
constexpr size_t kStepWindow = 1200;     // steps that the timing statistics look back on
constexpr double kStatusInterval = 0.5;  // s
constexpr double kPullSeconds = 1;       // of simulation, after which a hand lets go that nobody moves
constexpr int kMostStepsAsked = 1000;
constexpr double kRampedHeadPoseSeconds = 0.2;  // a commanded head pose is reached in this time, smoothly

double milliseconds(Clock::duration d) { return std::chrono::duration<double, std::milli>(d).count(); }

double quantile(std::vector<double> values, double q) {
  if (values.empty()) return 0;
  const auto at = values.begin() + static_cast<ptrdiff_t>(q * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// From one pose to another and then still, with no jump in velocity.
HeadMotion rampTo(const Pose& from, const Pose& to) {
  return [=](double seconds) {
    const double t = std::clamp(seconds / kRampedHeadPoseSeconds, 0.0, 1.0);
    return interpolate(from, to, static_cast<float>(t * t * (3 - 2 * t)));
  };
}

/// The one value of a command.
int wholeNumber(const Command& command, int low, int high) {
  const bool one = command.values.size() == 1;
  if (!one || !(command.values[0] >= low && command.values[0] <= high) ||
      std::fmod(command.values[0], 1) != 0)
    throw Error(fmt::format("give one whole number from {} to {}", low, high),
                fmt::format("command {}", command.id), "");
  return static_cast<int>(command.values[0]);
}

}  // namespace

uint64_t newSession() {
  std::random_device entropy;
  const uint64_t clock = static_cast<uint64_t>(std::chrono::system_clock::now().time_since_epoch().count());
  const uint64_t session = clock ^ (static_cast<uint64_t>(entropy()) << 32 | entropy());
  return session == 0 ? 1 : session;
}

Daemon::Daemon(const Settings& settings, Scene scene, Publisher& publisher, uint64_t session)
    : settings_(settings),
      publisher_(publisher),
      motion_(scene.motion),
      head_pivot_(scene.head_pivot),
      simulation_(makeSimulation(scene, settings)) {
  frame_.groom_id = settings.groom_id;
  frame_.session = session;
  frame_.revision = 1;
  frame_.positions.resize(simulation_.model().vertices());
  step_ms_.reserve(kStepWindow);

  status_.groom_id = settings.groom_id;
  status_.session = session;
  status_.groom_name = scene.name;
  status_.backend = simulation_.backend().name();
  status_.device = simulation_.backend().device();
  status_.strands = simulation_.model().strands();
  status_.vertices = simulation_.model().vertices();

  groom_.groom_id = settings.groom_id;
  groom_.session = session;
  groom_.revision = frame_.revision;
  groom_.name = scene.name;
  groom_.hair_radius = simulation_.parameters().hair_radius;
  groom_.guides = std::move(scene.groom.strands);
  body_.groom_id = settings.groom_id;
  body_.session = session;
  body_.mesh = std::move(scene.body);
  body_.head_weights = std::move(scene.head_weights);
}

void Daemon::announce() {
  publisher_.announce(groom_, body_);
  groom_ = {};
  body_ = {};
}

void Daemon::apply(const Command& command) {
  const std::string where = fmt::format("command {}", command.id);
  switch (command.kind) {
    case CommandKind::kSetParameter: {
      Parameters parameters = simulation_.parameters();
      setParameter(parameters, command.name, command.values, where);
      simulation_.setParameters(parameters);
      return;
    }
    case CommandKind::kHeadPose: {
      const auto& v = command.values;
      const bool finite =
          std::all_of(v.begin(), v.end(), [](double x) { return std::isfinite(x) && std::fabs(x) < 1e3; });
      if (v.size() != 7 || !finite)
        throw Error("a head pose takes 7 finite numbers", where, "position, rotation x y z w");
      const Quat rotation(Eigen::Quaterniond(v[6], v[3], v[4], v[5]).cast<float>());
      if (!(rotation.norm() > 0.5f)) throw Error("the head's rotation is not a unit quaternion", where, "");
      const Pose to{Vec3(Eigen::Vector3d(v[0], v[1], v[2]).cast<float>()), rotation.normalized()};
      motion_ = rampTo(simulation_.headPose(), to);
      motion_start_ = simulation_.time();
      return;
    }
    case CommandKind::kHeadMotion: {
      motion_ = headMotion(command.name, head_pivot_);
      motion_start_ = simulation_.time();
      return;
    }
    case CommandKind::kReset:
      simulation_.reset();
      return;
    case CommandKind::kShutdown:
      shutdown_ = true;
      return;
    case CommandKind::kPause:
      paused_ = wholeNumber(command, 0, 1) == 1;
      return;
    case CommandKind::kStep:
      if (!paused_) throw Error("only a paused simulation takes single steps", where, "pause it first");
      steps_asked_ = wholeNumber(command, 1, kMostStepsAsked);
      return;
    case CommandKind::kPull:
      pull(command);
      return;
  }
  throw Error("unknown kind of command", where, "is the sender newer than this daemon?");
}

void Daemon::pull(const Command& command) {
  const auto& v = command.values;
  if (v.empty()) return simulation_.letGo();
  if (v.size() != 8)
    throw Error("a pull takes 8 numbers", fmt::format("command {}", command.id),
                "where it closes, radius, where it is, rate; none lets go");
  const auto at = [&](size_t i) { return Vec3(Eigen::Vector3d(v[i], v[i + 1], v[i + 2]).cast<float>()); };
  simulation_.pullHair(at(0), static_cast<float>(v[3]), at(4), static_cast<float>(v[7]));
  pull_until_ = simulation_.time() + kPullSeconds;
}

void Daemon::obey(const Command& command) {
  answerCommand(
      command, [&] { apply(command); }, status_);
  if (!status_.last_command_error.empty()) spdlog::warn("refused: {}", status_.last_command_error);
  publisher_.publishStatus(status_);  // the answer; its measured numbers are those of the last look
}

void Daemon::advance() {
  const Clock::time_point start = Clock::now();
  if (simulation_.pulledVertices() > 0 && simulation_.time() > pull_until_) simulation_.letGo();
  simulation_.setHeadPose(motion_(simulation_.time() + simulation_.parameters().time_step - motion_start_));
  simulation_.step();
  status_.strands_reset +=
      simulation_.resetBroken();  // waits for the backend: the time is that of the whole step
  const double ms = milliseconds(Clock::now() - start);
  if (step_ms_.size() < kStepWindow)
    step_ms_.push_back(ms);
  else
    step_ms_[step_count_ % kStepWindow] = ms;
  ++step_count_;
}

void Daemon::publishFrame() {
  const std::span<const Vec3> guides = simulation_.guides();
  std::copy(guides.begin(), guides.end(), frame_.positions.begin());
  ++frame_.frame;
  frame_.simulation_time = simulation_.time();
  frame_.head = simulation_.headPose();
  frame_.publish_time = static_cast<uint64_t>(std::chrono::duration_cast<std::chrono::nanoseconds>(
                                                  std::chrono::system_clock::now().time_since_epoch())
                                                  .count());
  publisher_.publish(frame_);
  status_.frames = frame_.frame;
  if (observer_) observer_(simulation_);
}

void Daemon::publishStatus() {
  const Measurement measured = simulation_.measure();
  status_.simulation_time = simulation_.time();
  status_.step_ms_median = quantile(step_ms_, 0.5);
  status_.step_ms_p95 = quantile(step_ms_, 0.95);
  status_.mean_stretch = measured.mean_stretch;
  status_.max_stretch = std::max(status_.max_stretch, measured.max_stretch);
  status_.max_penetration = std::max(status_.max_penetration, measured.max_penetration);
  status_.non_finite = measured.non_finite;
  status_.readers = publisher_.matchedReaders();
  status_.encoding = publisher_.encoding();
  publisher_.publishStatus(status_);
}

bool Daemon::castFrame(const std::atomic<bool>& stop) {
  while (const std::optional<Command> command = publisher_.takeCommand()) obey(*command);
  const double step = simulation_.parameters().time_step;
  for (; steps_asked_ > 0 && !stop; --steps_asked_) advance();
  if (paused_) {
    publishFrame();
    return true;
  }
  for (owed_ += 1 / settings_.rate; owed_ > step * (1 - 1e-6); owed_ -= step) {
    if (stop) return false;
    advance();
  }
  publishFrame();
  return true;
}

DaemonSummary Daemon::run(const std::atomic<bool>& stop) {
  DaemonSummary summary;
  const Clock::time_point start = Clock::now();
  const auto interval =
      std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(1 / settings_.rate));
  Clock::time_point due = start, status_due = start;
  while (!stop && !shutdown_) {
    if (!castFrame(stop)) break;
    const Clock::time_point now = Clock::now();
    if (now >= status_due) {
      publishStatus();
      status_due =
          now + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(kStatusInterval));
    }
    if (settings_.duration > 0 && std::chrono::duration<double>(now - start).count() >= settings_.duration)
      break;
    due += interval;
    if (Clock::now() > due) {
      ++summary.late_frames;
      due = Clock::now();
    }
    std::this_thread::sleep_until(due);
  }
  publishStatus();
  summary.seconds = std::chrono::duration<double>(Clock::now() - start).count();
  summary.status = status_;
  return summary;
}

}  // namespace strandcast
