#include "service/shake_trial.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "service/colliders.h"
#include "service/scene_simulation.h"

namespace strandcast {
namespace {

constexpr double kSpeedWindow = 0.5;  // s, the end of the rest period in which speeds are averaged

}  // namespace

ShakeTrial::ShakeTrial(const Scene& scene, const Settings& settings, double shake, double rest)
    : simulation_(makeSimulation(scene, settings)),
      skinned_(scene.skinned),
      motion_(endingAt(scene.motion, shake, scene.head_pivot)) {
  const double step = simulation_.parameters().time_step;
  auto stepsIn = [&](double seconds) { return static_cast<size_t>(std::ceil(seconds / step - 1e-3)); };
  shake_steps_ = stepsIn(shake);
  speed_steps_ = stepsIn(std::min(rest, kSpeedWindow));
  steps_ = shake_steps_ + stepsIn(rest);
  squared_speeds_.resize(simulation_.model().strands());
}

void ShakeTrial::step() {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point start = Clock::now();
  const double end = simulation_.time() + static_cast<double>(simulation_.parameters().time_step);
  moveTo(skinned_.get(), end, motion_(end), simulation_);
  simulation_.step();
  result_.strands_reset += simulation_.resetDiverged();  // synchronises with the backend
  step_ms_.push_back(std::chrono::duration<double, std::milli>(Clock::now() - start).count());

  const Measurement now = simulation_.measure();
  result_.max_penetration = std::max(result_.max_penetration, now.max_penetration);
  if (step_ms_.size() <= shake_steps_) {
    result_.mean_stretch += now.mean_stretch / static_cast<double>(shake_steps_);
    result_.max_stretch = std::max(result_.max_stretch, now.max_stretch);
  }
  if (step_ms_.size() > steps_ - speed_steps_) addSpeeds();
}

void ShakeTrial::addSpeeds() {
  const StrandModel& model = simulation_.model();
  simulation_.backend().download(state_);
  for (size_t s = 0; s < model.strands(); ++s)
    for (uint32_t v = model.offsets[s]; v < model.offsets[s + 1]; ++v)
      squared_speeds_[s] += state_.velocities[v].cast<double>().squaredNorm();
}

void ShakeTrial::fill(GuideFrame& frame) {
  const std::span<const Vec3> guides = simulation_.guides();
  frame.positions.assign(guides.begin(), guides.end());
  frame.head = simulation_.headPose();
  frame.colliders = placedColliders(simulation_);
  frame.simulation_time = simulation_.time();
}

ShakeResult ShakeTrial::result() {
  const StrandModel& model = simulation_.model();
  const auto vertices = static_cast<double>(model.vertices());
  ShakeResult out = result_;
  std::vector<double> ms = step_ms_;
  std::nth_element(ms.begin(), ms.begin() + static_cast<ptrdiff_t>(ms.size() / 2), ms.end());
  out.step_ms_median = ms[ms.size() / 2];

  const std::vector<Vec3> style = restState(model, simulation_.rootPoses()).positions;
  const std::span<const Vec3> guides = simulation_.guides();
  double squares = 0, largest = 0;
  for (size_t v = 0; v < style.size(); ++v) {
    const double square = (guides[v] - style[v]).cast<double>().squaredNorm();
    squares += square;
    largest = std::max(largest, square);
  }
  out.style_rms = std::sqrt(squares / vertices);
  out.style_max = std::sqrt(largest);

  const auto samples = static_cast<double>(speed_steps_);
  double all = 0;
  for (size_t s = 0; s < model.strands(); ++s) {
    all += squared_speeds_[s];
    const double mean = squared_speeds_[s] / (samples * static_cast<double>(model.verticesOf(s)));
    if (std::sqrt(mean) > kRestingSpeed) ++out.moving_strands;
  }
  out.rest_speed = std::sqrt(all / (samples * vertices));
  return out;
}

}  // namespace strandcast
