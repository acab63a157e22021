#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "bench/power_law.h"

namespace strandcast {

/// Power law of time along one axis.
struct AxisFit {
  std::string axis;
  PowerLaw law;
  size_t points = 0;
};
/// From a row of `strandbench scaling`: the minimum time of a step, ms. With one thread it is processor time,
/// which other load on the machine does not change; otherwise wall time.
double minMs(const nlohmann::json& row);
/// Fits the axes strands, vertices and substeps of which `rows` have at least two points.
std::vector<AxisFit> fitAxes(const std::vector<nlohmann::json>& rows);

}  // namespace strandcast
