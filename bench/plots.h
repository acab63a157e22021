// Logarithmic plots as SVG, and those of docs/performance.md.
#pragma once
#include <nlohmann/json.hpp>

#include <string>
#include <vector>

namespace strandcast {

/// A point of a series, in the units of the axes.
struct PlotPoint {
  double x = 0, y = 0;  ///< positive; other points are skipped, because the axes are logarithmic
  std::string label;    ///< drawn beside the point; may be empty
};

/// Points joined by a line, with one mark each.
struct PlotSeries {
  std::string name;   ///< in the legend; series of the same name in several panels share one entry
  std::string color;  ///< an SVG colour, e.g. "#d55e00"
  std::vector<PlotPoint> points;
};

struct PlotPanel {
  std::string title;
  std::vector<PlotSeries> series;
};

/// Draws panels side by side on the same logarithmic axes, with a grid at 1, 2 and 5 of every decade and a
/// legend. Returns a complete SVG document, with `note` in a line below. Panels without points give an empty
/// plot.
std::string logLogPlot(const std::string& x_label, const std::string& y_label, const std::string& note,
                       const std::vector<PlotPanel>& panels);

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
