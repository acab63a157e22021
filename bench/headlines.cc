#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bench/report.h"
#include "bench/table.h"
#include "core/error.h"

namespace strandcast {

PowerLaw fitPowerLaw(std::span<const std::pair<double, double>> points) {
  const auto n = static_cast<double>(points.size());
  double mean_x = 0, mean_y = 0;
  for (const auto& [x, y] : points) {
    mean_x += std::log(x) / n;
    mean_y += std::log(y) / n;
  }
  double xx = 0, xy = 0, yy = 0;
  for (const auto& [x, y] : points) {
    const double dx = std::log(x) - mean_x, dy = std::log(y) - mean_y;
    xx += dx * dx;
    xy += dx * dy;
    yy += dy * dy;
  }
  PowerLaw law;
  law.exponent = xy / xx;
  law.factor = std::exp(mean_y - law.exponent * mean_x);
  if (points.size() > 2)
    law.standard_error = std::sqrt(std::max(0.0, yy - law.exponent * xy) / ((n - 2) * xx));
  return law;
}

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

namespace {

class Collector {
 public:
  explicit Collector(const Results& results) : results_(results) {}

  /// Calls `append` with the file's rows; does nothing where the file is missing or empty.
  template <class Append>
  void of(const std::string& name, const Append& append) {
    const auto found = results_.find(name);
    if (found == results_.end() || found->second.rows.empty()) return;
    command_ = commandOf(found->second);
    append(found->second.rows);
  }
  void add(const std::string& what, const std::string& measured, const std::string& goal = "",
           std::optional<bool> holds = std::nullopt) {
    lines.push_back({what, measured, goal, holds, command_});
  }
  std::vector<Headline> lines;

 private:
  const Results& results_;
  std::string command_;
};

double number(const nlohmann::json& row, const char* key) {
  const auto found = row.find(key);
  return found != row.end() && found->is_number() ? found->get<double>() : 0;
}

std::string sizeOf(const nlohmann::json& row) {
  return fmt::format("{} x {}", row["strands"].dump(), row["vertices"].dump());
}

void addStepLines(Collector& out, const std::vector<nlohmann::json>& rows) {
  const nlohmann::json& row = rows[0];
  const std::string size = sizeOf(row), device = row["device"];
  out.add(fmt::format("step of {}, {} substeps, {}", size, row["substeps"].dump(), device),
          fmt::format("{:.3f} ms", number(row, "ms_median")));
  if (const double part = number(row, "fraction_of_peak"); part > 0)
    out.add("of the measured peak, wall time, " + size, fmt::format("{:.0f} %", 100 * part));
  if (const double part = number(row, "fraction_of_peak_cpu"); part > 0)
    out.add("of the measured peak, processor time, " + size, fmt::format("{:.0f} %", 100 * part), ">= 30 %",
            part >= 0.30);
  out.add("largest stretch, " + size, fmt::format("{:.2g} %", 100 * number(row, "max_stretch")), "<= 0.01 %",
          number(row, "max_stretch") <= 1e-4);
  out.add("allocations of the timed steps", row["allocations"].dump(), "0", row["allocations"] == 0);
}

/// Hair, bodies and air of a row of `benchmark`; the rows of `contact` have them in their case.
std::string settingOf(const std::string& benchmark, const nlohmann::json& row) {
  if (benchmark == "contact" || !row.contains("scene")) return row["case"];
  std::string setting = row["scene"];
  if (const std::string hair = row.value("hair", "plain"); hair != "plain") setting += ", " + hair;
  if (const std::string bodies = row.value("bodies", "none"); bodies != "none")
    setting += ", bodies: " + bodies;
  if (const double cells = number(row, "air_cells"); cells > 0)
    setting += fmt::format(", air of {:g}^3", cells);
  return setting;
}

// The row with the most memory, for each device and setting.
void addMemoryLines(Collector& out, const Results& results) {
  constexpr double kGoal = 160;  // bytes
  std::map<std::string, Headline> most;
  std::map<std::string, double> bytes_of;
  for (const auto& [name, file] : results) {
    if (!name.starts_with("step") && !name.starts_with("gpu_") && name != "contact") continue;
    for (const nlohmann::json& row : file.rows) {
      const double bytes = number(row, "bytes_per_vertex");
      if (bytes <= 0) continue;
      const std::string where = fmt::format("{}, {}", row["device"].get<std::string>(), settingOf(name, row));
      if (bytes <= bytes_of[where]) continue;
      bytes_of[where] = bytes;
      most[where] = {fmt::format("memory per vertex, {}, {}", where, sizeOf(row)),
                     fmt::format("{:.0f} B", bytes), fmt::format("<= {:g} B", kGoal), bytes <= kGoal,
                     commandOf(file)};
    }
  }
  for (const auto& [where, line] : most) out.lines.push_back(line);
}

void addGpuLines(Collector& out) {
  struct Goal {
    const char *file, *what;
    double ms;
  };
  for (const Goal& goal : {Goal{"gpu_100k_alone", "100,000 x 32 alone", 0.56},
                           Goal{"gpu_100k_all", "100,000 x 32 with mesh, primitives, air of 64^3", 1.0},
                           Goal{"gpu_4k_alone", "4,000 x 32 alone", 0.045},
                           Goal{"gpu_4k_all", "4,000 x 32 with mesh, primitives, air of 64^3", 0.15}})
    out.of(goal.file, [&](const std::vector<nlohmann::json>& rows) {
      const double ms = number(rows[0], "gpu_ms") + number(rows[0], "air_gpu_ms");
      out.add(fmt::format("{}, {}", goal.what, rows[0]["device"].get<std::string>()),
              fmt::format("{:.3f} ms", ms), fmt::format("<= {:g} ms", goal.ms), ms <= goal.ms);
    });
  constexpr double kAirGoal = 0.25;  // ms
  out.of("gpu_100k_all", [&](const std::vector<nlohmann::json>& rows) {
    const double ms = number(rows[0], "air_gpu_ms");
    out.add("air alone, " + rows[0]["device"].get<std::string>(), fmt::format("{:.3f} ms", ms),
            fmt::format("<= {:g} ms", kAirGoal), ms <= kAirGoal);
  });
  out.of("gpu_grid", [&](const std::vector<nlohmann::json>& rows) {
    for (const nlohmann::json& row : rows) {
      if (row.value("pass", "") != "all") continue;
      const double ms = number(row, "ms");
      out.add(fmt::format("grids of {}^3 of {} alone, {}", row["cells"].dump(), sizeOf(row),
                          row["device"].get<std::string>()),
              fmt::format("{:.3f} ms", ms), fmt::format("<= {:g} ms", kAirGoal), ms <= kAirGoal);
    }
  });
}

void addScalingLines(Collector& out, const std::vector<nlohmann::json>& rows) {
  constexpr double kLinear = 1.1;  // largest exponent that counts as linear
  for (const AxisFit& fit : fitAxes(rows)) {
    const bool is_promised = fit.axis != "substeps";
    out.add(fmt::format("exponent of time in {}", fit.axis),
            fmt::format("{:.2f} ± {:.2f}", fit.law.exponent, fit.law.standard_error),
            is_promised ? fmt::format("1, at most {:g}", kLinear) : "",
            is_promised ? std::optional(fit.law.exponent <= kLinear) : std::nullopt);
  }
  for (const nlohmann::json& row : rows) {
    const double value = number(row, "value"), speedup = number(row, "speedup");
    if (row["axis"] == "lanes" && value > 1) {
      const std::string device = row["device"];
      const double goal = device.starts_with("AVX3") ? 8 : device.starts_with("AVX2") ? 4 : 0;
      out.add(device + " over the float reference", fmt::format("{:.1f} x", speedup),
              goal > 0 ? fmt::format(">= {:g} x", goal) : "",
              goal > 0 ? std::optional(speedup >= goal) : std::nullopt);
    }
    if (row["axis"] == "threads" && value > 1) {
      const double efficiency = number(row, "efficiency");
      if (value == 2)
        out.add("2 threads over one", fmt::format("{:.2f} x", speedup), ">= 1.8 x", speedup >= 1.8);
      else
        out.add(fmt::format("efficiency of {:g} threads", value), fmt::format("{:.0f} %", 100 * efficiency),
                ">= 70 %", efficiency >= 0.7);
      out.add(fmt::format("{:g} threads give the state of one", value), row["same_hash"], "yes",
              row["same_hash"] == "yes");
    }
  }
}

void addPeerLines(Collector& out, const std::vector<nlohmann::json>& rows) {
  const auto ratio = bulletOverRod(rows, 4);
  if (!ratio) return;
  out.add(ratio->reached ? "Bullet's ropes over the rod, at equal or less stretch"
                         : "Bullet's ropes over the rod, at their least stretch, which is larger",
          fmt::format("{:.0f} x", ratio->ratio), ">= 20 x", ratio->ratio >= 20);
}

void addLatencyLines(Collector& out, const std::vector<nlohmann::json>& rows) {
  for (const nlohmann::json& row : rows) {
    const double rate = number(row, "rate_hz");
    const bool is_promised = rate == 120;
    const double p99 = number(row, "ms_p99");
    out.add(fmt::format("motion to {} at {:g} Hz, {} guides",
                        row["hairs"] == 0 ? "decoded guides" : "grown hair", rate, sizeOf(row)),
            fmt::format("p50 {:.2f}, p99 {:.2f} ms, {:.1f} of {:g} frames/s", number(row, "ms_median"), p99,
                        number(row, "fps_grown"), rate),
            is_promised ? "p99 <= 8.3 ms" : "",
            is_promised ? std::optional(p99 <= 1000 / 120.) : std::nullopt);
  }
}

// On a CPU: cost of all grids of 32^3 relative to a step of the strands.
void addGridLines(Collector& out, const std::vector<nlohmann::json>& rows) {
  for (const nlohmann::json& row : rows) {
    if (row.value("pass", "") != "all" || number(row, "cells") != 32) continue;
    const bool by_cpu = number(row, "of_strand_step_cpu") > 0;
    const double share = number(row, by_cpu ? "of_strand_step_cpu" : "of_strand_step");
    if (share <= 0) continue;
    out.add(fmt::format("grids of 32^3 over the strands' step, {}, {}", sizeOf(row),
                        by_cpu ? "processor time" : "wall time"),
            fmt::format("{:.0f} %", 100 * share), "<= 25 %", share <= 0.25);
  }
}

// A software OpenGL has no goal.
void addGrowthLines(Collector& out, const std::vector<nlohmann::json>& rows) {
  constexpr double kGoal = 0.3;  // ms, for 100,000 hairs
  const nlohmann::json& row = rows.back();
  const double ms = number(row, "growth_ms");
  const std::string device = row["device"];
  const bool is_promised = number(row, "hairs") == 100000 && !device.starts_with("llvmpipe");
  out.add(fmt::format("growth of {} hairs x {}, {}", row["hairs"].dump(), row["vertices"].dump(), device),
          fmt::format("{:.3f} ms", ms), is_promised ? fmt::format("<= {:g} ms", kGoal) : "",
          is_promised ? std::optional(ms <= kGoal) : std::nullopt);
}

}  // namespace

std::string commandOf(const CsvFile& file) { return file.comments.empty() ? "" : file.comments.front(); }

Results readResults(const std::filesystem::path& folder) {
  Results results;
  if (!std::filesystem::is_directory(folder))
    throw Error("the folder of results does not exist", folder.string(), "create it: strandbench all --save");
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".csv") continue;
    results[entry.path().stem().string()] = parseCsv(textOf(entry.path()), entry.path().string());
  }
  return results;
}

std::vector<Headline> headlinesOf(const Results& results) {
  Collector out(results);
  out.of("step_10k", [&](const auto& rows) { addStepLines(out, rows); });
  addMemoryLines(out, results);
  addGpuLines(out);
  out.of("scaling", [&](const auto& rows) { addScalingLines(out, rows); });
  out.of("peers", [&](const auto& rows) { addPeerLines(out, rows); });
  out.of("contact", [&](const std::vector<nlohmann::json>& rows) {
    const double ratio = number(rows.back(), "ratio");
    out.add("a mesh and five primitives over no body", fmt::format("{:.2f} x", ratio), "<= 1.5 x",
            ratio <= 1.5);
  });
  out.of("grid", [&](const auto& rows) { addGridLines(out, rows); });
  out.of("render", [&](const auto& rows) { addGrowthLines(out, rows); });
  out.of("end_to_end", [&](const auto& rows) { addLatencyLines(out, rows); });
  out.of("end_to_end_grown", [&](const auto& rows) { addLatencyLines(out, rows); });
  return out.lines;
}

}  // namespace strandcast
