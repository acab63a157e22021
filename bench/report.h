// What saved results say: power laws of cost, the ratio to Bullet, key figures and their goals
// (headlines.cc), and docs/performance.md (performance_page.cc).
#pragma once
#include <nlohmann/json.hpp>

#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "bench/table.h"

namespace strandcast {

/// y = factor x^exponent, by least squares of log y against log x.
struct PowerLaw {
  double exponent = 0, factor = 0;
  double standard_error = 0;  ///< of the exponent; 0 with two points
};
/// Precondition: at least two points of different x, all coordinates above 0.
PowerLaw fitPowerLaw(std::span<const std::pair<double, double>> points);

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

/// The CSV files of one machine by base name: "scaling" for scaling.csv.
using Results = std::map<std::string, CsvFile>;
/// Reads all *.csv of a folder. Throws Error.
Results readResults(const std::filesystem::path& folder);

/// A key figure, its goal, and the command that measures it again.
struct Headline {
  std::string what, measured;
  std::string goal;           ///< may be empty
  std::optional<bool> holds;  ///< empty without a goal
  std::string command;
};
/// The key figures that `results` provide.
std::vector<Headline> headlinesOf(const Results& results);

/// The command in the first comment of a file.
std::string commandOf(const CsvFile& file);

/// docs/performance.md and its plots, generated.
struct PerformancePage {
  std::string text;
  std::map<std::string, std::string> images;  ///< SVG documents by file name
};
/// Generates the page from the machines' folders in `results`. Deterministic: the same files give the same
/// bytes. Throws Error.
PerformancePage performancePage(const std::filesystem::path& results);

}  // namespace strandcast
