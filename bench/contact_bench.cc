#include "bench/verbs.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>

#include "bench/bench_simulation.h"
#include "collision/tree_broad_phase.h"
#include "core/backend.h"
#include "io/mesh_file.h"
#include "options/number_range.h"
#include "service/scene_simulation.h"

namespace strandcast {
namespace {

struct ContactOptions {
  std::string backend = "simd", scene = "straight", body;
  int strands = 2000, vertices = 32, substeps = 4, threads = 0, warmup = 20, steps = 60;
  float unit_meters = 1, cell = 0.002f;
  uint64_t seed = 1;
  PrintOptions print;
};

using Clock = std::chrono::steady_clock;
double msSince(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// Measures the wrapped broad phase.
class TimedBroadPhase final : public BroadPhase {
 public:
  explicit TimedBroadPhase(std::vector<double>& ms) : inner_(makeTreeBroadPhase()), ms_(ms) {}
  void findPairs(std::span<const Box> bodies, std::span<const Box> strands, NearBodyLists& out) override {
    const Clock::time_point start = Clock::now();
    inner_->findPairs(bodies, strands, out);
    ms_.push_back(msSince(start));
  }

 private:
  std::unique_ptr<BroadPhase> inner_;
  std::vector<double>& ms_;
};

size_t pressedVertices(Simulation& simulation) {
  const StrandState state = simulation.state();
  return static_cast<size_t>(std::count_if(state.contacts.begin(), state.contacts.end(),
                                           [](const Vec3& force) { return force.squaredNorm() > 0; }));
}

int run(const ContactOptions& o) {
  const Scene scene = benchScene(o.scene, o.strands, o.vertices, o.seed);
  ContactPrimitive field;
  Bake bake = bakeField(scene.body, o.cell, o.threads, field);
  bake.mesh = "procedural body";
  const std::vector<RigidBody> bodies{{{field}, true, true}, {fivePrimitives(scene.head_pivot), true}};
  std::vector<Bake> bakes{bake};
  if (!o.body.empty()) {
    GroomReadOptions read;
    read.unit_meters = o.unit_meters;
    ContactPrimitive given;
    bakes.push_back(bakeField(loadMesh(o.body, read).mesh, o.cell, o.threads, given));
    bakes.back().mesh = std::filesystem::path(o.body).filename().string();
  }

  Parameters parameters = scene.parameters;
  parameters.solver = SolverKind::kRod;
  parameters.substeps = o.substeps;
  const auto backend = [&] {
    return createBackend(knownBackends(), o.backend, o.threads, parameters.solver);
  };
  std::vector<double> broad_ms;
  TimedSimulation free([&] { return Simulation(sceneModel(scene), {}, parameters, backend()); }, scene.motion,
                       o.steps);
  TimedSimulation touching(
      [&] {
        return Simulation(sceneModel(scene), bodies, parameters, backend(), nullptr,
                          std::make_unique<TimedBroadPhase>(broad_ms));
      },
      scene.motion, o.steps);
  // Alternates between the simulations, so that other load on the machine affects both alike.
  for (int step = 1; step < o.warmup + o.steps; ++step) {
    if (step == o.warmup) broad_ms.clear();
    broad_ms.reserve(static_cast<size_t>(o.warmup + o.steps));
    free.step(step >= o.warmup);
    touching.step(step >= o.warmup);
  }
  const MeasuredRun without = free.result(), with = touching.result();
  const double broad = spreadOf(broad_ms).median, ratio = with.ms.median / without.ms.median;

  Bench bench;
  bench.name = "contact";
  bench.params = {{"scene", o.scene},
                  {"strands", o.strands},
                  {"vertices", o.vertices},
                  {"substeps", o.substeps},
                  {"seed", o.seed}};
  bench.heading = fmt::format("scene {}, {} x {}, {} substeps\n", o.scene, o.strands, o.vertices, o.substeps);
  bench.table = Table(columnsOf({{{"case", "case"}, {"scene"}, {"strands"}, {"vertices"}, {"substeps"}},
                                 runColumns(),
                                 {{"vertices_pressed", "pressed"}, {"ratio"}, {"ms_broad_phase"}}}));
  const auto add = [&](const char* name, const MeasuredRun& run, Simulation& simulation) {
    nlohmann::json row = cellsOf(run);
    row.update({{"case", name},
                {"scene", o.scene},
                {"strands", o.strands},
                {"vertices", o.vertices},
                {"substeps", o.substeps},
                {"vertices_pressed", pressedVertices(simulation)}});
    if (&run == &with) row.update({{"ratio", ratio}, {"ms_broad_phase", broad}});
    bench.table.add(std::move(row));
  };
  add("no body", without, free.simulation());
  add("mesh and five primitives", with, touching.simulation());
  bench.closing = fmt::format("  ratio {:.2f}; the broad phase takes {:.3f} ms of the step\n", ratio, broad);
  nlohmann::json baked = nlohmann::json::array();
  for (const Bake& b : bakes) {
    bench.comments.push_back(fmt::format(
        "field of {}: {} triangles, cells of {:.2f} mm: {:.2f} s, {:.1f} MB, {:.1f} MB besides while baking",
        b.mesh, b.triangles, 1e3 * b.cell, b.seconds, 1e-6 * static_cast<double>(b.field_bytes),
        1e-6 * static_cast<double>(b.working_bytes)));
    bench.closing += fmt::format("  {}\n", bench.comments.back());
    baked.push_back({{"mesh", b.mesh},
                     {"triangles", b.triangles},
                     {"cell_m", b.cell},
                     {"seconds", b.seconds},
                     {"field_bytes", b.field_bytes},
                     {"working_bytes", b.working_bytes}});
  }
  bench.more = {{"backend", without.backend}, {"device", without.device},
                {"threads", o.threads},       {"ratio", ratio},
                {"ms_broad_phase", broad},    {"bakes", baked}};
  print(bench, o.print);
  return 0;
}

}  // namespace

std::function<int()> addContactBench(CLI::App& app) {
  const auto o = std::make_shared<ContactOptions>();
  addBackend(app, o->backend, {"auto", "gpu", "simd", "reference"});
  addScene(app, o->scene);
  app.add_option("--body", o->body, "mesh file (.obj, .gltf, .glb) whose bake is also timed");
  app.add_option("--unit-meters", o->unit_meters, "metres per unit of the --body file")
      ->check(finiteRange(1e-6, 1000.0))
      ->capture_default_str();
  app.add_option("--cell", o->cell, "edge of a cell of the fields, m")
      ->check(finiteRange(1e-6, 1000.0))
      ->capture_default_str();
  addStrands(app, o->strands);
  addVertices(app, o->vertices);
  addSubsteps(app, o->substeps);
  addThreads(app, o->threads, "threads of the simd backend and of bakes; 0 = all");
  addSteps(app, o->steps);
  addSeed(app, o->seed);
  addPrintOptions(app, o->print);
  return [o] { return run(*o); };
}

}  // namespace strandcast
