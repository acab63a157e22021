#include "bench/accuracy_bench.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>
#include <numbers>

#include "bench/plots.h"
#include "bench/table.h"
#include "bench/verbs.h"
#include "core/error.h"
#include "core/simulation.h"
#include "options/console.h"
#include "simd/simd_backend.h"
#include "validation/newton_rod.h"
#include "validation/specimen.h"

namespace strandcast {
namespace {

constexpr int kEdges = 32;
constexpr double kLength = 0.25;    // m
constexpr int kTruthSubsteps = 96;  // per frame: 5760 per second
constexpr float kFrame = StrandTrial::kFrame, kSettlingDrag = StrandTrial::kSettlingDrag,
                kDrag = StrandTrial::kDrag;
constexpr int kFrames = StrandTrial::kFrames, kSettlingFrames = StrandTrial::kSettlingFrames;

Parameters truthParameters(int substeps, float drag) {
  Parameters parameters;
  parameters.solver = SolverKind::kRod;
  parameters.time_step = kFrame;
  parameters.substeps = substeps;
  parameters.air_drag = drag;
  return parameters;
}

// The strand twice: upright and level.
StrandModel inBothPoses(const StrandPoints& points) {
  const Quat level(Eigen::AngleAxisf(std::numbers::pi_v<float> / 2, Eigen::Vector3f::UnitZ()));
  StrandPoints turned;
  for (const Vec3& p : points) turned.push_back(level * p);
  return modelOf({points, turned});
}

NewtonRod restingRod(const StrandModel& model, size_t strand) {
  constexpr int kSubsteps = 6;
  const Pose root = model.rest_roots[strand];
  NewtonRod rod(model, strand, truthParameters(kSubsteps, kSettlingDrag), root);
  for (int frame = 0; frame < 2 * kSettlingFrames; ++frame) rod.step(root, root);
  return rod;
}

std::vector<Eigen::Vector3d> tipOf(NewtonRod rod, const Pose& root, const Shake& shake, int substeps) {
  rod.setParameters(truthParameters(substeps, kDrag));
  std::vector<Eigen::Vector3d> tip;
  for (int frame = 1; frame <= kFrames; ++frame) {
    rod.step(StrandTrial::rootAt(frame - 1, shake) * root, StrandTrial::rootAt(frame, shake) * root);
    tip.push_back(rod.positions().back());
  }
  return tip;
}

double rms(const std::vector<Eigen::Vector3d>& a, const std::vector<Eigen::Vector3d>& b) {
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]).squaredNorm();
  return std::sqrt(sum / static_cast<double>(a.size()));
}

ShakenStrand truthOf(const StrandPoints& points, const Shake& shake) {
  ShakenStrand out;
  out.shake = shake;
  out.points = points;
  out.poses = inBothPoses(points);
  const NewtonRod upright = restingRod(out.poses, 0);
  out.rest = {upright.positions(), restingRod(out.poses, 1).positions()};
  out.tip = tipOf(upright, out.poses.rest_roots[0], shake, kTruthSubsteps);
  out.truth_error = rms(out.tip, tipOf(upright, out.poses.rest_roots[0], shake, kTruthSubsteps / 2));
  return out;
}

// A simulation of both poses at rest, settled under kSettlingDrag.
Simulation rested(const ShakenStrand& strand, Parameters parameters) {
  parameters.air_drag = kSettlingDrag;
  Simulation simulation(strand.poses, {}, parameters, makeSimdBackend(1));
  for (int frame = 0; frame < kSettlingFrames; ++frame) simulation.step();
  parameters.air_drag = kDrag;
  simulation.setParameters(parameters);
  return simulation;
}

double restError(const ShakenStrand& strand, Simulation& simulation) {
  std::vector<Eigen::Vector3d> truth, found;
  for (const auto& shape : strand.rest) truth.insert(truth.end(), shape.begin(), shape.end());
  for (const Vec3& p : simulation.guides()) found.push_back(p.cast<double>());
  return rms(found, truth);
}

void chooseShapeRates(const ShakenStrand& strand, Parameters& parameters) {
  // An iteration restores 1 - exp(-rate h / iterations) of the shape, h the substep.
  const double unit = parameters.iterations * parameters.substeps / static_cast<double>(kFrame);
  Parameters trial = parameters;
  double least = std::numeric_limits<double>::infinity();
  for (const double strength : {0.0, 0.003, 0.01, 0.03, 0.06, 0.1, 0.2, 0.3, 0.5, 0.7, 0.9, 0.999})
    for (const double part : {1.0, 0.5, 0.25, 0.125, 0.0}) {
      const double rate = -std::log1p(-strength) * unit;
      trial.shape_rate = static_cast<float>(rate);
      trial.shape_rate_tip = static_cast<float>(part * rate);
      Simulation simulation = rested(strand, trial);
      const double error = restError(strand, simulation);
      if (!(error < least)) continue;
      least = error;
      parameters = trial;
    }
}

}  // namespace

ShakenStrand straightTruth(const Shake& shake) {
  return truthOf(straightStrand(kLength, kEdges, -Vec3::UnitY()), shake);
}
ShakenStrand curlTruth(const Shake& shake) {
  return truthOf(helixStrand(0.01, 0.01, kLength, kEdges), shake);
}

StrandError errorOf(const ShakenStrand& strand, Parameters parameters) {
  parameters.time_step = kFrame;
  if (parameters.solver == SolverKind::kGaussSeidel) chooseShapeRates(strand, parameters);
  return errorWith(strand, parameters);
}

StrandError errorWith(const ShakenStrand& strand, Parameters parameters) {
  parameters.time_step = kFrame;
  Simulation simulation = rested(strand, parameters);
  StrandError out;
  out.shape_rate = parameters.shape_rate;
  out.shape_rate_tip = parameters.shape_rate_tip;
  out.rest = restError(strand, simulation);
  std::vector<Eigen::Vector3d> tip;
  for (int frame = 1; frame <= kFrames; ++frame) {
    simulation.setHeadPose(StrandTrial::rootAt(frame, strand.shake));
    simulation.step();
    tip.push_back(simulation.guides()[kEdges].cast<double>());
    const Measurement measured = simulation.measure();
    out.mean_stretch += measured.mean_stretch / kFrames;
    out.max_stretch = std::max(out.max_stretch, measured.max_stretch);
  }
  out.tip = rms(tip, strand.tip);
  return out;
}

double costOf(const ShakenStrand& straight, const ShakenStrand& curl, Parameters parameters, int copies,
              int frames, int threads) {
  parameters.time_step = kFrame;
  parameters.air_drag = kDrag;
  std::vector<StrandPoints> strands;
  for (int i = 0; i < copies; ++i) {
    strands.push_back(straight.points);
    strands.push_back(curl.points);
  }
  Simulation simulation(modelOf(strands), {}, parameters, makeSimdBackend(threads));
  double shortest = std::numeric_limits<double>::infinity();
  for (int frame = 1; frame <= frames; ++frame) {
    simulation.setHeadPose(StrandTrial::rootAt(frame, straight.shake));
    const auto start = std::chrono::steady_clock::now();
    simulation.step();
    simulation.guides();
    shortest =
        std::min(shortest, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  return shortest / static_cast<double>(simulation.model().vertices());
}

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
