#include "bench/verbs.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <map>
#include <memory>
#include <optional>

#include "air/hair_grid.h"
#include "air/wind_grid.h"
#include "bench/bench_simulation.h"
#include "core/backend.h"
#include "gpu_compute/gpu_air.h"
#include "service/scene_simulation.h"

namespace strandcast {
namespace {

struct GridOptions {
  std::string backend = "simd", scene = "straight";
  int strands = 10000, vertices = 32, substeps = 4, threads = 0, steps = 30;
  uint64_t seed = 1;
  std::vector<int> cells{32, 64, 128};
  bool mac_cormack = false;
  float drag_along = 1;
  PrintOptions print;
};

using Clock = std::chrono::steady_clock;

/// Times per named pass, in the order of first use.
class PassTimes {
 public:
  template <class Pass>
  void time(const std::string& name, const Pass& pass) {
    const double processor_before = processorMs();
    const Clock::time_point start = Clock::now();
    pass();
    const Clock::time_point end = Clock::now();
    cpu_ms_[name].push_back(processorMs() - processor_before);
    add(name, std::chrono::duration<double, std::milli>(end - start).count());
  }
  void add(const std::string& name, double ms) {
    if (!ms_.contains(name)) names_.push_back(name);
    ms_[name].push_back(ms);
  }
  const std::vector<std::string>& names() const { return names_; }
  bool has(const std::string& name) const { return ms_.contains(name); }
  Spread spread(const std::string& name) const { return spreadOf(ms_.at(name)); }
  double median(const std::string& name) const { return spread(name).median; }
  /// Spread over steps of the sum of all passes. Precondition: all passes have equally many times.
  Spread spreadOfSums() const { return spreadOf(sums(ms_)); }
  Spread cpuSpreadOfSums() const { return spreadOf(sums(cpu_ms_)); }
  /// Median processor time of all threads, ms; empty where the pass did not run on the CPU.
  std::optional<double> cpuMedian(const std::string& name) const {
    const auto found = cpu_ms_.find(name);
    return found == cpu_ms_.end() ? std::nullopt : std::optional(spreadOf(found->second).median);
  }

 private:
  static std::vector<double> sums(const std::map<std::string, std::vector<double>>& times) {
    std::vector<double> out(times.begin()->second.size());
    for (const auto& [name, ms] : times)
      for (size_t i = 0; i < out.size(); ++i) out[i] += ms[i];
    return out;
  }

  std::vector<std::string> names_;
  std::map<std::string, std::vector<double>> ms_, cpu_ms_;
};

struct GridResult {
  int cells;
  PassTimes times;
  Spread all = {};                     ///< ms, sum of all passes
  std::optional<double> cpu_all = {};  ///< ms, the same in processor time
  double iterations = 0;               ///< mean of the pressure solve
  double divergence = 0;  ///< largest divergence times cell size over the largest speed, after the last step
};

GridResult timeGrids(const GridOptions& o, const Scene& scene, const StrandModel& model, int cells) {
  const Workers workers(o.backend == "reference" ? 1 : o.threads);
  const GridPasses<float>& passes = passesOf(o.backend);
  const Box box = restBox(model);
  const StrandState rest = restState(model, model.rest_roots);
  HairGrid<float> hair(passes, workers, model, cells, box);
  WindGrid<float> wind(passes, workers, cells, 2 * box.sizes().maxCoeff() / static_cast<float>(cells),
                       WindGrid<float>::Border::kOpen);
  Parameters parameters = scene.parameters;
  addAir(parameters, cells, o.mac_cormack);
  wind.ambient().configure(parameters);
  wind.centreAt(Vec3(box.center()));
  wind.reset();
  ShapeData shapes;
  std::vector<MovingPrimitive> bodies;
  for (const RigidBody& body : scene.bodies)
    for (const ContactPrimitive& primitive : body.primitives)
      bodies.push_back(moved(primitive, Pose{}, Pose{}, parameters.time_step, shapes.add(primitive)));
  std::vector<Vec3> velocities(rest.positions.size());
  for (size_t v = 0; v < velocities.size(); ++v)
    velocities[v] = Vec3(std::sin(static_cast<float>(v)), 0.5f, std::cos(static_cast<float>(v)));
  const size_t count = hair.samples().samples.size();
  std::vector<float> changes(4 * count);
  GridResult out{cells, {}};
  const double dt = parameters.time_step;
  const bool slips = o.drag_along < 1;
  if (slips) {
    hair.reserveSlip();
    wind.reserveSlip();
  }
  for (int step = 0; step < o.steps; ++step) {
    PassTimes& t = out.times;
    t.time("splat", [&] {
      hair.locate(rest.positions, velocities, Pose{});
      hair.splat();
    });
    t.time("blur, gradient, friction", [&] { hair.computeForces(parameters, dt); });
    t.time("forces to strands", [&] {
      const int chunks = 64;
      workers.forEach(chunks, [&](int c) {
        const size_t begin = count * static_cast<size_t>(c) / chunks,
                     end = count * static_cast<size_t>(c + 1) / chunks;
        hair.changes(begin, end, changes.data() + 4 * begin);
      });
    });
    t.time("solids", [&] {
      wind.clearSolids();
      wind.addSolids(bodies, shapes.words, dt);
    });
    t.time("advect", [&] { wind.advect(dt, o.mac_cormack); });
    t.time("diffuse", [&] { wind.diffuse(dt, static_cast<double>(parameters.air_viscosity)); });
    if (slips) t.time("slip", [&] { hair.splatSlip(rest.positions); });
    t.time("drag", [&] {
      HairDrag<float> drag{&hair.shape(), hair.nodes(), hair.frame(), hair.box()};
      drag.rate = 30;
      drag.less = 1 - o.drag_along;
      for (size_t part = 0; slips && part < 2; ++part) drag.slip[part] = hair.slipNodes(part);
      wind.exchange(dt, drag);
    });
    t.time("project", [&] { out.iterations += wind.project().iterations / static_cast<double>(o.steps); });
  }
  out.divergence = wind.largestOutflow() / wind.fastest();
  out.all = out.times.spreadOfSums();
  out.cpu_all = out.times.cpuSpreadOfSums().median;
  return out;
}

Parameters parametersWithAir(const GridOptions& o, const Scene& scene, int cells) {
  Parameters parameters = scene.parameters;
  parameters.solver = SolverKind::kRod;
  addAir(parameters, cells, o.mac_cormack);
  parameters.air_drag_along = o.drag_along;
  return parameters;
}

/// Times passes on the GPU within steps of the whole simulation: first with all passes overlapping, then one
/// by one.
GridResult timeGpuGrids(const GridOptions& o, const Scene& scene, const StrandModel& model, int cells) {
  std::unique_ptr<ExternalForces> air_system = airOf(o.backend).make({});
  auto& measured = dynamic_cast<MeasuredPasses&>(*air_system);
  const Parameters parameters = parametersWithAir(o, scene, cells);
  Simulation simulation(model, scene.bodies, parameters,
                        createBackend(knownBackends(), o.backend, o.threads, parameters.solver),
                        std::move(air_system));
  GridResult out{cells, {}};
  auto run = [&](int steps) {
    for (int step = 0; step < steps; ++step) simulation.step();
    static_cast<void>(simulation.guides());
  };
  run(5);
  PassTimes whole;
  measured.measure(false, o.steps);
  run(o.steps);
  for (const auto& [name, ms] : measured.drainTimes()) whole.add(name, ms);
  out.all = whole.spread("all");
  measured.measure(true, o.steps);
  run(o.steps);
  for (const auto& [name, ms] : measured.drainTimes()) out.times.add(name, ms);
  const PressureReport pressure = measured.pressure();
  out.iterations = pressure.iterations;
  out.divergence = pressure.residual;
  return out;
}

/// Wraps external forces and records the duration of their step.
class TimedForces final : public ExternalForces {
 public:
  TimedForces(std::unique_ptr<ExternalForces> timed, PassTimes& times)
      : timed_(std::move(timed)), times_(times) {}
  bool isNeeded(const Parameters& parameters) const override { return timed_->isNeeded(parameters); }
  void configure(const StrandModel& model, const Parameters& parameters, Backend& backend) override {
    timed_->configure(model, parameters, backend);
  }
  void reset(const Vec3& origin) override { timed_->reset(origin); }
  void moveOrigin(const Vec3& origin) override { timed_->moveOrigin(origin); }
  void step(StepInput& input, Backend& backend) override {
    times_.time("grids", [&] { timed_->step(input, backend); });
  }
  std::span<const Vec3> accelerations() override { return timed_->accelerations(); }

 private:
  std::unique_ptr<ExternalForces> timed_;
  PassTimes& times_;
};

/// Times of a step of the strands alone, including the read-back of positions, and of one with wind and
/// forces between hairs on grids of 32^3.
struct StepTimes {
  MeasuredRun alone, surrounded;
  double grids = 0;  ///< ms, median wall time of the grids before the strands in the latter
  /// GPU time of the strands in a step without air, ms; on a CPU the whole step.
  double strands() const { return alone.gpu_ms.value_or(alone.ms.median); }
};
StepTimes timeSteps(const GridOptions& o, const Scene& scene, const StrandModel& model) {
  StepTimes out;
  for (const bool surrounded : {false, true}) {
    Parameters parameters = parametersWithAir(o, scene, 32);
    if (!surrounded) {
      parameters = scene.parameters;
      parameters.solver = SolverKind::kRod;
    }
    PassTimes times;
    const auto make = [&] {
      return Simulation(model, {}, parameters,
                        createBackend(knownBackends(), o.backend, o.threads, parameters.solver),
                        std::make_unique<TimedForces>(airOf(o.backend, o.threads).make({}), times));
    };
    const auto still = [](double) { return Pose{}; };
    (surrounded ? out.surrounded : out.alone) = measureSteps(make, still, 5, o.steps);
    if (surrounded) out.grids = times.median("grids");
  }
  return out;
}

int run(const GridOptions& o) {
  for (const int cells : o.cells) {
    Parameters checked;
    setParameter(checked, "grid_cells", {static_cast<double>(cells)}, "--cells");
  }
  Scene scene = benchScene(o.scene, o.strands, o.vertices, o.seed);
  scene.parameters.substeps = o.substeps;
  const StrandModel model = sceneModel(scene);
  const bool on_gpu = o.backend == "gpu";
  const std::string device = on_gpu ? createBackend(knownBackends(), o.backend, 0, SolverKind::kRod)->device()
                                    : passesOf(o.backend).name;
  const StepTimes steps = timeSteps(o, scene, model);
  Bench bench;
  bench.name = "grid";
  bench.params = {{"scene", o.scene},          {"strands", o.strands}, {"vertices", o.vertices},
                  {"substeps", o.substeps},    {"seed", o.seed},       {"mac_cormack", o.mac_cormack},
                  {"drag_along", o.drag_along}};
  bench.heading = fmt::format(
      "scene {}, {} strands of {} vertices on {} ({}): step {:.2f} ms, with grids of 32^3 {:.2f} ms, of "
      "which the grids take {:.2f} ms\n",
      o.scene, o.strands, o.vertices, o.backend, device, steps.alone.ms.median, steps.surrounded.ms.median,
      steps.grids);
  bench.table = Table({{"device"},
                       {"scene"},
                       {"strands"},
                       {"vertices"},
                       {"cells", "cells"},
                       {"pass", "pass"},
                       {"ms", "ms", "{:.3f}"},
                       {"ms_min", "min", "{:.3f}"},
                       {"ms_p95", "p95", "{:.3f}"},
                       {"cpu_ms", "cpu ms", "{:.3f}"},
                       {"of_strand_step", "of a step", "{:.2f}"},
                       {"of_strand_step_cpu", "of its cpu ms", "{:.2f}"},
                       {"pressure_iterations", "iterations", "{:.1f}"},
                       {"divergence", "divergence", "{:.1e}"}});
  nlohmann::json results = nlohmann::json::array();
  for (const int cells : o.cells) {
    const GridResult r = on_gpu ? timeGpuGrids(o, scene, model, cells) : timeGrids(o, scene, model, cells);
    const nlohmann::json shared{{"device", device},
                                {"scene", o.scene},
                                {"strands", o.strands},
                                {"vertices", o.vertices},
                                {"cells", cells}};
    nlohmann::json passes, cpu_passes, spreads = nlohmann::json::array();
    const auto note = [&](const std::string& name, const Spread& ms) {
      spreads.push_back({{"pass", name}, {"ms_min", ms.min}, {"ms_median", ms.median}, {"ms_p95", ms.p95}});
    };
    for (const std::string& name : r.times.names()) {
      const Spread ms = r.times.spread(name);
      passes[name] = ms.median;
      note(name, ms);
      nlohmann::json row = shared;
      row.update({{"pass", name}, {"ms", ms.median}, {"ms_min", ms.min}, {"ms_p95", ms.p95}});
      if (const auto cpu_ms = r.times.cpuMedian(name)) row["cpu_ms"] = cpu_passes[name] = *cpu_ms;
      bench.table.add(std::move(row));
    }
    note("all", r.all);
    nlohmann::json summary{{"of_strand_step", r.all.median / steps.strands()},
                           {"pressure_iterations", r.iterations},
                           {"divergence", r.divergence}};
    nlohmann::json all = shared, result{{"case", fmt::format("{}^3", cells)}};
    all.update({{"pass", "all"}, {"ms", r.all.median}, {"ms_min", r.all.min}, {"ms_p95", r.all.p95}});
    result.update({{"ms_passes", passes}, {"ms_all", r.all.median}, {"passes", spreads}});
    if (r.cpu_all) {
      summary["of_strand_step_cpu"] = *r.cpu_all / steps.alone.cpu_ms.median;
      all["cpu_ms"] = *r.cpu_all;
      result.update({{"cpu_ms_passes", cpu_passes}, {"cpu_ms_all", *r.cpu_all}});
    }
    for (nlohmann::json* row : {&all, &result}) row->update(summary);
    bench.table.add(std::move(all));
    results.push_back(std::move(result));
  }
  bench.more = {{"backend", o.backend},
                {"device", device},
                {"threads", o.threads},
                {"ms_step", steps.alone.ms.median},
                {"ms_strands", steps.strands()},
                {"ms_step_with_grids_32", steps.surrounded.ms.median},
                {"ms_grids_32_in_step", steps.grids},
                {"step", cellsOf(steps.alone)},
                {"step_with_grids_32", cellsOf(steps.surrounded)},
                {"results", results}};
  print(bench, o.print);
  return 0;
}

}  // namespace

std::function<int()> addGridBench(CLI::App& app) {
  const auto o = std::make_shared<GridOptions>();
  addBackend(app, o->backend, {"simd", "reference", "gpu"});
  addScene(app, o->scene);
  addStrands(app, o->strands);
  addVertices(app, o->vertices);
  addSubsteps(app, o->substeps, "substeps of the strands per step");
  addThreads(app, o->threads);
  addSteps(app, o->steps, "timed steps");
  addSeed(app, o->seed);
  const ParameterInfo& cells =
      *std::find_if(parameterList().begin(), parameterList().end(),
                    [](const ParameterInfo& info) { return info.name == "grid_cells"; });
  app.add_option("--cells", o->cells, fmt::format("{}: {}; one or more sizes", cells.help, cells.range))
      ->delimiter(',')
      ->capture_default_str();
  app.add_option("--drag-along", o->drag_along, "air_drag_along: below 1, air slips along the hair")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  app.add_flag("--mac-cormack", o->mac_cormack, "advect with the MacCormack correction");
  addPrintOptions(app, o->print);
  return [o] { return run(*o); };
}

}  // namespace strandcast
