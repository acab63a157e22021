#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "bench/power_law.h"

namespace strandcast {

/// How time grows along one axis.
struct AxisFit {
  std::string axis;
  PowerLaw law;
  size_t points = 0;
};
/// Of a row of `strandbench scaling`: the least time of a step, ms; of one thread in processor time, which
/// what else runs on the machine does not change, else by the wall.
double leastMs(const nlohmann::json& row);
/// Of the axes strands, vertices and substeps that `rows` have two points of at least.
std::vector<AxisFit> fitAxes(const std::vector<nlohmann::json>& rows);

}  // namespace strandcast
