// Measured values of a daemon, by name: Status::metrics.
#pragma once
#include <cstddef>
#include <map>
#include <span>
#include <string>

#include "transport/messages.h"

namespace strandcast {

inline constexpr size_t kMaxMetrics = 256, kMaxMetricNameBytes = 8192;

/// What a daemon measures beside the fields of its status.
struct Metrics {
  double rate = 0;             ///< frames per second, as set
  double frames_late = 0;      ///< frames published late
  double largest_pixels = -1;  ///< ReaderSummary::largest_pixels
  double readers_lost = 0;     ///< ReaderSummary::frames_lost
  // Of live sources, PoseMetrics of service/live_poses.h:
  double pose_state = 0;
  double pose_sources = 0;
  double pose_samples = 0;
  double pose_late = 0;
  double pose_lost = 0;
  double pose_repeated = 0;
  double pose_refused = 0;
  double pose_jumps = 0;
  double pose_relocks = 0;
  double pose_interpolated = 0;
  double pose_extrapolated = 0;
  double pose_rested = 0;
  double pose_delay_ms = 0;
  double pose_jitter_ms = 0;
  double pose_age_ms = 0;
  double pose_latency_ms_p50 = 0;
  double pose_latency_ms_p99 = 0;
  double pose_clock_ms = 0;

  double budget_ms = 0;  ///< of a character of a stage (RateBudget of service/rate_budget.h)
};

/// A metric as it is named on the wire.
struct MetricInfo {
  const char* name;
  const char* unit;
  bool is_counter;  ///< counts from the daemon's start; else a present value
  const char* help;
  double Metrics::*value;
  const char* label = "";  ///< in the summary of a daemon that ends; empty: it is left out there
};
/// All metrics, in the order of the wire. A new one is listed here and is then in every status; docs/wire.md
/// has the same list.
std::span<const MetricInfo> metricList();
MetricTable metricTable(const Metrics& metrics);

/// Whether a received table has as many names as values, at most kMaxMetrics, all finite.
bool isSound(const MetricTable& table);
/// Values by name. Precondition: isSound(table).
std::map<std::string, double> namedValues(const MetricTable& table);

}  // namespace strandcast
