#pragma once
#include <string>
#include <vector>

namespace strandcast {

struct PlotPoint {
  double x = 0, y = 0;  ///< above 0; other points are left out, because the axes are logarithmic
  std::string label;    ///< written beside the point; may be empty
};

/// Points joined by a line, with one mark each.
struct PlotSeries {
  std::string name;   ///< in the legend; series of one name in several panels have one entry
  std::string color;  ///< as SVG takes it, e.g. "#d55e00"
  std::vector<PlotPoint> points;
};

struct PlotPanel {
  std::string title;
  std::vector<PlotSeries> series;
};

/// Panels side by side on the same logarithmic axes, with a grid at 1, 2 and 5 of every decade and a legend:
/// a whole SVG document, `note` in a line below it all. Panels without any point give an empty plot.
std::string logLogPlot(const std::string& x_label, const std::string& y_label, const std::string& note,
                       const std::vector<PlotPanel>& panels);

}  // namespace strandcast
