// A daemon's status, and the measurements in it.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "core/simulation.h"
#include "service/live_poses.h"
#include "transport/messages.h"
#include "transport/metrics.h"

namespace strandcast {

/// Fills in the status of a daemon. Strands are measured a slice at a time, because measuring all of them in
/// one frame would delay it: 0.1 s for 96,000 vertices. Not thread-safe.
class StatusReport {
 public:
  /// `simulation` must outlive the report. `groom_name`: of the scene.
  StatusReport(uint32_t groom_id, uint64_t session, std::string groom_name, Simulation& simulation);

  const Status& status() const { return status_; }
  void setParameters(ParameterTable parameters) { status_.parameters = std::move(parameters); }
  /// Of live sources; they are among the metrics from the next measure() on.
  void setPoses(const PoseMetrics& poses);
  const PoseMetrics& poses() const { return poses_; }
  void setFrames(uint64_t frames) { status_.frames = frames; }
  void setChannel(uint32_t readers, const EncodingReport& encoding);
  /// Are in the status from the next measure() on.
  Metrics& metrics() { return metrics_; }
  void setTime() { status_.simulation_time = simulation_.time(); }
  /// The answer to a command; an empty refusal means that it was executed.
  void setAnswer(uint64_t command, const std::string& refusal);

  /// A step that took `ms` milliseconds, after which `strands_reset` strands were reset.
  void addStep(double ms, size_t strands_reset);
  /// Measures the next `strands` strands of those not measured since the last measure().
  void measureSlice(size_t strands);
  /// Measures the remaining strands and fills in the status: hair, time and step durations.
  void measure();
  /// Forgets what was measured of the hair. Step durations are kept.
  void reset();

 private:
  Simulation& simulation_;
  Status status_;
  PoseMetrics poses_;
  Metrics metrics_;
  Measurement measured_;  ///< of the first strands_measured_ strands, since the last measure()
  size_t strands_measured_ = 0;
  std::vector<double> step_ms_;  ///< durations of the newest steps, a ring
  size_t step_count_ = 0;
};

}  // namespace strandcast
