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
    {"readers_lost", "frames", false, "lost by the present readers, in sum", &Metrics::readers_lost}};

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
