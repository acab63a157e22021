#include "bench/contact_bench.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <memory>
#include <nlohmann/json.hpp>
#include <numeric>

#include "apps/backends.h"
#include "collision/field_bake.h"
#include "collision/tree_broad_phase.h"
#include "core/backend_registry.h"
#include "core/measure.h"
#include "core/simulation.h"
#include "groom/mesh_file.h"
#include "scenes/scene.h"

namespace strandcast {
namespace {

struct Options {
  std::string backend = "simd", body;
  int strands = 2000, vertices = 32, substeps = 4, threads = 0, warmup = 20, steps = 60;
  float unit_meters = 1, cell = 0.002f;
  bool json = false;
};

using Clock = std::chrono::steady_clock;
double msSince(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// A broad phase that is timed.
class TimedBroadPhase final : public BroadPhase {
 public:
  explicit TimedBroadPhase(std::vector<double>& ms) : inner_(makeTreeBroadPhase()), ms_(ms) {}
  void find(std::span<const Box> bodies, std::span<const Box> strands, NearBodyLists& out) override {
    const Clock::time_point start = Clock::now();
    inner_->find(bodies, strands, out);
    ms_.push_back(msSince(start));
  }

 private:
  std::unique_ptr<BroadPhase> inner_;
  std::vector<double>& ms_;
};

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

struct Bake {
  std::string mesh;
  size_t triangles = 0, field_bytes = 0, working_bytes = 0;
  double seconds = 0;
  float cell = 0;
};

/// The scene's own body, or the mesh that was given, in place.
Bake bakeInto(const TriangleMesh& mesh, const Options& o, std::vector<RigidBody>* bodies) {
  FieldOptions options;
  options.cell = o.cell;
  BakeLimits limits;
  limits.threads = o.threads;
  const Clock::time_point start = Clock::now();
  FieldBaker baker(mesh, options, limits);
  ContactPrimitive shape;
  shape.kind = PrimitiveKind::kField;
  shape.field = std::make_shared<const DistanceField>(baker.bake());
  Bake bake{
      mesh.name,           mesh.triangles.size(), 0, baker.estimate().working_bytes, 1e-3 * msSince(start),
      baker.options().cell};
  const DistanceField& field = *shape.field;
  bake.field_bytes = 4 * (field.index.size() + field.samples.size() + field.corners.size());
  if (bodies != nullptr) bodies->push_back({{std::move(shape)}, true, true});
  return bake;
}

/// Five primitives in the hair: shoulders, a comb, a hand, an ear.
std::vector<ContactPrimitive> fivePrimitives(const Vec3& pivot) {
  auto at = [&](float x, float y, float z) -> Vec3 { return pivot + Vec3(x, y, z); };
  ContactPrimitive sphere{PrimitiveKind::kSphere, at(0.09f, 0.06f, 0), Vec3::UnitY(), 0.025f};
  ContactPrimitive capsule{PrimitiveKind::kCapsule, at(-0.2f, -0.1f, 0), at(0.2f, -0.1f, 0), 0.05f};
  ContactPrimitive tapered{PrimitiveKind::kTaperedCapsule, at(0.12f, 0, -0.05f), at(0.12f, -0.2f, -0.05f),
                           0.03f};
  tapered.radius_b = 0.045f;
  ContactPrimitive ellipsoid{PrimitiveKind::kEllipsoid, at(-0.12f, -0.02f, -0.02f), Vec3::UnitY(), 0};
  ellipsoid.extent = Vec3(0.02f, 0.06f, 0.04f);
  ContactPrimitive box{PrimitiveKind::kBox, at(0, -0.1f, -0.14f), Vec3::UnitY(), 0};
  box.extent = Vec3(0.1f, 0.08f, 0.01f);
  return {sphere, capsule, tapered, ellipsoid, box};
}

struct Timing {
  double ms = 0;
  Measurement measured;
  uint64_t hash = 0;
  size_t pressed = 0;
};

/// Two simulations in turn, so that what else the machine does meets both alike.
void timeSteps(const Options& o, const Scene& scene, std::span<Simulation> simulations,
               std::span<Timing> out) {
  std::vector<std::vector<double>> ms(simulations.size());
  for (int step = 0; step < o.warmup + o.steps; ++step)
    for (size_t i = 0; i < simulations.size(); ++i) {
      Simulation& simulation = simulations[i];
      simulation.setHeadPose(scene.motion(simulation.time() + simulation.parameters().time_step));
      const Clock::time_point start = Clock::now();
      simulation.step();
      simulation.guides();
      if (step >= o.warmup) ms[i].push_back(msSince(start));
    }
  for (size_t i = 0; i < simulations.size(); ++i) {
    const StrandState state = simulations[i].state();
    const auto pressed = std::count_if(state.contacts.begin(), state.contacts.end(),
                                       [](const Vec3& force) { return force.squaredNorm() > 0; });
    out[i] = {median(ms[i]), simulations[i].measure(), stateHash(state), static_cast<size_t>(pressed)};
  }
}

int run(const Options& o) {
  SceneOptions make;
  make.strands = o.strands;
  make.vertices = o.vertices;
  Scene scene = makeScene(make);
  std::vector<RigidBody> bodies;
  Bake bake = bakeInto(scene.body, o, &bodies);
  bake.mesh = "procedural body";
  bodies.push_back({fivePrimitives(scene.head_pivot), true});
  std::vector<Bake> bakes{bake};
  if (!o.body.empty()) {
    GroomReadOptions read;
    read.unit_meters = o.unit_meters;
    bakes.push_back(bakeInto(loadMesh(o.body, read), o, nullptr));
    bakes.back().mesh = std::filesystem::path(o.body).filename().string();
  }

  Parameters parameters = scene.parameters;
  parameters.solver = SolverKind::kRod;
  parameters.substeps = o.substeps;
  const auto backend = [&] {
    return createBackend(knownBackends(), o.backend, o.threads, parameters.solver);
  };
  std::vector<double> broad_ms;
  std::vector<Simulation> simulations;
  simulations.emplace_back(sceneModel(scene), std::vector<RigidBody>(), parameters, backend());
  simulations.emplace_back(sceneModel(scene), bodies, parameters, backend(), nullptr,
                           std::make_unique<TimedBroadPhase>(broad_ms));
  Timing timings[2];
  timeSteps(o, scene, simulations, timings);
  const double broad =
      median({broad_ms.end() - std::min<long>(o.steps, static_cast<long>(broad_ms.size())), broad_ms.end()});
  const double per = 1e6 / (static_cast<double>(simulations[0].model().vertices()) * o.substeps);
  const double ratio = timings[1].ms / timings[0].ms;

  nlohmann::json results = nlohmann::json::array(), baked = nlohmann::json::array();
  const char* names[] = {"no body", "mesh and five primitives"};
  if (!o.json)
    fmt::print("{} x {}, {} substeps, {}\n  {:<26} {:>9} {:>11} {:>9} {:>9}\n", o.strands, o.vertices,
               o.substeps, simulations[0].backend().device(), "case", "ms", "ns/vtx/sub", "pressed",
               "depth mm");
  for (int i = 0; i < 2; ++i) {
    const Timing& t = timings[i];
    if (!o.json)
      fmt::print("  {:<26} {:>9.3f} {:>11.2f} {:>9} {:>9.3f}\n", names[i], t.ms, per * t.ms, t.pressed,
                 1000 * t.measured.max_penetration);
    results.push_back({{"case", names[i]},
                       {"ms_median", t.ms},
                       {"ns_per_vertex_substep", per * t.ms},
                       {"vertices_pressed", t.pressed},
                       {"max_penetration_m", t.measured.max_penetration},
                       {"non_finite", t.measured.non_finite},
                       {"state_hash", fmt::format("{:016x}", t.hash)}});
  }
  if (!o.json) fmt::print("  ratio {:.2f}, of it the broad phase {:.3f} ms\n", ratio, broad);
  for (const Bake& b : bakes) {
    if (!o.json)
      fmt::print(
          "  field of {}: {} triangles, cells of {:.2f} mm: {:.2f} s, {:.1f} MB, {:.1f} MB besides while "
          "baking\n",
          b.mesh, b.triangles, 1e3 * b.cell, b.seconds, 1e-6 * static_cast<double>(b.field_bytes),
          1e-6 * static_cast<double>(b.working_bytes));
    baked.push_back({{"mesh", b.mesh},
                     {"triangles", b.triangles},
                     {"cell_m", b.cell},
                     {"seconds", b.seconds},
                     {"field_bytes", b.field_bytes},
                     {"working_bytes", b.working_bytes}});
  }
  if (o.json)
    fmt::print("{}\n",
               nlohmann::json(
                   {{"name", "contact"},
                    {"backend", simulations[0].backend().name()},
                    {"device", simulations[0].backend().device()},
                    {"threads", o.threads},
                    {"params", {{"strands", o.strands}, {"vertices", o.vertices}, {"substeps", o.substeps}}},
                    {"ratio", ratio},
                    {"ms_broad_phase", broad},
                    {"results", results},
                    {"bakes", baked}})
                   .dump());
  return 0;
}

}  // namespace

std::function<int()> addContactBench(CLI::App& app) {
  const auto o = std::make_shared<Options>();
  app.add_option("--backend", o->backend, "auto, gpu, simd or reference")
      ->check(CLI::IsMember({"auto", "gpu", "simd", "reference"}))
      ->capture_default_str();
  app.add_option("--body", o->body, "mesh file (.obj, .gltf, .glb) whose bake is timed too");
  app.add_option("--unit-meters", o->unit_meters, "metres per unit of that file")
      ->check(CLI::Range(1e-6, 1000.0))
      ->capture_default_str();
  app.add_option("--cell", o->cell, "m, edge of a cell of the fields")
      ->check(CLI::Range(1e-6, 1000.0))
      ->capture_default_str();
  app.add_option("--strands", o->strands)->check(CLI::Range(1, 1000000))->capture_default_str();
  app.add_option("--vertices", o->vertices, "per strand")->check(CLI::Range(2, 128))->capture_default_str();
  app.add_option("--substeps", o->substeps)->check(CLI::Range(1, 64))->capture_default_str();
  app.add_option("--threads", o->threads, "of the simd backend and of bakes; 0 = all")
      ->check(CLI::Range(0, 1024));
  app.add_option("--steps", o->steps, "steps timed, after a warm-up; medians are given")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  app.add_flag("--json", o->json, "print one JSON object");
  return [o] { return run(*o); };
}

}  // namespace strandcast
