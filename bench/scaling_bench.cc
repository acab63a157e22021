#include "bench/verbs.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <limits>
#include <memory>
#include <thread>

#include "bench/bench_simulation.h"
#include "bench/reader_process.h"
#include "bench/report.h"
#include "core/backend.h"
#include "core/error.h"
#include "options/console.h"
#include "options/number_range.h"
#include "service/network.h"
#include "service/scene_simulation.h"
#include "simd/simd_backend.h"
#include "transport/dds.h"
#include "transport/frame_queue.h"

namespace strandcast {
namespace {

using Clock = std::chrono::steady_clock;
const std::vector<std::string> kAxes{"strands", "vertices", "substeps", "threads",
                                     "lanes",   "grooms",   "readers"};

struct ScalingOptions {
  std::vector<std::string> axes = kAxes;
  std::string backend = "simd", scene = "curly";
  int strands = 0, max_strands = 1000000, vertices = 32, substeps = 4;
  int threads = 1;  // unless it is the axis
  double budget = 0;
  uint64_t seed = 1;
  bool quick = false;
  PrintOptions print;
};

double secondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Memory that the machine has available without swapping, bytes; infinite where the system does not say.
double availableMemory() {
  std::ifstream info("/proc/meminfo");
  for (std::string line; std::getline(info, line);)
    if (line.starts_with("MemAvailable:")) return 1024 * std::strtod(line.c_str() + 13, nullptr);
  return std::numeric_limits<double>::infinity();
}

struct ScalingSetting {
  std::string axis;
  double value = 0;  // along the axis
  int strands, vertices, substeps, threads;
  std::string backend, target = {};
};

class Scaling {
 public:
  explicit Scaling(const ScalingOptions& options) : o_(options) {}

  void run() {
    for (size_t i = 0; i < o_.axes.size(); ++i) {
      part_ = static_cast<double>(i) / static_cast<double>(o_.axes.size());
      const std::string& axis = o_.axes[i];
      if (axis == "strands") sizes(axis, {100, 1000, 10000, 100000, 1000000});
      if (axis == "vertices") sizes(axis, {8, 16, 32, 64, 128});
      if (axis == "substeps") sizes(axis, {1, 2, 4, 8, 16, 32});
      if (axis == "threads") threads();
      if (axis == "lanes") lanes();
      if (axis == "grooms") grooms();
      if (axis == "readers") readers();
    }
  }
  Table table{columnsOf(
      {{{"axis", "axis"}, {"value", "of it", "{:g}"}, {"strands"}, {"vertices"}, {"substeps"}, {"threads"}},
       runColumns(),
       {{"speedup", "speedup", "{:.2f}"},
        {"efficiency", "efficiency", "{:.2f}"},
        {"same_hash", "same state"},
        {"publish_ms", "publish ms", "{:.2f}"},
        {"frames_lost", "lost"},
        {"latency_ms_p50", "latency", "{:.2f}"},
        {"latency_ms_p99", "p99", "{:.2f}"}}})};
  std::vector<std::string> left_out;

 private:
  int strandsOr(int usual) const { return o_.strands > 0 ? o_.strands : usual; }
  ScalingSetting setting(const std::string& axis, double value, int strands) const {
    return {axis, value, strands, o_.vertices, o_.substeps, o_.threads, o_.backend};
  }
  void show(const ScalingSetting& s) { bar_.show(fmt::format("{} {:g}", s.axis, s.value), part_); }

  std::unique_ptr<TimedSimulation> make(const Scene& scene, const ScalingSetting& s, int steps) const {
    Parameters parameters = scene.parameters;
    parameters.solver = SolverKind::kRod;
    parameters.substeps = s.substeps;
    const auto simulation = [&] {
      return Simulation(sceneModel(scene), {}, parameters,
                        s.target.empty()
                            ? createBackend(knownBackends(), s.backend, s.threads, parameters.solver)
                            : makeSimdBackend(s.threads, s.target));
    };
    return std::make_unique<TimedSimulation>(simulation, scene.motion, steps);
  }
  /// The columns that all axes share.
  static nlohmann::json rowOf(const ScalingSetting& s, const MeasuredRun& run) {
    nlohmann::json row = cellsOf(run);
    row.update({{"axis", s.axis},
                {"value", s.value},
                {"strands", s.strands},
                {"vertices", s.vertices},
                {"substeps", s.substeps},
                {"threads", s.threads}});
    return row;
  }
  /// Number of steps to measure for a step time in ms: about 1.5 s of them (0.3 s with --quick), 5 to 200.
  int stepsFor(double ms) const { return std::clamp(static_cast<int>((o_.quick ? 300 : 1500) / ms), 5, 200); }

  void sizes(const std::string& axis, const std::vector<int>& values) {
    double bytes_per_vertex = 0, seconds_per_unit = 0;
    for (const int value : values) {
      ScalingSetting s = setting(axis, value, axis == "strands" ? value : strandsOr(2000));
      if (axis == "vertices") s.vertices = value;
      if (axis == "substeps") s.substeps = value;
      if (s.strands > o_.max_strands) continue;
      // The factor 2 accounts for the scene beside its simulation.
      const double vertices = static_cast<double>(s.strands) * s.vertices;
      const double memory = 2 * bytes_per_vertex * vertices, most = 0.7 * availableMemory();
      if (memory > most) {
        left_out.push_back(fmt::format("{} {}: it would take {:.1f} GB of memory, {:.1f} are free", axis,
                                       value, 1e-9 * memory, 1e-9 * most));
        continue;
      }
      if (seconds_per_unit * value > o_.budget) {
        left_out.push_back(fmt::format("{} {}: it would take {:.0f} s, --budget is {:g}", axis, value,
                                       seconds_per_unit * value, o_.budget));
        continue;
      }
      show(s);
      const Clock::time_point start = Clock::now();
      const Scene scene = benchScene(o_.scene, s.strands, s.vertices, o_.seed);
      const std::unique_ptr<TimedSimulation> timed = make(scene, s, 200);
      for (int step = 0; step < 4; ++step) timed->step(false);
      const Clock::time_point first = Clock::now();
      timed->step(true);
      const int steps = stepsFor(1e3 * secondsSince(first));
      for (int step = 1; step < steps; ++step) timed->step(true);
      const MeasuredRun run = timed->result();
      table.add(rowOf(s, run));
      bytes_per_vertex = run.bytesPerVertex();
      seconds_per_unit = secondsSince(start) / value;
    }
  }

  /// Interleaves the settings step by step, so that other load on the machine affects all alike. Speedups are
  /// relative to the first setting, by minimum times.
  std::vector<nlohmann::json> inTurn(const std::vector<ScalingSetting>& settings, int steps) {
    const Scene scene = benchScene(o_.scene, settings[0].strands, settings[0].vertices, o_.seed);
    std::vector<std::unique_ptr<TimedSimulation>> timed;
    for (const ScalingSetting& s : settings) timed.push_back(make(scene, s, steps));
    for (int step = -4; step < steps; ++step)
      for (const auto& simulation : timed) simulation->step(step >= 0);
    std::vector<nlohmann::json> rows;
    for (size_t i = 0; i < settings.size(); ++i) {
      rows.push_back(rowOf(settings[i], timed[i]->result()));
      rows[i]["speedup"] = settings[0].axis == "threads"
                               ? rows[0]["ms_min"].get<double>() / rows[i]["ms_min"].get<double>()
                               : minMs(rows[0]) / minMs(rows[i]);
    }
    return rows;
  }

  void threads() {
    const int all = static_cast<int>(std::thread::hardware_concurrency());
    std::vector<ScalingSetting> settings;
    for (int n = 1;; n = std::min(2 * n, all)) {
      settings.push_back(setting("threads", n, strandsOr(10000)));
      settings.back().threads = n;
      if (n == all) break;
    }
    show(settings.back());
    std::vector<nlohmann::json> rows = inTurn(settings, o_.quick ? 30 : 100);
    for (nlohmann::json& row : rows) {
      row["efficiency"] = row["speedup"].get<double>() / row["value"].get<double>();
      row["same_hash"] = row["state_hash"] == rows[0]["state_hash"] ? "yes" : "no";
      table.add(row);
    }
  }

  void lanes() {
    std::vector<ScalingSetting> settings{setting("lanes", 1, strandsOr(2000))};
    settings[0].backend = "reference";
    std::vector<std::string> targets = simdTargets();
    std::reverse(targets.begin(), targets.end());
    for (const std::string& target : targets) {
      // Vectors of 128, 256 and 512 bits of floats.
      const double lanes = target.starts_with("AVX3") ? 16
                           : target == "AVX2"         ? 8
                           : target == "SCALAR"       ? 1
                                                      : 4;
      settings.push_back(setting("lanes", lanes, settings[0].strands));
      settings.back().target = target;
    }
    for (ScalingSetting& s : settings) s.threads = 1;
    show(settings.back());
    for (nlohmann::json& row : inTurn(settings, o_.quick ? 12 : 60)) table.add(std::move(row));
  }

  /// The same number of strands as one groom and as several, in one process and stepped one after the other.
  void grooms() {
    const int all = strandsOr(8192);
    double first = 0;
    for (int count = 1; count <= 16; count *= 2) {
      ScalingSetting s = setting("grooms", count, all / count);
      show(s);
      const Scene scene = benchScene(o_.scene, s.strands, s.vertices, o_.seed);
      std::vector<std::unique_ptr<TimedSimulation>> timed;
      const int steps = o_.quick ? 20 : 100;
      for (int g = 0; g < count; ++g) timed.push_back(make(scene, s, steps));
      std::vector<double> ms, cpu_ms;
      for (int step = -4; step < steps; ++step) {
        const Clock::time_point start = Clock::now();
        const double processor = processorMs();
        for (const auto& simulation : timed) simulation->step(step >= 0);
        if (step < 0) continue;
        ms.push_back(1e3 * secondsSince(start));
        cpu_ms.push_back(processorMs() - processor);
      }
      MeasuredRun run = timed[0]->result();
      bool same = true;
      for (const auto& simulation : timed) {
        const MeasuredRun other = simulation->result();
        same = same && other.hash == run.hash;
        if (simulation == timed[0]) continue;
        run.vertices += other.vertices;
        run.heap_bytes += other.heap_bytes;
        run.gpu_bytes += other.gpu_bytes;
        run.allocations += other.allocations;
      }
      run.ms = spreadOf(ms);
      run.cpu_ms = spreadOf(cpu_ms);
      run.gpu_ms.reset();
      nlohmann::json row = rowOf(s, run);
      if (count == 1) first = minMs(row);
      row.update({{"speedup", first / minMs(row)}, {"same_hash", same ? "yes" : "no"}});
      table.add(std::move(row));
    }
  }

  /// One daemon's stream, received by several processes.
  void readers() {
    std::string reason;
    if (!ddsAvailable(&reason)) {
      left_out.push_back("readers: " + reason);
      return;
    }
    constexpr double kRate = 60;
    const auto frames = static_cast<uint64_t>((o_.quick ? 1.5 : 5) * kRate);
    for (int count = 1; count <= 8; count *= 2) {
      ScalingSetting s = setting("readers", count, strandsOr(1000));
      show(s);
      const Scene scene = benchScene(o_.scene, s.strands, s.vertices, o_.seed);
      const std::unique_ptr<TimedSimulation> timed = make(scene, s, static_cast<int>(frames));
      const std::unique_ptr<Publisher> publisher =
          makeDdsPublisher({benchDomain(), 1, newSession(), CodecOptions()});
      GroomDescription groom;
      groom.revision = 1;
      groom.guides = scene.groom.strands;
      publisher->announce(groom, {});
      std::vector<std::unique_ptr<ReaderProcess>> processes;
      for (int i = 0; i < count; ++i)
        processes.push_back(std::make_unique<ReaderProcess>(benchDomain(), frames, 0, 1));
      for (const auto& process : processes) process->waitReady();
      for (int i = 0; i < 500 && publisher->matchedReaders() < static_cast<uint32_t>(count); ++i)
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
      GuideFrame frame;
      frame.revision = 1;
      std::vector<double> publish_ms;
      const Clock::time_point start = Clock::now();
      for (frame.frame = 1; frame.frame <= frames; ++frame.frame) {
        std::this_thread::sleep_until(
            start + std::chrono::duration_cast<Clock::duration>(
                        std::chrono::duration<double>(static_cast<double>(frame.frame) / kRate)));
        timed->step(true);
        const std::span<const Vec3> guides = timed->simulation().guides();
        frame.positions.assign(guides.begin(), guides.end());
        frame.head = timed->simulation().headPose();
        frame.simulation_time = timed->simulation().time();
        frame.publish_time = systemTime();
        const Clock::time_point before = Clock::now();
        publisher->publish(frame);
        publish_ms.push_back(1e3 * secondsSince(before));
      }
      nlohmann::json row = rowOf(s, timed->result());
      uint64_t lost = 0;
      double p50 = 0, p99 = 0;
      for (const auto& process : processes) {
        const nlohmann::json report = process->report();
        lost += frames - std::min(frames, report["received"].get<uint64_t>());
        p50 = std::max(p50, report["latency_ms_p50"].get<double>());
        p99 = std::max(p99, report["latency_ms_p99"].get<double>());
      }
      row.erase("allocations");  // would include allocations of DDS's threads
      row.update({{"publish_ms", spreadOf(publish_ms).median},
                  {"frames_lost", lost},
                  {"latency_ms_p50", p50},
                  {"latency_ms_p99", p99}});
      table.add(std::move(row));
    }
  }

  const ScalingOptions& o_;
  ProgressBar bar_;
  double part_ = 0;
};

/// Conclusions from the rows, a line each.
std::string scalingConclusions(const std::vector<nlohmann::json>& rows) {
  std::string out;
  for (const AxisFit& fit : fitAxes(rows))
    out += fmt::format("  time ~ {}^{:.3f}, standard error {:.3f}, of {} points\n", fit.axis,
                       fit.law.exponent, fit.law.standard_error, fit.points);
  double least = std::numeric_limits<double>::infinity(), most = 0;
  for (const nlohmann::json& row : rows) {
    if (row["axis"] == "strands" && row["strands"] >= 1000) {
      least = std::min(least, row["bytes_per_vertex"].get<double>());
      most = std::max(most, row["bytes_per_vertex"].get<double>());
    }
    if (row["axis"] == "lanes" && row["value"] > 1)
      out += fmt::format("  {}: {:.2f} times the float reference\n", row["device"].get<std::string>(),
                         row["speedup"].get<double>());
    if (row["axis"] == "threads" && row["value"] > 1)
      out += fmt::format("  {:g} threads: {:.2f} times one, efficiency {:.0f} %, {} state\n",
                         row["value"].get<double>(), row["speedup"].get<double>(),
                         100 * row["efficiency"].get<double>(),
                         row["same_hash"] == "yes" ? "the same" : "ANOTHER");
  }
  if (most > 0)
    out += fmt::format("  memory per vertex from 1,000 strands on: {:.0f} to {:.0f} B\n", least, most);
  return out;
}

int scaling(ScalingOptions o) {
  if (o.budget == 0) o.budget = o.quick ? 15 : 300;
  Bench bench;
  bench.name = "scaling";
  {
    Scaling scaling(o);
    scaling.run();
    bench.table = std::move(scaling.table);
    bench.more["left_out"] = scaling.left_out;
    bench.closing = scalingConclusions(bench.table.rows());
    for (const std::string& what : scaling.left_out) bench.closing += fmt::format("  left out: {}\n", what);
  }
  bench.params = {{"scene", o.scene},     {"vertices", o.vertices}, {"substeps", o.substeps},
                  {"threads", o.threads}, {"quick", o.quick},       {"budget_s", o.budget},
                  {"backend", o.backend}, {"seed", o.seed}};
  nlohmann::json fits = nlohmann::json::array();
  for (const AxisFit& fit : fitAxes(bench.table.rows()))
    fits.push_back({{"axis", fit.axis},
                    {"exponent", fit.law.exponent},
                    {"standard_error", fit.law.standard_error},
                    {"points", fit.points}});
  bench.more["fits"] = fits;
  print(bench, o.print);
  return 0;
}

}  // namespace

std::function<int()> addScalingBench(CLI::App& app) {
  const auto o = std::make_shared<ScalingOptions>();
  app.footer(
      "strands:  100 to 1,000,000 of 32 vertices       vertices: 8 to 128, of 2,000 strands\n"
      "substeps: 1 to 32                                threads:  1 to all, 10,000 strands\n"
      "lanes:    the float reference, then simd with each instruction set of this machine, one thread\n"
      "grooms:   8,192 strands as 1 to 16 grooms in one process\n"
      "readers:  1 to 8 processes that read one stream of 1,000 guides over DDS\n"
      "Sizes that would take longer than --budget are left out and listed: with --quick, as `strandbench "
      "all` runs it,\n"
      "those beyond 10,000 strands on few cores. `strandbench all --thorough`, or this without --quick, "
      "includes them.\n"
      "Exponents are fitted to the least times, by least squares of their logarithms. Steps of the runs of "
      "the\n"
      "threads axis, and of the lanes axis, are interleaved; the speedup is the ratio of the least times.\n"
      "Examples:\n"
      "  strandbench scaling --quick\n"
      "  strandbench scaling --axes lanes,threads");
  app.add_option("--axes", o->axes,
                 "axes to measure: strands, vertices, substeps, threads, lanes, grooms, readers")
      ->delimiter(',')
      ->check(CLI::IsMember(kAxes));
  addBackend(app, o->backend, {"simd", "gpu", "reference"},
             "backend that simulates; lanes and threads use simd");
  addScene(app, o->scene);
  addSeed(app, o->seed);
  app.add_option("--strands", o->strands, "number of strands on other axes; 0 = as above")
      ->check(CLI::Range(0, 1000000));
  app.add_option("--max-strands", o->max_strands, "largest value of the axis strands")
      ->check(CLI::Range(100, 1000000))
      ->capture_default_str();
  addVertices(app, o->vertices, "vertices per strand on other axes");
  addSubsteps(app, o->substeps, "substeps per step on other axes");
  addThreads(app, o->threads, "threads on other axes; 0 = all");
  app.add_option("--budget", o->budget,
                 "time limit per size, s, including making the scene; larger sizes are left out; default "
                 "300, with --quick 15")
      ->check(finiteRange(0.001, 1e6));
  app.add_flag("--quick", o->quick, "fewer steps per size");
  addPrintOptions(app, o->print);
  return [o] { return scaling(*o); };
}

}  // namespace strandcast
