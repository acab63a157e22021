#include "transport/metrics.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace strandcast {
namespace {

constexpr MetricInfo kMetrics[] = {
    {"rate", "1/s", false, "frames per second, as set", &Metrics::rate},
    {"frames_late", "frames", true, "published late, because the machine was too slow",
     &Metrics::frames_late},
    {"largest_pixels", "px", false,
     "diameter of the hair in the largest picture of all readers; 0: in none; -1: a reader does not tell",
     &Metrics::largest_pixels},
    {"readers_lost", "frames", false, "lost by the present readers, in sum", &Metrics::readers_lost},
    {"pose_state", "", false,
     "0 none, 1 live, 2 extrapolated, 3 at rest, 4 rejoining: of the source that moves the hair",
     &Metrics::pose_state},
    {"pose_sources", "sources", false, "live sources that are heard", &Metrics::pose_sources},
    {"pose_samples", "samples", true, "taken of live sources", &Metrics::pose_samples,
     "samples of live poses"},
    {"pose_late", "samples", true, "came after their step", &Metrics::pose_late, "of them late"},
    {"pose_lost", "samples", true, "never came", &Metrics::pose_lost, "lost"},
    {"pose_repeated", "samples", true, "were here already", &Metrics::pose_repeated},
    {"pose_refused", "messages", true, "of too many sources, without known names, or for what others move",
     &Metrics::pose_refused},
    {"pose_jumps", "steps", true, "the motion jumped", &Metrics::pose_jumps, "jumps of live poses"},
    {"pose_relocks", "locks", true, "a source's clock was set, or poses were skipped", &Metrics::pose_relocks,
     "clocks of live poses set"},
    {"pose_interpolated", "steps", true, "between samples", &Metrics::pose_interpolated,
     "steps between samples"},
    {"pose_extrapolated", "steps", true, "after the last sample", &Metrics::pose_extrapolated,
     "steps after the last sample"},
    {"pose_rested", "steps", true, "at rest after the last sample", &Metrics::pose_rested,
     "steps at rest after it"},
    {"pose_delay_ms", "ms", false, "for which steps wait behind the fastest samples",
     &Metrics::pose_delay_ms},
    {"pose_jitter_ms", "ms", false, "by which the latest sample of ten seconds came after the fastest ones",
     &Metrics::pose_jitter_ms},
    {"pose_age_ms", "ms", false, "of the sample that is shown", &Metrics::pose_age_ms},
    {"pose_latency_ms_p50", "ms", false, "from sample to frame without the least one-way delay, median",
     &Metrics::pose_latency_ms_p50, "latency of live poses, median"},
    {"pose_latency_ms_p99", "ms", false, "the same, 99th percentile", &Metrics::pose_latency_ms_p99,
     "latency of live poses, 99th percentile"},
    {"pose_clock_ms", "ms", false, "from sending to arrival by both system clocks, median",
     &Metrics::pose_clock_ms},
    {"budget_ms", "ms", false, "that a frame of this character may cost while others are late; 0: no limit",
     &Metrics::budget_ms}};

std::vector<std::string> wordsOf(const std::string& names) {
  std::vector<std::string> words;
  for (size_t begin = 0; begin < names.size();) {
    const size_t end = std::min(names.find(' ', begin), names.size());
    words.push_back(names.substr(begin, end - begin));
    begin = end + 1;
  }
  return words;
}

}  // namespace

std::span<const MetricInfo> metricList() { return kMetrics; }

MetricTable metricTable(const Metrics& metrics) {
  MetricTable table;
  for (const MetricInfo& info : kMetrics) {
    table.names += (table.names.empty() ? "" : " ") + std::string(info.name);
    table.values.push_back(metrics.*info.value);
  }
  return table;
}

bool isSound(const MetricTable& table) {
  return table.values.size() <= kMaxMetrics && wordsOf(table.names).size() == table.values.size() &&
         std::all_of(table.values.begin(), table.values.end(), [](double v) { return std::isfinite(v); });
}

std::map<std::string, double> namedValues(const MetricTable& table) {
  std::map<std::string, double> named;
  const std::vector<std::string> names = wordsOf(table.names);
  for (size_t i = 0; i < names.size(); ++i) named[names[i]] = table.values[i];
  return named;
}

}  // namespace strandcast
