#include "bench/plots.h"

#include <fmt/format.h>

#include "bench/axis_fit.h"
#include "bench/svg_plot.h"

namespace strandcast {
namespace {

/// A number of a row; not positive where it is missing, so that logarithmic plots skip it.
double number(const nlohmann::json& row, const std::string& key) {
  const auto found = row.find(key);
  return found != row.end() && found->is_number() ? found->get<double>() : 0;
}

std::string shade(const std::string& solver, int substeps) {
  constexpr const char* kBlues[] = {"#9ecae1", "#6baed6", "#4292c6", "#2171b5", "#084594"};
  constexpr const char* kGreens[] = {"#a1d99b", "#74c476", "#41ab5d", "#238b45", "#005a32"};
  if (solver == "rod") return "#d55e00";
  size_t power = 0;
  while ((2 << power) <= substeps && power + 1 < std::size(kBlues)) ++power;
  return solver == "bullet" ? kGreens[power] : kBlues[power];
}

std::string seriesOf(const nlohmann::json& row) {
  const std::string solver = row["solver"];
  const int substeps = row["substeps"];
  if (solver == "rod") return "rod";
  return fmt::format("{}, {} substep{}", solver == "bullet" ? "Bullet rope" : solver, substeps,
                     substeps == 1 ? "" : "s");
}

PlotPanel peersPanel(const std::vector<nlohmann::json>& rows, const std::string& title,
                     const std::string& key, double factor) {
  PlotPanel panel;
  panel.title = title;
  for (const nlohmann::json& row : rows) {
    const std::string name = seriesOf(row);
    if (panel.series.empty() || panel.series.back().name != name)
      panel.series.push_back({name, shade(row["solver"], row["substeps"]), {}});
    const bool rod = row["solver"] == "rod";
    const auto iterations = static_cast<int>(number(row, "iterations"));
    // Few labels: the values between them double along the line.
    const bool labelled = rod || iterations == 1 || iterations == 64 || iterations == 1024;
    panel.series.back().points.push_back(
        {number(row, "ns_per_vertex_frame"), factor * number(row, key),
         labelled ? fmt::format("{}", rod ? row["substeps"].get<int>() : iterations) : ""});
  }
  return panel;
}

constexpr const char* kPeersCost = "processor time per vertex and frame of 1/60 s, ns, one thread";
constexpr const char* kPeersNote =
    "Labels: substeps of the rod, iterations per substep of the others, which double (or quadruple) along a "
    "line.";

}  // namespace

std::string peersPlot(const std::vector<nlohmann::json>& rows) {
  return logLogPlot(kPeersCost, "stretch, %", kPeersNote,
                    {peersPanel(rows, "largest stretch", "max_stretch", 100),
                     peersPanel(rows, "mean stretch", "mean_stretch", 100)});
}

std::string peersTipPlot(const std::vector<nlohmann::json>& rows) {
  return logLogPlot(kPeersCost, "rms error of the shaken tip, mm", kPeersNote,
                    {peersPanel(rows, "tip against an exact rod", "tip_error_mm", 1)});
}

std::string scalingPlot(const std::vector<nlohmann::json>& rows) {
  PlotPanel panel;
  panel.title = "cost of size";
  const std::pair<const char*, const char*> axes[] = {
      {"strands", "#d55e00"}, {"vertices", "#0072b2"}, {"substeps", "#009e73"}};
  for (const auto& [axis, color] : axes) {
    PlotSeries series{axis, color, {}};
    for (const AxisFit& fit : fitAxes(rows))
      if (fit.axis == axis) series.name = fmt::format("{}, power of {:.2f}", axis, fit.law.exponent);
    for (const nlohmann::json& row : rows)
      if (row["axis"] == axis) series.points.push_back({number(row, "value"), minMs(row), ""});
    if (!series.points.empty()) panel.series.push_back(series);
  }
  return logLogPlot("strands, vertices per strand, or substeps", "least time of a step, ms",
                    "Processor time for one thread; wall time for several threads or a GPU.", {panel});
}

std::string latencyPlot(const std::vector<nlohmann::json>& rows) {
  PlotPanel panel;
  panel.title = "latency, motion to hair";
  constexpr const char* kColors[] = {"#d55e00", "#0072b2", "#009e73", "#cc79a7"};
  for (const nlohmann::json& row : rows) {
    PlotSeries series{fmt::format("{:g} Hz", number(row, "rate_hz")),
                      kColors[panel.series.size() % std::size(kColors)],
                      {}};
    for (const auto& [key, slower] : {std::pair{"ms_p10", 0.9},
                                      {"ms_p25", 0.75},
                                      {"ms_median", 0.5},
                                      {"ms_p75", 0.25},
                                      {"ms_p90", 0.1},
                                      {"ms_p95", 0.05},
                                      {"ms_p99", 0.01}})
      series.points.push_back({number(row, key), slower, ""});
    panel.series.push_back(series);
  }
  return logLogPlot("latency, ms", "fraction of the frames that take longer",
                    "The lowest point is the 99th percentile.", {panel});
}

}  // namespace strandcast
