#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace strandcast {

/// The plots of docs/performance.md, as whole SVG documents, from rows of the verbs' tables.

/// Stretch, largest and mean, over cost; of `peers`.
std::string peersPlot(const std::vector<nlohmann::json>& rows);
/// Distance of the tip from the truth over cost; of `peers`.
std::string peersTipPlot(const std::vector<nlohmann::json>& rows);
/// Time of a step over strands, vertices and substeps; of `scaling`.
std::string scalingPlot(const std::vector<nlohmann::json>& rows);
/// Which part of the frames took longer than so many milliseconds; of `end-to-end`.
std::string latencyPlot(const std::vector<nlohmann::json>& rows);

}  // namespace strandcast
