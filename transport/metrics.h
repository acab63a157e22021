// Measured values of a daemon, by name: Status::metrics.
#pragma once
#include <cstddef>
#include <map>
#include <string>

#include "transport/messages.h"

namespace strandcast {

inline constexpr size_t kMaxMetrics = 256, kMaxMetricNameBytes = 8192;

/// Whether a received table has as many names as values, at most kMaxMetrics, all finite.
bool isSound(const MetricTable& table);
/// Values by name. Precondition: isSound(table).
std::map<std::string, double> namedValues(const MetricTable& table);

}  // namespace strandcast
