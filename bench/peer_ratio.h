#pragma once
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace strandcast {

/// Among rows of `strandbench peers`: the cheapest one of a solver whose largest stretch is at most
/// `stretch`.
std::optional<nlohmann::json> cheapestWithin(const std::vector<nlohmann::json>& rows,
                                             const std::string& solver, double stretch);
/// Cost of Bullet's ropes relative to the rod of `substeps` at equal or smaller stretch.
struct PeerRatio {
  double stretch = 0;     ///< largest stretch of the rod
  bool reached = false;   ///< some setting of Bullet stretches no more; otherwise the members below are of
                          ///< its smallest stretch
  nlohmann::json bullet;  ///< row of that setting
  double ratio = 0;       ///< of the costs, Bullet over rod
};
/// Empty where the rows have no such rod or no Bullet.
std::optional<PeerRatio> bulletOverRod(const std::vector<nlohmann::json>& rows, int substeps);

}  // namespace strandcast
