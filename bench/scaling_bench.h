#pragma once
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "bench/power_law.h"

namespace CLI {
class App;
}

namespace strandcast {

/// Declares the verb `scaling` on `app` and gives what runs it: how cost and memory grow with strands,
/// vertices, substeps, threads, lanes, grooms and readers.
std::function<int()> addScalingBench(CLI::App& app);

/// How time grows along one axis.
struct AxisFit {
  std::string axis;
  PowerLaw law;
  size_t points = 0;
};
/// Of a row of the verb: the least time of a step, ms; of one thread in processor time, which what else runs
/// on the machine does not change, else by the wall.
double leastMs(const nlohmann::json& row);
/// Of the axes strands, vertices and substeps that `rows` have two points of at least.
std::vector<AxisFit> fitAxes(const std::vector<nlohmann::json>& rows);

}  // namespace strandcast
