#include "service/status_report.h"

#include <algorithm>
#include <utility>

#include "core/quantile.h"

namespace strandcast {
namespace {

constexpr size_t kStepWindow = 1200;  // steps in the window of the timing statistics

}  // namespace

StatusReport::StatusReport(uint32_t groom_id, uint64_t session, std::string groom_name,
                           Simulation& simulation)
    : simulation_(simulation) {
  step_ms_.reserve(kStepWindow);
  status_.groom_id = groom_id;
  status_.session = session;
  status_.groom_name = std::move(groom_name);
  status_.backend = simulation.backend().name();
  status_.device = simulation.backend().device();
  status_.strands = simulation.model().strands();
  status_.vertices = simulation.model().vertices();
}

void StatusReport::setChannel(uint32_t readers, const EncodingReport& encoding) {
  status_.readers = readers;
  status_.encoding = encoding;
}

void StatusReport::setPoses(const PoseMetrics& poses) {
  poses_ = poses;
  metrics_.pose_state = static_cast<double>(poses.state);
  metrics_.pose_sources = static_cast<double>(poses.sources);
  metrics_.pose_samples = static_cast<double>(poses.samples);
  metrics_.pose_late = static_cast<double>(poses.late);
  metrics_.pose_lost = static_cast<double>(poses.lost);
  metrics_.pose_repeated = static_cast<double>(poses.repeated);
  metrics_.pose_refused = static_cast<double>(poses.refused);
  metrics_.pose_jumps = static_cast<double>(poses.jumps);
  metrics_.pose_relocks = static_cast<double>(poses.relocks);
  metrics_.pose_interpolated = static_cast<double>(poses.interpolated);
  metrics_.pose_extrapolated = static_cast<double>(poses.extrapolated);
  metrics_.pose_rested = static_cast<double>(poses.rested);
  metrics_.pose_delay_ms = poses.delay_ms;
  metrics_.pose_jitter_ms = poses.jitter_ms;
  metrics_.pose_age_ms = poses.age_ms;
  metrics_.pose_latency_ms_p50 = poses.latency_ms_p50;
  metrics_.pose_latency_ms_p99 = poses.latency_ms_p99;
  metrics_.pose_clock_ms = poses.clock_ms;
}

void StatusReport::setAnswer(uint64_t command, const std::string& refusal) {
  status_.last_command = command;
  status_.last_command_error = refusal;
}

void StatusReport::addStep(double ms, size_t strands_reset) {
  status_.strands_reset += strands_reset;
  if (step_ms_.size() < kStepWindow)
    step_ms_.push_back(ms);
  else
    step_ms_[step_count_ % kStepWindow] = ms;
  ++step_count_;
}

void StatusReport::measureSlice(size_t strands) {
  const size_t end = std::min(strands_measured_ + strands, simulation_.model().strands());
  measured_.add(simulation_.measure({strands_measured_, end}));
  strands_measured_ = end;
}

void StatusReport::measure() {
  measureSlice(simulation_.model().strands());
  const Measurement measured = std::exchange(measured_, {});
  strands_measured_ = 0;
  setTime();
  status_.step_ms_median = quantileOf(step_ms_, 0.5);
  status_.step_ms_p95 = quantileOf(step_ms_, 0.95);
  status_.mean_stretch = measured.mean_stretch;
  status_.max_stretch = std::max(status_.max_stretch, measured.max_stretch);
  status_.max_penetration = std::max(status_.max_penetration, measured.max_penetration);
  status_.non_finite = measured.non_finite;
  status_.metrics = metricTable(metrics_);
}

void StatusReport::reset() {
  measured_ = {};
  strands_measured_ = 0;
  status_.mean_stretch = status_.max_stretch = status_.max_penetration = 0;
  status_.non_finite = status_.strands_reset = 0;
}

}  // namespace strandcast
