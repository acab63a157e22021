// strandbench step: how long a step takes, and in the same run what it computed. ms: of a step and of reading
// its guides, by the wall; gpu ms: of a step's dispatches alone, by the GPU's own clock; of peak: the
// operations of the step, counted, against what the same threads reach with multiply-adds alone, measured.
// strandbench accuracy: bench/accuracy.h. strandbench grid: bench/grid_bench.h. strandbench contact:
// bench/contact_bench.h. strandbench render: bench/render_bench.h.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>

#include "apps/backends.h"
#include "apps/console.h"
#include "bench/accuracy.h"
#include "bench/contact_bench.h"
#include "bench/grid_bench.h"
#include "bench/operation_count.h"
#ifdef STRANDCAST_HAS_RENDER
#include "bench/render_bench.h"
#endif
#include "collision/tree_broad_phase.h"
#include "core/backend_registry.h"
#include "core/simulation.h"
#include "scenes/scene.h"

using namespace strandcast;

namespace {

struct Options {
  std::string backend = "auto", scene = "straight", solver = "rod", bodies = "none";
  int strands = 2000, vertices = 32, substeps = 4, iterations = 6, threads = 0, warmup = 20, steps = 60;
  uint64_t seed = 1;
  std::optional<float> damping_time;  // s
  bool json = false, csv = false;
};

struct Result {
  std::string backend, device;
  double ms_min, ms_median, ms_p95, ns_per_vertex_substep, vertices_per_s;
  std::optional<double> gpu_ms;  // of the dispatches alone, median
  double operations;             // floating-point, per vertex and substep
  std::optional<double> fraction_of_peak;
  Measurement measured;
  uint64_t hash;
};

std::vector<RigidBody> bodiesOf(const Options& o, const Scene& scene) {
  if (o.bodies == "none") return {};
  if (o.bodies == "scene") return scene.bodies;
  ContactPrimitive head;  // a sphere that hair lies on
  head.a = scene.head_pivot + Vec3(0, 0.08f, 0);
  head.radius = 0.06f;
  return {{{head}, true}};
}

Result run(const Options& o, const Scene& scene, const std::string& backend) {
  Parameters parameters = scene.parameters;
  parameters.substeps = o.substeps;
  parameters.iterations = o.iterations;
  parameters.solver = solverKind(o.solver);
  if (o.damping_time) parameters.damping_time = *o.damping_time;
  Simulation simulation(sceneModel(scene), bodiesOf(o, scene), parameters,
                        createBackend(knownBackends(), backend, o.threads, parameters.solver), nullptr,
                        makeTreeBroadPhase());
  std::vector<double> ms, gpu_ms;
  for (int step = 0; step < o.warmup + o.steps; ++step) {
    simulation.setHeadPose(scene.motion(simulation.time() + parameters.time_step));
    const auto start = std::chrono::steady_clock::now();
    simulation.step();
    simulation.guides();
    if (step < o.warmup) continue;
    ms.push_back(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
    if (const auto seconds = simulation.backend().gpuSeconds()) gpu_ms.push_back(1000 * *seconds);
  }
  std::sort(ms.begin(), ms.end());
  std::sort(gpu_ms.begin(), gpu_ms.end());
  const double median = ms[ms.size() / 2];
  const double vertices = static_cast<double>(simulation.model().vertices());
  const double operations =
      operationsPerVertexSubstep(simulation.model(), simulation.state(), simulation.nextInput());
  const std::string name = simulation.backend().name();
  std::optional<double> fraction_of_peak;
  if (name != "gpu") {
    const int all = static_cast<int>(std::thread::hardware_concurrency());
    const int threads = name == "reference" ? 1 : o.threads > 0 ? o.threads : all;
    fraction_of_peak = operations * vertices * o.substeps / (1e-3 * median) / measuredPeak(threads);
  }
  return {name,
          simulation.backend().device(),
          ms.front(),
          median,
          ms[std::min(ms.size() - 1, ms.size() * 95 / 100)],
          1e6 * median / (vertices * o.substeps),
          1000 * vertices / median,
          gpu_ms.empty() ? std::nullopt : std::optional(gpu_ms[gpu_ms.size() / 2]),
          operations,
          fraction_of_peak,
          simulation.measure(),
          stateHash(simulation.state())};
}

nlohmann::json toJson(const Result& r) {
  const nlohmann::json gpu_ms = r.gpu_ms ? nlohmann::json(*r.gpu_ms) : nlohmann::json();
  const nlohmann::json fraction = r.fraction_of_peak ? nlohmann::json(*r.fraction_of_peak) : nlohmann::json();
  return {{"case", r.backend},
          {"device", r.device},
          {"ms_min", r.ms_min},
          {"ms_median", r.ms_median},
          {"ms_p95", r.ms_p95},
          {"gpu_ms", gpu_ms},
          {"ns_per_vertex_substep", r.ns_per_vertex_substep},
          {"vertices_per_s", r.vertices_per_s},
          {"operations_per_vertex_substep", r.operations},
          {"fraction_of_peak", fraction},
          {"mean_stretch", r.measured.mean_stretch},
          {"max_stretch", r.measured.max_stretch},
          {"max_penetration_m", r.measured.max_penetration},
          {"state_hash", fmt::format("{:016x}", r.hash)}};
}

int step(const Options& o) {
  SceneOptions make;
  make.name = o.scene;
  make.strands = o.strands;
  make.vertices = o.vertices;
  make.seed = o.seed;
  const Scene scene = makeScene(make);
  nlohmann::json results = nlohmann::json::array();
  if (o.csv)
    fmt::print(
        "backend,device,solver,scene,bodies,strands,vertices,substeps,iterations,ms_min,ms_median,ms_p95,gpu_"
        "ms,"
        "ns_per_vertex_substep,operations_per_vertex_substep,fraction_of_peak,mean_stretch,max_stretch,max_"
        "penetration_m\n");
  else if (!o.json)
    fmt::print(
        "scene {}, bodies {}, {} x {}, {} substeps, {} iterations, solver {}\n  {:<10} {:>9} {:>9} {:>9} "
        "{:>9} {:>11} "
        "{:>8} {:>12} {:>12} {:>10}  {}\n",
        o.scene, o.bodies, o.strands, o.vertices, o.substeps, o.iterations, o.solver, "backend", "ms min",
        "median", "p95", "gpu ms", "ns/vtx/sub", "of peak", "mean stretch", "max stretch", "depth mm",
        "device");
  for (const BackendInfo& info : knownBackends()) {
    if (o.backend != "all" && o.backend != info.name && !(o.backend == "auto")) continue;
    const bool runs = info.available && std::find(info.solvers.begin(), info.solvers.end(),
                                                  solverKind(o.solver)) != info.solvers.end();
    if (!runs && o.backend == "all") continue;
    const Result r = run(o, scene, o.backend == "auto" ? "auto" : info.name);
    results.push_back(toJson(r));
    const std::string fraction = r.fraction_of_peak ? fmt::format("{:.3f}", *r.fraction_of_peak) : "";
    const std::string gpu_ms = r.gpu_ms ? fmt::format("{:.4f}", *r.gpu_ms) : "";
    if (o.csv)
      fmt::print(
          "{},\"{}\",{},{},{},{},{},{},{},{:.4f},{:.4f},{:.4f},{},{:.3f},{:.1f},{},{:.3e},{:.3e},{:.3e}\n",
          r.backend, r.device, o.solver, o.scene, o.bodies, o.strands, o.vertices, o.substeps, o.iterations,
          r.ms_min, r.ms_median, r.ms_p95, gpu_ms, r.ns_per_vertex_substep, r.operations, fraction,
          r.measured.mean_stretch, r.measured.max_stretch, r.measured.max_penetration);
    else if (!o.json)
      fmt::print(
          "  {:<10} {:>9.3f} {:>9.3f} {:>9.3f} {:>9} {:>11.2f} {:>8} {:>12.2e} {:>12.2e} {:>10.3f}  {}\n",
          r.backend, r.ms_min, r.ms_median, r.ms_p95, gpu_ms.empty() ? "-" : gpu_ms, r.ns_per_vertex_substep,
          fraction.empty() ? "-" : fraction, r.measured.mean_stretch, r.measured.max_stretch,
          1000 * r.measured.max_penetration, r.device);
    std::fflush(stdout);
    if (o.backend == "auto") break;
  }
  if (o.json)
    fmt::print("{}\n", nlohmann::json({{"name", "step"},
                                       {"backend", o.backend},
                                       {"threads", o.threads},
                                       {"params",
                                        {{"scene", o.scene},
                                         {"solver", o.solver},
                                         {"bodies", o.bodies},
                                         {"strands", o.strands},
                                         {"vertices", o.vertices},
                                         {"substeps", o.substeps},
                                         {"iterations", o.iterations},
                                         {"seed", o.seed}}},
                                       {"results", results}})
                           .dump());
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("strandbench measures Strandcast, and beside each time says what was computed in it.");
  app.require_subcommand(1);
  Options o;
  CLI::App* verb = app.add_subcommand("step", "time of a simulation step");
  verb->add_option("--backend", o.backend, "auto, gpu, simd, reference or all")
      ->check(CLI::IsMember({"auto", "gpu", "simd", "reference", "all"}))
      ->capture_default_str();
  verb->add_option("--solver", o.solver, "rod or gauss_seidel")
      ->check(CLI::IsMember({"rod", "gauss_seidel"}))
      ->capture_default_str();
  verb->add_option("--scene", o.scene, "procedural scene")->capture_default_str();
  verb->add_option("--bodies", o.bodies,
                   "none; sphere: one with friction, in the head; scene: all of the scene's")
      ->check(CLI::IsMember({"none", "sphere", "scene"}))
      ->capture_default_str();
  verb->add_option("--strands", o.strands)->check(CLI::Range(1, 1000000))->capture_default_str();
  verb->add_option("--vertices", o.vertices, "per strand")->check(CLI::Range(2, 128))->capture_default_str();
  verb->add_option("--substeps", o.substeps)->check(CLI::Range(1, 64))->capture_default_str();
  verb->add_option("--iterations", o.iterations)->check(CLI::Range(1, 64))->capture_default_str();
  verb->add_option("--damping", o.damping_time,
                   "s, internal damping time of the rod; the scene's own if not given")
      ->check(CLI::Range(0.0, 1.0));
  verb->add_option("--threads", o.threads, "of the simd backend; 0 = all")->check(CLI::Range(0, 1024));
  verb->add_option("--steps", o.steps, "steps timed, after a warm-up")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  verb->add_option("--seed", o.seed)->capture_default_str();
  verb->add_flag("--json", o.json, "print one JSON object");
  verb->add_flag("--csv", o.csv, "print comma-separated values");
  CLI::App* accuracy_verb =
      app.add_subcommand("accuracy", "cost of the solvers' settings against their error");
  const std::function<int()> accuracy = addAccuracy(*accuracy_verb);
  CLI::App* grid_verb = app.add_subcommand("grid", "time of wind on a grid and of forces between hairs");
  const std::function<int()> grid = addGridBench(*grid_verb);
  CLI::App* contact_verb = app.add_subcommand(
      "contact", "cost of hair on bodies against hair without, and of baking a body's field");
  const std::function<int()> contact = addContactBench(*contact_verb);
#ifdef STRANDCAST_HAS_RENDER
  CLI::App* render_verb = app.add_subcommand("render", "time of growing hair and of every pass of a picture");
  const std::function<int()> render = addRenderBench(*render_verb);
#endif
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : kExitBadInput;
  }
  return runProgram([&] {
#ifdef STRANDCAST_HAS_RENDER
    if (render_verb->parsed()) return render();
#endif
    return accuracy_verb->parsed()  ? accuracy()
           : grid_verb->parsed()    ? grid()
           : contact_verb->parsed() ? contact()
                                    : step(o);
  });
}
