#include "bench/verbs.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/console.h"
#include "bench/accuracy_trial.h"
#include "bench/svg_plot.h"
#include "bench/table.h"
#include "bench/text_file.h"
#include "core/error.h"
#include "simd/simd_backend.h"

namespace strandcast {
namespace {

struct AccuracyOptions {
  std::vector<std::string> solvers{"rod", "gauss_seidel"};
  std::vector<int> substeps{1, 2, 4, 8, 16}, iterations{2, 4, 8, 16, 32, 64};
  int sweeps = 128, copies = 1024, rounds = 6, frames = 10, threads = 1;
  std::filesystem::path plot;
  bool json = false, csv = false;
};

struct AccuracyResult {
  Parameters parameters;
  StrandError straight, curl;
  double cost = std::numeric_limits<double>::infinity();  // s per vertex and frame
  double relative_cost = 0;                               // relative to the rod at one substep
};

std::vector<Parameters> ladder(const AccuracyOptions& o) {
  std::vector<Parameters> settings;
  for (const std::string& solver : o.solvers)
    for (const int substeps : o.substeps) {
      Parameters p;
      p.solver = solverKind(solver);
      p.substeps = substeps;
      if (p.solver == SolverKind::kRod) {
        settings.push_back(p);
        continue;
      }
      for (const int iterations : o.iterations) {
        p.iterations = iterations;
        if (substeps * iterations <= o.sweeps) settings.push_back(p);
      }
    }
  return settings;
}

std::string seriesName(const Parameters& p) {
  if (p.solver == SolverKind::kRod) return "rod";
  return fmt::format("{}, {} substep{}", solverName(p.solver), p.substeps, p.substeps == 1 ? "" : "s");
}

std::string seriesColor(const Parameters& p) {
  if (p.solver == SolverKind::kRod) return "#d55e00";
  constexpr const char* kBlues[] = {"#74c0e3", "#4aa3d8", "#2b83c4", "#1c62a8",
                                    "#12457f", "#0a2c57", "#051630"};
  size_t power = 0;
  while ((2 << power) <= p.substeps && power + 1 < std::size(kBlues)) ++power;
  return kBlues[power];
}

PlotPanel panelOf(const std::string& title, const std::vector<AccuracyResult>& results,
                  StrandError AccuracyResult::*strand) {
  PlotPanel panel;
  panel.title = title;
  for (const AccuracyResult& r : results) {
    const std::string name = seriesName(r.parameters);
    if (panel.series.empty() || panel.series.back().name != name)
      panel.series.push_back({name, seriesColor(r.parameters), {}});
    const int label =
        r.parameters.solver == SolverKind::kRod ? r.parameters.substeps : r.parameters.iterations;
    panel.series.back().points.push_back({r.relative_cost, 1e3 * (r.*strand).tip, fmt::format("{}", label)});
  }
  return panel;
}

void writePlot(const std::filesystem::path& file, const std::vector<AccuracyResult>& results) {
  writeText(file, logLogPlot("cost of a frame, relative to the rod at one substep",
                             "rms error of the shaken tip, mm",
                             "Labels: substeps of the rod, iterations of gauss_seidel.",
                             {panelOf("straight, 25 cm", results, &AccuracyResult::straight),
                              panelOf("curl, 25 cm", results, &AccuracyResult::curl)}));
}

nlohmann::json toJson(const StrandError& e) {
  return {{"shape_rate", e.shape_rate},
          {"shape_rate_tip", e.shape_rate_tip},
          {"rest_error_mm", 1e3 * e.rest},
          {"tip_error_mm", 1e3 * e.tip},
          {"max_stretch", e.max_stretch}};
}

void printJson(const AccuracyOptions& o, const std::vector<AccuracyResult>& results,
               const ShakenStrand& straight, const ShakenStrand& curl) {
  nlohmann::json list = nlohmann::json::array();
  for (const AccuracyResult& r : results) {
    const bool rod = r.parameters.solver == SolverKind::kRod;
    list.push_back({{"solver", solverName(r.parameters.solver)},
                    {"substeps", r.parameters.substeps},
                    {"iterations", rod ? nlohmann::json() : nlohmann::json(r.parameters.iterations)},
                    {"ns_per_vertex_frame", 1e9 * r.cost},
                    {"relative_cost", r.relative_cost},
                    {"straight", toJson(r.straight)},
                    {"curl", toJson(r.curl)}});
  }
  nlohmann::json out = origin();
  out.update(
      {{"name", "accuracy"},
       {"device", makeSimdBackend(o.threads)->device()},
       {"copies", o.copies},
       {"truth_error_mm", {{"straight", 1e3 * straight.truth_error}, {"curl", 1e3 * curl.truth_error}}},
       {"results", list}});
  fmt::print("{}\n", out.dump());
}

void printCsv(const std::vector<AccuracyResult>& results) {
  fmt::print("{}solver,substeps,iterations,ns_per_vertex_frame,relative_cost", originComment());
  for (const char* strand : {"straight", "curl"})
    for (const char* column :
         {"shape_rate", "shape_rate_tip", "rest_error_mm", "tip_error_mm", "max_stretch"})
      fmt::print(",{}_{}", strand, column);
  fmt::print("\n");
  for (const AccuracyResult& r : results) {
    const bool rod = r.parameters.solver == SolverKind::kRod;
    fmt::print("{},{},{},{:.3f},{:.3f}", solverName(r.parameters.solver), r.parameters.substeps,
               rod ? "" : fmt::format("{}", r.parameters.iterations), 1e9 * r.cost, r.relative_cost);
    for (const StrandError* e : {&r.straight, &r.curl})
      fmt::print(",{},{},{:.3f},{:.3f},{:.3e}", rod ? "" : fmt::format("{:g}", e->shape_rate),
                 rod ? "" : fmt::format("{:g}", e->shape_rate_tip), 1e3 * e->rest, 1e3 * e->tip,
                 e->max_stretch);
    fmt::print("\n");
  }
}

void printTable(const std::vector<AccuracyResult>& results, const ShakenStrand& straight,
                const ShakenStrand& curl) {
  fmt::print("{:>44}  {:^26}   {:^26}\n", "", "straight", "curl");
  fmt::print("{:<13} {:>4} {:>5} {:>10} {:>8}", "solver", "sub", "iter", "ns/vtx/frm", "relative");
  for (int i = 0; i < 2; ++i) fmt::print("  {:>8} {:>8} {:>9} ", "tip mm", "rest mm", "stretch %");
  fmt::print("\n");
  for (const AccuracyResult& r : results) {
    const bool rod = r.parameters.solver == SolverKind::kRod;
    fmt::print("{:<13} {:>4} {:>5} {:>10.2f} {:>8.2f}", solverName(r.parameters.solver),
               r.parameters.substeps, rod ? "-" : fmt::format("{}", r.parameters.iterations), 1e9 * r.cost,
               r.relative_cost);
    for (const StrandError* e : {&r.straight, &r.curl})
      fmt::print("  {:>8.2f} {:>8.2f} {:>9.2g} ", 1e3 * e->tip, 1e3 * e->rest, 1e2 * e->max_stretch);
    fmt::print("\n");
  }
  fmt::print("error of the reference solution: {:.3f} mm straight, {:.3f} mm curl\n",
             1e3 * straight.truth_error, 1e3 * curl.truth_error);
}

int accuracy(const AccuracyOptions& o) {
  const std::vector<Parameters> settings = ladder(o);
  if (settings.empty())
    throw Error("--sweeps leaves no setting to measure", fmt::format("--sweeps {}", o.sweeps),
                "allow more sweeps, or fewer substeps and iterations");
  std::vector<AccuracyResult> results;
  ShakenStrand straight, curl;
  {
    ProgressBar bar;
    const auto jobs = static_cast<double>(2 * settings.size() + 1);
    bar.show("reference solution", 0);
    straight = straightTruth();
    curl = curlTruth();
    for (const Parameters& p : settings) {
      bar.show("error of " + seriesName(p), (1 + static_cast<double>(results.size())) / jobs);
      results.push_back({p, errorOf(straight, p), errorOf(curl, p)});
    }
    // Settings are timed in rounds, so that a transient load on the machine does not fall on one setting.
    Parameters unit;
    unit.solver = SolverKind::kRod;
    unit.substeps = 1;
    double unit_cost = std::numeric_limits<double>::infinity();
    auto measure = [&](const Parameters& p, double& cost) {
      cost = std::min(cost, costOf(straight, curl, p, o.copies, o.frames, o.threads));
    };
    for (int round = 0; round < o.rounds; ++round) {
      bar.show(fmt::format("cost, round {} of {}", round + 1, o.rounds), 0.5 + 0.5 * round / o.rounds);
      measure(unit, unit_cost);
      for (AccuracyResult& r : results) {
        const bool is_unit = r.parameters.solver == unit.solver && r.parameters.substeps == unit.substeps;
        if (is_unit)
          r.cost = unit_cost;
        else
          measure(r.parameters, r.cost);
      }
    }
    for (AccuracyResult& r : results) r.relative_cost = r.cost / unit_cost;
  }
  if (o.json)
    printJson(o, results, straight, curl);
  else if (o.csv)
    printCsv(results);
  else
    printTable(results, straight, curl);
  if (!o.plot.empty()) writePlot(o.plot, results);
  return 0;
}

}  // namespace

std::function<int()> addAccuracy(CLI::App& app) {
  const auto o = std::make_shared<AccuracyOptions>();
  app.footer(
      "Frames of 1/60 s.\n"
      "cost: least time of a frame of many copies of both strands on the simd backend.\n"
      "tip:  rms distance of a shaken strand's tip from the tip of an exact rod with the same vertices, "
      "over\n"
      "      1.5 s (validation/newton_rod.h).\n"
      "rest: rms distance of the vertices from those of that rod at rest, with the root upright and level.\n"
      "gauss_seidel has no Young's modulus: each setting and strand uses the shape rates that minimise its\n"
      "rest error, of 60 pairs. An iteration restores 0 to 99.9 % of the shape at the root, and from none "
      "to\n"
      "all of that at the tip.\n"
      "Examples:\n"
      "  strandbench accuracy --plot accuracy.svg\n"
      "  strandbench accuracy --solvers rod --substeps 1,4 --json");
  app.add_option("--solvers", o->solvers, "separated by commas: rod, gauss_seidel")
      ->delimiter(',')
      ->check(CLI::IsMember({"rod", "gauss_seidel"}))
      ->capture_default_str();
  app.add_option("--substeps", o->substeps, "substeps per frame, ascending")
      ->delimiter(',')
      ->check(CLI::Range(1, 64))
      ->capture_default_str();
  app.add_option("--iterations", o->iterations, "iterations of gauss_seidel per substep, ascending")
      ->delimiter(',')
      ->check(CLI::Range(1, 64))
      ->capture_default_str();
  app.add_option("--sweeps", o->sweeps, "leave out settings with more substeps x iterations than this")
      ->check(CLI::Range(1, 4096))
      ->capture_default_str();
  app.add_option("--copies", o->copies, "copies of each strand in the cost measurement")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  app.add_option("--rounds", o->rounds, "rounds; each measures the cost of every setting once")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  app.add_option("--frames", o->frames, "frames per round; the least frame time of all rounds is the cost")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  app.add_option("--threads", o->threads, "threads of the cost measurement; 0 = all")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  app.add_option("--plot", o->plot, "also plot tip error against cost into this SVG file");
  app.add_flag("--json", o->json, "print one JSON object");
  app.add_flag("--csv", o->csv, "print comma-separated values");
  return [o] { return accuracy(*o); };
}

}  // namespace strandcast
