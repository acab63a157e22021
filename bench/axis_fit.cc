#include "bench/axis_fit.h"

namespace strandcast {

double minMs(const nlohmann::json& row) {
  const bool one_thread = row["threads"] == 1 && row["device"].get<std::string>().ends_with("1 thread");
  return row[one_thread ? "cpu_ms_min" : "ms_min"].get<double>();
}

std::vector<AxisFit> fitAxes(const std::vector<nlohmann::json>& rows) {
  std::vector<AxisFit> fits;
  for (const char* axis : {"strands", "vertices", "substeps"}) {
    std::vector<std::pair<double, double>> points;
    for (const nlohmann::json& row : rows)
      if (row["axis"] == axis) points.emplace_back(row["value"].get<double>(), minMs(row));
    if (points.size() >= 2) fits.push_back({axis, fitPowerLaw(points), points.size()});
  }
  return fits;
}

}  // namespace strandcast
