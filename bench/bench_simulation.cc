#include "bench/bench_simulation.h"

#include <fmt/format.h>
#include <time.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <chrono>
#include <memory>

#include "bench/counted_memory.h"
#include "collision/field_bake.h"

namespace strandcast {

double processorMs() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return 1e3 * static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_nsec);
}

Spread spreadOf(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return {values.front(), values[values.size() / 2],
          values[std::min(values.size() - 1, values.size() * 95 / 100)]};
}

TimedSimulation::TimedSimulation(const std::function<Simulation()>& make, Motion motion, int steps)
    : heap_before_(heapBytes()),
      gpu_before_(gpuBufferBytes()),
      simulation_(make()),
      motion_(std::move(motion)) {
  step(false);
  run_.heap_bytes = heapBytes() - heap_before_;
  run_.gpu_bytes = gpuBufferBytes() - gpu_before_;
  ms_.reserve(static_cast<size_t>(steps));
  for (std::vector<double>* times : {&cpu_ms_, &submit_ms_, &wait_ms_, &gpu_ms_})
    times->reserve(static_cast<size_t>(steps));
}

void TimedSimulation::step(bool timed) {
  const Pose head = motion_(simulation_.time() + simulation_.parameters().time_step);
  const uint64_t allocations_before = allocations();
  const double processor_before = processorMs();
  const auto start = std::chrono::steady_clock::now();
  simulation_.setHeadPose(head);
  simulation_.step();
  const auto submitted = std::chrono::steady_clock::now();
  simulation_.guides();
  const auto end = std::chrono::steady_clock::now();
  if (!timed) return;
  run_.allocations += allocations() - allocations_before;
  cpu_ms_.push_back(processorMs() - processor_before);
  using Ms = std::chrono::duration<double, std::milli>;
  ms_.push_back(Ms(end - start).count());
  submit_ms_.push_back(Ms(submitted - start).count());
  wait_ms_.push_back(Ms(end - submitted).count());
  if (const auto seconds = simulation_.backend().gpuSeconds()) gpu_ms_.push_back(1000 * *seconds);
}

MeasuredRun TimedSimulation::result() {
  MeasuredRun run = run_;
  run.backend = simulation_.backend().name();
  run.device = simulation_.backend().device();
  run.substeps = simulation_.parameters().substeps;
  run.strands = simulation_.model().strands();
  run.vertices = simulation_.model().vertices();
  run.ms = spreadOf(ms_);
  run.cpu_ms = spreadOf(cpu_ms_);
  run.submit_ms = spreadOf(submit_ms_).median;
  run.wait_ms = spreadOf(wait_ms_).median;
  if (!gpu_ms_.empty()) run.gpu_ms = spreadOf(gpu_ms_).median;
  run.measured = simulation_.measure();
  run.hash = stateHash(simulation_.state());
  return run;
}

MeasuredRun measureSteps(const std::function<Simulation()>& make, const TimedSimulation::Motion& motion,
                         int warmup, int steps) {
  TimedSimulation timed(make, motion, steps);
  for (int step = 1; step < warmup; ++step) timed.step(false);
  for (int step = 0; step < steps; ++step) timed.step(true);
  return timed.result();
}

std::vector<Column> runColumns() {
  return {{"device", "device"},
          {"ms_min", "ms min", "{:.3f}"},
          {"ms_median", "median", "{:.3f}"},
          {"ms_p95", "p95", "{:.3f}"},
          {"cpu_ms", "cpu ms", "{:.3f}"},
          {"cpu_ms_min"},
          {"submit_ms"},
          {"wait_ms"},
          {"gpu_ms", "gpu ms", "{:.4f}"},
          {"ns_per_vertex_substep", "ns/vtx/sub", "{:.2f}"},
          {"vertices_per_s", "vtx/s", "{:.3g}"},
          {"bytes", ""},
          {"gpu_bytes", ""},
          {"bytes_per_vertex", "B/vtx", "{:.0f}"},
          {"allocations", "allocs"},
          {"mean_stretch", "mean stretch", "{:.1e}"},
          {"max_stretch", "max", "{:.1e}"},
          {"max_penetration_m", "depth m", "{:.1e}"},
          {"non_finite", ""},
          {"state_hash", "hash"}};
}

nlohmann::json cellsOf(const MeasuredRun& run) {
  nlohmann::json cells{{"device", run.device},
                       {"ms_min", run.ms.min},
                       {"ms_median", run.ms.median},
                       {"ms_p95", run.ms.p95},
                       {"cpu_ms", run.cpu_ms.median},
                       {"cpu_ms_min", run.cpu_ms.min},
                       {"ns_per_vertex_substep", run.perVertexSubstep()},
                       {"vertices_per_s", 1000 * static_cast<double>(run.vertices) / run.ms.median},
                       {"bytes", run.heap_bytes + run.gpu_bytes},
                       {"gpu_bytes", run.gpu_bytes},
                       {"bytes_per_vertex", run.bytesPerVertex()},
                       {"allocations", run.allocations},
                       {"mean_stretch", run.measured.mean_stretch},
                       {"max_stretch", run.measured.max_stretch},
                       {"max_penetration_m", run.measured.max_penetration},
                       {"non_finite", run.measured.non_finite},
                       {"state_hash", fmt::format("{:016x}", run.hash)}};
  if (run.backend == "gpu") cells.update({{"submit_ms", run.submit_ms}, {"wait_ms", run.wait_ms}});
  if (run.gpu_ms) cells["gpu_ms"] = *run.gpu_ms;
  return cells;
}

std::vector<Column> columnsOf(std::initializer_list<std::vector<Column>> parts) {
  std::vector<Column> out;
  for (const std::vector<Column>& part : parts) out.insert(out.end(), part.begin(), part.end());
  return out;
}

void addPrintOptions(CLI::App& app, PrintOptions& print) {
  app.add_flag("--json", print.json, "print one JSON object");
  app.add_flag("--csv", print.csv, "print comma-separated values");
}

void addScene(CLI::App& app, std::string& scene) {
  app.add_option("--scene", scene, "procedural scene")->capture_default_str();
}
void addSeed(CLI::App& app, uint64_t& seed) {
  app.add_option("--seed", seed, "seed of the scene's hair")->capture_default_str();
}
void addStrands(CLI::App& app, int& strands, const std::string& about) {
  app.add_option("--strands", strands, about)->check(CLI::Range(1, 1000000))->capture_default_str();
}
void addVertices(CLI::App& app, int& vertices, const std::string& about) {
  app.add_option("--vertices", vertices, about)->check(CLI::Range(2, 128))->capture_default_str();
}
void addSubsteps(CLI::App& app, int& substeps, const std::string& about) {
  app.add_option("--substeps", substeps, about)->check(CLI::Range(1, 64))->capture_default_str();
}
void addThreads(CLI::App& app, int& threads, const std::string& about) {
  app.add_option("--threads", threads, about)->check(CLI::Range(0, 1024))->capture_default_str();
}
void addSteps(CLI::App& app, int& steps, const std::string& about) {
  app.add_option("--steps", steps, about)->check(CLI::Range(1, 100000))->capture_default_str();
}
void addBackend(CLI::App& app, std::string& backend, const std::vector<std::string>& names,
                const std::string& about) {
  app.add_option("--backend", backend, about)->check(CLI::IsMember(names))->capture_default_str();
}

Scene benchScene(const std::string& name, int strands, int vertices, uint64_t seed) {
  SceneOptions make;
  make.name = name;
  make.strands = strands;
  make.vertices = vertices;
  make.seed = seed;
  return makeScene(make);
}

HeadMotion benchMotion(const Scene& scene, double hertz) {
  if (hertz <= 0) return scene.motion;
  // The scenes' own shake has a frequency of 1 Hz.
  return [shake = headMotion("shake", scene.head_pivot), hertz](double seconds) {
    return shake(hertz * seconds);
  };
}

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

Bake bakeField(const TriangleMesh& mesh, float cell, int threads, ContactPrimitive& field) {
  FieldOptions options;
  options.cell = cell;
  BakeLimits limits;
  limits.threads = threads;
  const auto start = std::chrono::steady_clock::now();
  FieldBaker baker(mesh, options, limits);
  field.kind = PrimitiveKind::kField;
  field.field = std::make_shared<const DistanceField>(baker.bake());
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const DistanceField& made = *field.field;
  return {mesh.name,
          mesh.triangles.size(),
          4 * (made.index.size() + made.samples.size() + made.corners.size()),
          baker.estimate().working_bytes,
          seconds,
          baker.options().cell};
}

void addAir(Parameters& parameters, int cells, bool mac_cormack) {
  parameters.wind = Vec3(3, 0, 1);
  parameters.wind_grid = 1;
  parameters.grid_cells = cells;
  parameters.volume_stiffness = 1;
  parameters.hair_friction = 5;
  parameters.mac_cormack = mac_cormack ? 1 : 0;
}

}  // namespace strandcast
