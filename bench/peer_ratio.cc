#include "bench/peer_ratio.h"

#include <algorithm>

namespace strandcast {

std::optional<nlohmann::json> cheapestWithin(const std::vector<nlohmann::json>& rows,
                                             const std::string& solver, double stretch) {
  std::optional<nlohmann::json> best;
  for (const nlohmann::json& row : rows) {
    if (row["solver"] != solver || !row.contains("max_stretch") || row["max_stretch"].is_null()) continue;
    if (row["max_stretch"] <= stretch &&
        (!best || row["ns_per_vertex_frame"] < (*best)["ns_per_vertex_frame"]))
      best = row;
  }
  return best;
}

std::optional<PeerRatio> bulletOverRod(const std::vector<nlohmann::json>& rows, int substeps) {
  const auto rod = std::find_if(rows.begin(), rows.end(), [&](const nlohmann::json& row) {
    return row["solver"] == "rod" && row["substeps"] == substeps;
  });
  if (rod == rows.end()) return std::nullopt;
  PeerRatio out;
  out.stretch = (*rod)["max_stretch"];
  if (const auto within = cheapestWithin(rows, "bullet", out.stretch)) {
    out.reached = true;
    out.bullet = *within;
  } else {
    for (const nlohmann::json& row : rows)
      if (row["solver"] == "bullet" && row.contains("max_stretch") && !row["max_stretch"].is_null() &&
          (out.bullet.is_null() || row["max_stretch"] < out.bullet["max_stretch"]))
        out.bullet = row;
    if (out.bullet.is_null()) return std::nullopt;
  }
  out.ratio = out.bullet["ns_per_vertex_frame"].get<double>() / (*rod)["ns_per_vertex_frame"].get<double>();
  return out;
}

}  // namespace strandcast
