#include "bench/plots.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "bench/report.h"

namespace strandcast {
namespace {

constexpr double kPanelWidth = 430, kPanelHeight = 380;  // of the axes' box, pixels
constexpr double kLeft = 70, kTop = 36, kBetween = 44, kRight = kBetween;
constexpr double kLabelSize = 11, kLabelAway = 6;  // font size of point labels, and their distance from the
                                                   // point, pixels
constexpr double kBelow = 54, kLegendLine = 20, kLegendColumn = 220;

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string text(double x, double y, const std::string& anchor, const std::string& what,
                 const std::string& more = "") {
  if (what.empty()) return "";
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\"{}>{}</text>\n", x, y, anchor, more,
                     escaped(what));
}

std::string line(double x1, double y1, double x2, double y2, const std::string& color, double width) {
  return fmt::format(
      "<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"{}\" stroke-width=\"{}\"/>\n",
      x1, y1, x2, y2, color, width);
}

bool drawable(const PlotPoint& p) { return p.x > 0 && p.y > 0 && std::isfinite(p.x) && std::isfinite(p.y); }

/// A logarithmic axis that begins and ends at 1, 2 or 5 times a power of ten and has its ticks there.
class LogAxis {
 public:
  void include(double value) {
    low_ = std::min(low_, value);
    high_ = std::max(high_, value);
  }
  void settle() {
    if (low_ > high_) low_ = high_ = 1;
    const int decade = static_cast<int>(std::floor(std::log10(low_))) - 1;
    for (int power = decade; ticks_.empty() || ticks_.back() < high_ * kMargin; ++power)
      for (const double factor : {1, 2, 5}) {
        const double tick = factor * std::pow(10, power);
        if (!ticks_.empty() && ticks_.back() >= high_ * kMargin) break;
        if (tick <= low_ / kMargin) ticks_.clear();
        ticks_.push_back(tick);
      }
  }
  const std::vector<double>& ticks() const { return ticks_; }
  /// The label of a tick; over many decades only powers of ten have one, so that labels do not overlap.
  std::string label(double tick) const {
    const double power = std::log10(tick);
    const bool is_power = std::abs(power - std::round(power)) < 1e-6;
    return is_power || ticks_.back() / ticks_.front() < kManyDecades ? fmt::format("{:g}", tick) : "";
  }
  /// Position along the axis: 0 at the low end, 1 at the high end.
  double part(double value) const {
    return std::log(value / ticks_.front()) / std::log(ticks_.back() / ticks_.front());
  }

 private:
  static constexpr double kManyDecades = 3000;
  static constexpr double kMargin = 1.3;  // factor that keeps points and their labels inside
  double low_ = std::numeric_limits<double>::infinity(), high_ = 0;
  std::vector<double> ticks_;
};

std::string panelOf(const PlotPanel& panel, double left, bool first, const LogAxis& x_axis,
                    const LogAxis& y_axis, const std::string& x_label) {
  auto x = [&](double value) { return left + kPanelWidth * x_axis.part(value); };
  auto y = [&](double value) { return kTop + kPanelHeight * (1 - y_axis.part(value)); };
  const double bottom = kTop + kPanelHeight, right = left + kPanelWidth;
  std::string out = text(left + kPanelWidth / 2, kTop - 12, "middle", panel.title, " font-weight=\"bold\"");
  for (const double tick : x_axis.ticks()) {
    out += line(x(tick), kTop, x(tick), bottom, "#dddddd", 1);
    out += text(x(tick), bottom + 18, "middle", x_axis.label(tick));
  }
  for (const double tick : y_axis.ticks()) {
    out += line(left, y(tick), right, y(tick), "#dddddd", 1);
    if (first) out += text(left - 8, y(tick) + 4, "end", y_axis.label(tick));
  }
  out +=
      fmt::format("<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"none\" stroke=\"#444444\"/>\n",
                  left, kTop, kPanelWidth, kPanelHeight);
  out += text(left + kPanelWidth / 2, bottom + 40, "middle", x_label);
  for (const PlotSeries& series : panel.series) {
    std::string path, marks;
    for (const PlotPoint& p : series.points) {
      if (!drawable(p)) continue;
      path += fmt::format("{:.1f},{:.1f} ", x(p.x), y(p.y));
      marks += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3.5\" fill=\"{}\"/>\n", x(p.x), y(p.y),
                           series.color);
      if (p.label.empty()) continue;
      const double label_width = kLabelSize * 0.65 * static_cast<double>(p.label.size());
      const bool fits = x(p.x) + kLabelAway + label_width < right;
      marks += text(x(p.x) + (fits ? kLabelAway : -kLabelAway), y(p.y) - kLabelAway, fits ? "start" : "end",
                    p.label, fmt::format(" font-size=\"{}\" fill=\"{}\"", kLabelSize, series.color));
    }
    out += fmt::format("<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.5\"/>\n", path,
                       series.color);
    out += marks;
  }
  return out;
}

}  // namespace

std::string logLogPlot(const std::string& x_label, const std::string& y_label, const std::string& note,
                       const std::vector<PlotPanel>& panels) {
  LogAxis x_axis, y_axis;
  std::vector<const PlotSeries*> legend;
  std::set<std::string> named;
  for (const PlotPanel& panel : panels)
    for (const PlotSeries& series : panel.series) {
      if (named.insert(series.name).second) legend.push_back(&series);
      for (const PlotPoint& p : series.points) {
        if (!drawable(p)) continue;
        x_axis.include(p.x);
        y_axis.include(p.y);
      }
    }
  x_axis.settle();
  y_axis.settle();

  const auto count = static_cast<double>(panels.size());
  const double width = kLeft + count * kPanelWidth + (count - 1) * kBetween + kRight;
  const auto columns = static_cast<size_t>(std::max(1.0, (width - kLeft) / kLegendColumn));
  const double lines = std::ceil(static_cast<double>(legend.size()) / static_cast<double>(columns));
  const double height = kTop + kPanelHeight + kBelow + kLegendLine * (lines + 1.5);
  std::string out = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" height=\"{1:.0f}\" viewBox=\"0 0 {0:.0f} "
      "{1:.0f}\" font-family=\"sans-serif\" font-size=\"13\" fill=\"#222222\">\n<rect width=\"100%\" "
      "height=\"100%\" fill=\"white\"/>\n",
      width, height);
  for (size_t i = 0; i < panels.size(); ++i)
    out += panelOf(panels[i], kLeft + static_cast<double>(i) * (kPanelWidth + kBetween), i == 0, x_axis,
                   y_axis, x_label);
  const double middle = kTop + kPanelHeight / 2;
  out += text(20, middle, "middle", y_label, fmt::format(" transform=\"rotate(-90 20 {:.1f})\"", middle));
  for (size_t i = 0; i < legend.size(); ++i) {
    const double x = kLeft + kLegendColumn * static_cast<double>(i % columns);
    const double y =
        kTop + kPanelHeight + kBelow + kLegendLine * (0.5 + std::floor(static_cast<double>(i / columns)));
    out += line(x, y - 4, x + 24, y - 4, legend[i]->color, 1.5);
    out += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3.5\" fill=\"{}\"/>\n", x + 12, y - 4,
                       legend[i]->color);
    out += text(x + 32, y, "start", legend[i]->name);
  }
  out += text(kLeft, height - kLegendLine / 2, "start", note);
  return out + "</svg>\n";
}

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
