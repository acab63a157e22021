#include "bench/verbs.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <numbers>

#include "bench/accuracy_bench.h"
#include "bench/bench_simulation.h"
#include "bench/bullet_ropes.h"
#include "bench/plots.h"
#include "bench/report.h"
#include "bench/table.h"
#include "core/measure.h"
#include "options/console.h"
#include "simd/simd_backend.h"

namespace strandcast {
namespace {

/// The head shake of all trials: 5 cm to either side, twice a second. Roots do not rotate: ropes have no
/// bending and would not follow.
constexpr Shake kHeadShake{.reach = 0.05, .shakes = 2, .turns = 0, .ramp = 0.5};

struct PeersOptions {
  std::vector<int> substeps;  // empty: a default ladder, shorter with --quick
  int sweeps = 16384, copies = 256, frames = 8;
  bool quick = false;
  std::filesystem::path plot;
  PrintOptions print;
};

struct PeersSetting {
  std::string solver;
  int substeps = 1, iterations = 0;
};

std::vector<PeersSetting> settingsOf(const PeersOptions& o) {
  std::vector<PeersSetting> out;
  for (const int substeps : o.substeps) out.push_back({"rod", substeps});
  const auto sweep = [&](const std::string& solver, int max_iterations) {
    for (const int substeps : o.substeps)
      for (int iterations = 1; iterations <= max_iterations && substeps * iterations <= o.sweeps;
           iterations *= o.quick ? 4 : 2)
        out.push_back({solver, substeps, iterations});
  };
  sweep("gauss_seidel", 64);
  if (bulletAvailable()) sweep("bullet", o.sweeps);
  return out;
}

Parameters parametersOf(const PeersSetting& setting) {
  Parameters p;
  p.solver = solverKind(setting.solver);
  p.substeps = setting.substeps;
  if (setting.iterations > 0) p.iterations = setting.iterations;
  // No shape restoration, as Bullet's ropes have none: a rate would have to be tuned for each number of
  // iterations.
  p.shape_rate = p.shape_rate_tip = 0;
  return p;
}

double massPerLength(const Material& material) {
  return static_cast<double>(material.density * material.radius * material.radius) * std::numbers::pi;
}

StrandError bulletError(const ShakenStrand& truth, const PeersSetting& setting) {
  const StrandModel& model = truth.poses;
  std::vector<StrandPoints> strands;
  for (size_t s = 0; s < 2; ++s) {
    StrandPoints points;
    for (uint32_t v = model.offsets[s]; v < model.offsets[s + 1]; ++v)
      points.push_back(model.rest_roots[s].rotation * model.rest_local[v] + model.rest_roots[s].position);
    strands.push_back(points);
  }
  BulletRopes ropes(strands, massPerLength({}));
  ropes.configure(StrandTrial::kFrame, setting.substeps, setting.iterations, StrandTrial::kSettlingDrag);
  for (int frame = 0; frame < StrandTrial::kSettlingFrames; ++frame) ropes.step(Pose{}, Pose{});
  ropes.configure(StrandTrial::kFrame, setting.substeps, setting.iterations, StrandTrial::kDrag);
  StrandError out;
  double squares = 0;
  for (int frame = 1; frame <= StrandTrial::kFrames; ++frame) {
    ropes.step(StrandTrial::rootAt(frame - 1, truth.shake), StrandTrial::rootAt(frame, truth.shake));
    const std::vector<Vec3> positions = ropes.positions();
    const Measurement measured = measure(model, positions, {});
    if (measured.non_finite > 0) return {0, 0, 0, INFINITY, INFINITY, INFINITY};
    out.mean_stretch += measured.mean_stretch / StrandTrial::kFrames;
    out.max_stretch = std::max(out.max_stretch, measured.max_stretch);
    const Vec3 tip = positions[model.offsets[1] - 1];
    squares += (tip.cast<double>() - truth.tip[static_cast<size_t>(frame) - 1]).squaredNorm();
  }
  out.tip = std::sqrt(squares / StrandTrial::kFrames);
  return out;
}

/// Processor time of a frame of shaken copies, per vertex, ns.
Spread bulletCost(const ShakenStrand& truth, const PeersSetting& setting, int copies, int frames) {
  BulletRopes ropes(std::vector<StrandPoints>(static_cast<size_t>(copies), truth.points), massPerLength({}));
  ropes.configure(StrandTrial::kFrame, setting.substeps, setting.iterations, StrandTrial::kDrag);
  std::vector<double> ns;
  for (int frame = 1; frame <= frames; ++frame) {
    const double before = processorMs();
    ropes.step(StrandTrial::rootAt(frame - 1, truth.shake), StrandTrial::rootAt(frame, truth.shake));
    ns.push_back(1e6 * (processorMs() - before) / (copies * static_cast<double>(truth.points.size())));
  }
  return spreadOf(ns);
}

MeasuredRun strandcastCost(const ShakenStrand& truth, const PeersSetting& setting, int copies, int frames) {
  Parameters parameters = parametersOf(setting);
  parameters.time_step = StrandTrial::kFrame;
  parameters.air_drag = StrandTrial::kDrag;
  const std::vector<StrandPoints> strands(static_cast<size_t>(copies), truth.points);
  return measureSteps([&] { return Simulation(modelOf(strands), {}, parameters, makeSimdBackend(1)); },
                      [&](double time) { return shakenRoot(time, truth.shake); }, 2, frames);
}

nlohmann::json rowOf(const PeersOptions& o, const ShakenStrand& truth, const PeersSetting& setting) {
  nlohmann::json row{{"solver", setting.solver}, {"substeps", setting.substeps}};
  if (setting.iterations > 0) row["iterations"] = setting.iterations;
  StrandError error;
  if (setting.solver == "bullet") {
    error = bulletError(truth, setting);
    // Long sweeps need few copies for a measurable time.
    const int copies = std::clamp(o.copies * 256 / (setting.substeps * setting.iterations), 8, o.copies);
    const Spread ns = bulletCost(truth, setting, copies, o.frames);
    row.update({{"copies", copies},
                {"ns_per_vertex_frame", ns.min},
                {"ns_per_vertex_frame_median", ns.median},
                {"ns_per_vertex_frame_p95", ns.p95}});
  } else {
    error = errorWith(truth, parametersOf(setting));
    const int copies = 4 * o.copies;  // full blocks of lanes, and many of them
    const MeasuredRun run = strandcastCost(truth, setting, copies, 4 * o.frames);
    const double per_vertex = 1e6 / static_cast<double>(run.vertices);
    row.update({{"copies", copies},
                {"ns_per_vertex_frame", per_vertex * run.cpu_ms.min},
                {"ns_per_vertex_frame_median", per_vertex * run.cpu_ms.median},
                {"ns_per_vertex_frame_p95", per_vertex * run.cpu_ms.p95},
                {"bytes_per_vertex", run.bytesPerVertex()},
                {"allocations", run.allocations},
                {"state_hash", fmt::format("{:016x}", run.hash)}});
  }
  if (!std::isfinite(error.tip)) return row;  // diverged
  row.update({{"mean_stretch", error.mean_stretch},
              {"max_stretch", error.max_stretch},
              {"tip_error_mm", 1e3 * error.tip}});
  return row;
}

std::string settingOf(const nlohmann::json& row) {
  const std::string steps = fmt::format("{} substeps", row["substeps"].get<int>());
  if (row.value("iterations", nlohmann::json()).is_null()) return steps;
  return fmt::format("{} x {} iterations", steps, row["iterations"].get<int>());
}

std::string peerConclusions(const std::vector<nlohmann::json>& rows) {
  std::string out;
  for (const double target : {0.1, 0.01, 0.001, 0.0001}) {
    std::string found;
    for (const char* solver : {"rod", "gauss_seidel", "bullet"})
      if (const auto row = cheapestWithin(rows, solver, target))
        found += fmt::format("{}{} {:.1f} ns ({})", found.empty() ? "" : "; ", solver,
                             (*row)["ns_per_vertex_frame"].get<double>(), settingOf(*row));
    if (!found.empty()) out += fmt::format("  within {:g} % of stretch: {}\n", 100 * target, found);
  }
  if (const auto ratio = bulletOverRod(rows, 4))
    out += fmt::format(
        "  Bullet against the rod at 4 substeps, which stretches {:.2g} % at most: {} {:.0f} times the "
        "cost{}\n",
        100 * ratio->stretch, ratio->reached ? "equal or less stretch at" : "never that little; at",
        ratio->ratio,
        ratio->reached
            ? ""
            : fmt::format(" it stretches {:.2g} % ({})", 100 * ratio->bullet["max_stretch"].get<double>(),
                          settingOf(ratio->bullet)));
  return out;
}

int peers(PeersOptions o) {
  if (o.substeps.empty())
    o.substeps = o.quick ? std::vector<int>{1, 4, 16} : std::vector<int>{1, 2, 4, 8, 16};
  if (o.quick) {
    o.sweeps = std::min(o.sweeps, 4096);
    o.frames = std::min(o.frames, 3);
  }
  Bench bench;
  bench.name = "peers";
  bench.params = {
      {"bullet", bulletVersion()}, {"sweeps", o.sweeps}, {"copies", o.copies}, {"quick", o.quick}};
  bench.table = Table({{"solver", "solver"},
                       {"substeps", "substeps"},
                       {"iterations", "iterations"},
                       {"copies"},
                       {"ns_per_vertex_frame", "ns/vtx/frame", "{:.1f}"},
                       {"ns_per_vertex_frame_median"},
                       {"ns_per_vertex_frame_p95"},
                       {"relative_cost", "relative", "{:.2f}"},
                       {"mean_stretch", "mean stretch", "{:.2e}"},
                       {"max_stretch", "max", "{:.2e}"},
                       {"tip_error_mm", "tip mm", "{:.2f}"},
                       {"bytes_per_vertex", "B/vtx", "{:.0f}"},
                       {"allocations", "allocs"},
                       {"state_hash"}});
  {
    ProgressBar bar;
    bar.show("reference solution", 0);
    const ShakenStrand truth = straightTruth(kHeadShake);
    const std::vector<PeersSetting> settings = settingsOf(o);
    std::vector<nlohmann::json> rows;
    for (const PeersSetting& setting : settings) {
      bar.show(fmt::format("{} {} x {}", setting.solver, setting.substeps, setting.iterations),
               static_cast<double>(rows.size()) / static_cast<double>(settings.size()));
      rows.push_back(rowOf(o, truth, setting));
    }
    const double unit = rows[0]["ns_per_vertex_frame"];
    for (nlohmann::json& row : rows) {
      row["relative_cost"] = row["ns_per_vertex_frame"].get<double>() / unit;
      bench.table.add(row);
    }
    bench.more["truth_error_mm"] = 1e3 * truth.truth_error;
  }
  std::string reason;
  if (!bulletAvailable(&reason)) bench.closing = fmt::format("  left out: Bullet; {}\n", reason);
  bench.closing += peerConclusions(bench.table.rows());
  bench.more["device"] = makeSimdBackend(1)->device();
  print(bench, o.print);
  if (!o.plot.empty()) writeText(o.plot, peersPlot(bench.table.rows()));
  return 0;
}

}  // namespace

std::function<int()> addPeersBench(CLI::App& app) {
  const auto o = std::make_shared<PeersOptions>();
  app.footer(
      "Straight hair of 25 cm and 32 edges under gravity, with the root shaken 5 cm to either side twice\n"
      "a second; frames of 1/60 s. All solvers have the same gravity, masses, drag, steps and motion of the\n"
      "root, and one thread. Times are the least processor time of a frame.\n"
      "rod:          simd backend. gauss_seidel: simd backend, the scheme of TressFX (Verlet, distance\n"
      "              constraints in two colours), as ropes without a shape.\n"
      "bullet:       soft-body ropes of Bullet (btSoftBodyHelpers::CreateRope, m_kLST = 1, links from root "
      "to\n"
      "              tip), position iterations; the steps of the bodies alone, without a world and "
      "collisions.\n"
      "stretch:      mean and largest of two strands over 1.5 s. tip: rms distance of the tip from that of "
      "an\n"
      "              exact rod (validation/newton_rod.h).\n"
      "Examples:\n"
      "  strandbench peers --quick\n"
      "  strandbench peers --plot peers.svg");
  app.add_option("--substeps", o->substeps,
                 "substeps per frame, ascending; default 1,2,4,8,16, with --quick 1,4,16")
      ->delimiter(',')
      ->check(CLI::Range(1, 64));
  app.add_option("--sweeps", o->sweeps, "largest substeps x iterations of a frame")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  app.add_option("--copies", o->copies,
                 "ropes of Bullet in the cost measurement; Strandcast's solvers have four times as many")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  app.add_option("--frames", o->frames,
                 "frames of Bullet in the cost measurement; Strandcast's solvers have four times as many")
      ->check(CLI::Range(1, 10000))
      ->capture_default_str();
  app.add_flag("--quick", o->quick, "fewer settings, fewer frames");
  app.add_option("--plot", o->plot, "also plot stretch against cost into this SVG file");
  addPrintOptions(app, o->print);
  return [o] { return peers(*o); };
}

}  // namespace strandcast
