#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace strandcast {

/// The plots of docs/performance.md as complete SVG documents, from rows of the verbs' tables.

/// Largest and mean stretch against cost; of `peers`.
std::string peersPlot(const std::vector<nlohmann::json>& rows);
/// Distance of the tip from the reference against cost; of `peers`.
std::string peersTipPlot(const std::vector<nlohmann::json>& rows);
/// Time of a step against strands, vertices and substeps; of `scaling`.
std::string scalingPlot(const std::vector<nlohmann::json>& rows);
/// Fraction of frames with a latency above a given time, ms; of `end-to-end`.
std::string latencyPlot(const std::vector<nlohmann::json>& rows);

}  // namespace strandcast
