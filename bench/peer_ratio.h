#pragma once
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace strandcast {

/// Of rows of `strandbench peers`: the cheapest of a solver whose largest stretch is at most `stretch`.
std::optional<nlohmann::json> cheapestWithin(const std::vector<nlohmann::json>& rows,
                                             const std::string& solver, double stretch);
/// How much more Bullet's ropes cost than the rod of `substeps` at equal or smaller stretch.
struct PeerRatio {
  double stretch = 0;     ///< of the rod, largest
  bool reached = false;   ///< some setting of Bullet stretches no more; else all of this is of its least
  nlohmann::json bullet;  ///< that setting's row
  double ratio = 0;       ///< of their costs
};
/// Nothing where the rows have no such rod or no Bullet.
std::optional<PeerRatio> bulletOverRod(const std::vector<nlohmann::json>& rows, int substeps);

}  // namespace strandcast
