#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <memory>
#include <optional>
#include <thread>

#include "bench/bench_simulation.h"
#include "bench/machine.h"
#include "bench/verbs.h"
#include "collision/tree_broad_phase.h"
#include "core/backend.h"
#include "core/error.h"
#include "core/strand_block.h"
#include "gpu_compute/gpu_air.h"
#include "options/number_range.h"
#include "service/scene_simulation.h"
#include "simd/simd_backend.h"

namespace strandcast {
namespace kernels::counting {
// Each header depends on those before it.
// clang-format off
// Lane vocabulary over one float that counts operations: additions, multiplications, divisions and roots count one
// each, a fused multiply-add two. Comparisons, selections, rounding and moves are not counted.
using Scalar = float;
constexpr int kLanes = 1;
using mask = bool;
struct real {
  float v;
};
inline uint64_t operations = 0, operations_of[kStepParts] = {};
inline StepPart part_now = StepPart::kOther;

// Shadows the StepScope of core/strand_block.h, which does nothing.
class StepScope {
 public:
  explicit StepScope(StepPart part) : around_(part_now) { part_now = part; }
  ~StepScope() { part_now = around_; }
  StepScope(const StepScope&) = delete;
  StepScope& operator=(const StepScope&) = delete;

 private:
  StepPart around_;
};

inline real counted(float value, int count = 1) {
  operations += count;
  operations_of[static_cast<int>(part_now)] += count;
  return {value};
}
inline real lit(double value) { return {static_cast<float>(value)}; }
inline real operator+(real a, real b) { return counted(a.v + b.v); }
inline real operator-(real a, real b) { return counted(a.v - b.v); }
inline real operator-(real a) { return counted(-a.v); }
inline real operator*(real a, real b) { return counted(a.v * b.v); }
inline real operator/(real a, real b) { return counted(a.v / b.v); }
inline real madd(real a, real b, real c) { return counted(std::fma(a.v, b.v, c.v), 2); }
inline real sqrt(real a) { return counted(std::sqrt(a.v)); }
inline real inverse(real a) { return counted(1 / a.v); }
inline real inverseSqrt(real a) { return counted(1 / std::sqrt(a.v)); }
inline real floor(real a) { return {std::floor(a.v)}; }
inline real abs(real a) { return {std::fabs(a.v)}; }
inline real min(real a, real b) { return a.v < b.v ? a : b; }
inline real max(real a, real b) { return a.v > b.v ? a : b; }
inline mask operator<(real a, real b) { return a.v < b.v; }
inline mask operator>(real a, real b) { return a.v > b.v; }
inline mask operator<=(real a, real b) { return a.v <= b.v; }
inline mask operator>=(real a, real b) { return a.v >= b.v; }
inline mask maskAll() { return true; }
inline mask maskNone() { return false; }
inline real select(mask m, real a, real b) { return m ? a : b; }
inline real load(const Scalar* p) { return {*p}; }
inline void store(real value, Scalar* p) { *p = value.v; }
inline bool anyTrue(mask m) { return m; }
inline uint32_t laneBits(mask m) { return m ? 1 : 0; }
inline Scalar reduceMin(real value) { return value.v; }
inline void storeAsInt(real value, uint32_t* p) { *p = static_cast<uint32_t>(value.v); }
struct Packing {
  mask lanes;
};
inline Packing packing(mask m) { return {m}; }
inline void compressStore(real value, Packing packing, Scalar* p) {
  if (packing.lanes) *p = value.v;
}
inline mask firstLanes(int count) { return count > 0; }
inline real laneNumbers() { return {0}; }
using word = int32_t;
inline word splat(int32_t value) { return value; }
inline word toInt(real value) { return static_cast<word>(value.v); }
inline real realOf(word value) { return {static_cast<float>(value)}; }
inline real floatOf(word bits) { return {std::bit_cast<float>(bits)}; }
inline word select(mask m, word a, word b) { return m ? a : b; }
inline word shiftedDown(word a, word bits) { return a >> bits; }
inline word wordAt(const uint32_t* words, word number) { return static_cast<word>(words[number]); }
inline word wordAtByte(const uint32_t* words, word byte) {
  word found;
  std::memcpy(&found, reinterpret_cast<const char*>(words) + byte, sizeof found);
  return found;
}
inline real lowHalves(word words) { return {static_cast<float>(static_cast<int16_t>(words))}; }
inline real highHalves(word words) { return {static_cast<float>(words >> 16)}; }

#include "kernels/lanes_vector.inl"
#include "kernels/rotation.h"
#include "kernels/strand.h"
#include "kernels/contact.h"
#include "kernels/distance_field.h"
#include "kernels/rod.h"
#include "kernels/stiff_tensions.h"
#include "kernels/end_lanes.inl"
#include "core/block_step.inl"
// clang-format on
}  // namespace kernels::counting

/// Floating-point operations of a step, per vertex and substep.
struct OperationCount {
  double all = 0;
  std::array<double, kStepParts> parts{};  ///< indexed by StepPart; sums to `all`
};
/// Counts the operations by running the source of the CPU step with a counting number type, on about a
/// thousand strands, evenly chosen.
OperationCount countOperations(const StrandModel& model, const StrandState& state, const StepInput& input) {
  BlockStore<float> store;
  store.load(model, 1);
  store.prepare(*input.parameters, !input.primitives.empty());
  store.upload(state);
  std::vector<float> scratch(blockScratch(store.maxVertices(), 1));
  const size_t apart = 1 + store.blocks() / 1024;
  kernels::counting::operations = 0;
  std::ranges::fill(kernels::counting::operations_of, 0);
  size_t vertices = 0;
  for (size_t b = 0; b < store.blocks(); b += apart) {
    const BlockView<float> block = store.block(b, input, scratch.data());
    kernels::counting::stepBlock(block, input, scratch.data());
    vertices += static_cast<size_t>(block.vertices);
  }
  const double times = static_cast<double>(vertices) * input.parameters->substeps;
  OperationCount out;
  out.all = static_cast<double>(kernels::counting::operations) / times;
  for (size_t part = 0; part < kStepParts; ++part)
    out.parts[part] = static_cast<double>(kernels::counting::operations_of[part]) / times;
  return out;
}

/// A part's name in tables.
const char* nameOf(StepPart part) {
  switch (part) {
    case StepPart::kOther:
      return "other";
    case StepPart::kPredict:
      return "predict";
    case StepPart::kTwist:
      return "twist";
    case StepPart::kBend:
      return "bend";
    case StepPart::kMove:
      return "move";
    case StepPart::kTensions:
      return "tensions";
    case StepPart::kSecondLengthPass:
      return "second_length_pass";
    case StepPart::kVelocities:
      return "velocities";
    case StepPart::kContact:
      return "contact";
  }
  return "";
}

namespace {

struct StepOptions {
  std::string backend = "auto", target, scene = "straight", solver = "rod", bodies = "none", rest = "groom";
  int strands = 2000, vertices = 32, substeps = 4, iterations = 6, threads = 0, warmup = 20, steps = 60;
  int air = 0;  // cells per axis; 0 = none
  double shake = 0;
  uint64_t seed = 1;
  std::optional<float> damping_time;  // s
  bool operations = false;
  std::vector<std::string> hair = {"plain"};
  PrintOptions print;
};

std::vector<RigidBody> bodiesOf(const StepOptions& o, const Scene& scene) {
  if (o.bodies == "none") return {};
  if (o.bodies == "scene") return scene.bodies;
  if (o.bodies == "mesh") {
    ContactPrimitive field;
    bakeField(scene.body, 0.002f, o.threads, field);
    return {{{field}, true, true}, {fivePrimitives(scene.head_pivot), true}};
  }
  ContactPrimitive head;  // a sphere that the hair lies on
  head.a = scene.head_pivot + Vec3(0, 0.08f, 0);
  head.radius = 0.06f;
  return {{{head}, true}};
}

// Makes every strand straight along its first edge.
void straighten(StrandSet& strands) {
  for (size_t s = 0; s < strands.strands(); ++s) {
    const std::span<Vec3> points = strands.strand(s);
    const Vec3 edge = points[1] - points[0];
    Vec3 before = points[0];
    for (size_t i = 1; i < points.size(); ++i) {
      const float length = (points[i] - before).norm();
      before = points[i];
      points[i] = points[i - 1] + length * edge.normalized();
    }
  }
}

/// The kind of hair of a row.
struct HairKind {
  const char *name, *help;
};
constexpr HairKind kHairKinds[] = {
    {"plain", "uniform edges and masses, one material, the scene's damping"},
    {"undamped", "the same without internal damping"},
    {"tapered", "plain, 0.4 x as thick at the tip"},
    {"uneven", "plain, edges alternately 2/3 and 4/3 as long"},
    {"curves", "plain, density, air drag, damping and friction falling to half from root to tip"},
};

// Moves every other vertex towards the one before it, by a third of the edge.
void makeUneven(StrandSet& strands) {
  for (size_t s = 0; s < strands.strands(); ++s) {
    const std::span<Vec3> points = strands.strand(s);
    for (size_t i = 1; i + 1 < points.size(); i += 2) points[i] -= (points[i] - points[i - 1]) / 3;
  }
}

/// The scene with the given kind of hair, and its parameters.
Scene sceneOf(const Scene& plain, const std::string& hair) {
  Scene scene = plain;
  const RootTipCurve half{{{0.0f, 1.0f}, {1.0f, 0.5f}}};
  if (hair == "undamped") scene.parameters.damping_time = 0;
  if (hair == "uneven") makeUneven(scene.groom.strands);
  for (Material& material : scene.materials) {
    if (hair == "tapered") material.radius_scale.knots = {{0.0f, 1.0f}, {1.0f, 0.4f}};
    if (hair == "curves")
      material.density_scale = material.air_drag_scale = material.damping_curve = material.friction_curve =
          half;
  }
  return scene;
}

std::unique_ptr<Backend> backendOf(const StepOptions& o, const std::string& name, SolverKind solver) {
  if (o.target.empty()) return createBackend(knownBackends(), name, o.threads, solver);
  if (name != "simd")
    throw Error("--target applies only to the simd backend", "--target " + o.target, "add --backend simd");
  return makeSimdBackend(o.threads, o.target);
}

/// Adds the fractions of the machine's measured limits that the step reached to its row.
void addFractions(nlohmann::json& row, const StepOptions& o, const MeasuredRun& result, double operations) {
  const bool on_gpu = result.backend == "gpu";
  // A GPU's step is timed by its own clock, which excludes the read-back of guides.
  const double seconds = 1e-3 * result.gpu_ms.value_or(result.ms.median);
  // The minimum traffic of any solver: a step reads and writes all positions and velocities once.
  const double bytes = 2 * 2 * sizeof(Vec3) * static_cast<double>(result.vertices);
  double peak = 0, copy = 0;  // per second
  if (on_gpu) {
    const GpuLimits limits = measuredGpuLimits();
    peak = limits.operations_per_s;
    copy = limits.copied_bytes_per_s;
  } else {
    const int all = static_cast<int>(std::thread::hardware_concurrency());
    const int threads = result.backend == "reference" ? 1 : o.threads > 0 ? o.threads : all;
    copy = measuredCopy(threads);
    // The measured peak is that of the widest vectors.
    if (o.target.empty()) {
      peak = measuredPeak(threads);
      row["fraction_of_peak_cpu"] = operations / (1e-3 * result.cpu_ms.min) / measuredPeakOfProcessor();
    }
  }
  if (peak > 0)
    row.update({{"peak_operations_per_s", peak}, {"fraction_of_peak", operations / seconds / peak}});
  row.update({{"state_bytes_moved", bytes},
              {"copied_bytes_per_s", copy},
              {"fraction_of_copy", bytes / seconds / copy}});
}

/// Adds the operation counts by part of the step to the table.
void addParts(Table& parts, const std::string& backend, const std::string& hair,
              const OperationCount& operations) {
  for (int p = 0; p < kStepParts; ++p) {
    const double own = operations.parts[static_cast<size_t>(p)];
    if (own > 0)
      parts.add({{"case", backend},
                 {"hair", hair},
                 {"part", nameOf(static_cast<StepPart>(p))},
                 {"per_vertex_substep", own},
                 {"share", own / operations.all}});
  }
}

/// Measures one row; adds the parts of its step to `parts`.
nlohmann::json run(const StepOptions& o, const Scene& plain, const std::string& hair, const std::string& name,
                   Table& parts) {
  const Scene scene = sceneOf(plain, hair);
  Parameters parameters = scene.parameters;
  parameters.substeps = o.substeps;
  parameters.iterations = o.iterations;
  parameters.solver = solverKind(o.solver);
  if (o.damping_time && hair != "undamped") parameters.damping_time = *o.damping_time;
  if (o.air > 0) addAir(parameters, o.air);
  const std::vector<RigidBody> bodies = bodiesOf(o, scene);
  const auto make = [&] {
    std::unique_ptr<Backend> backend = backendOf(o, name, parameters.solver);
    std::unique_ptr<ExternalForces> air = o.air > 0 ? airOf(backend->name(), o.threads).make({}) : nullptr;
    return Simulation(sceneModel(scene), bodies, parameters, std::move(backend), std::move(air),
                      makeTreeBroadPhase());
  };
  TimedSimulation timed(make, benchMotion(scene, o.shake), o.steps);
  for (int step = 1; step < o.warmup; ++step) timed.step(false);
  auto* passes = dynamic_cast<MeasuredPasses*>(timed.simulation().externalForces());
  if (passes != nullptr) passes->measure(false, o.steps);
  for (int step = 0; step < o.steps; ++step) timed.step(true);
  const MeasuredRun result = timed.result();

  Simulation& simulation = timed.simulation();
  const OperationCount operations =
      countOperations(simulation.model(), simulation.state(), simulation.nextInput());
  addParts(parts, result.backend, hair, operations);
  nlohmann::json row = cellsOf(result);
  row.update({{"case", result.backend},
              {"solver", o.solver},
              {"scene", o.scene},
              {"rest", o.rest},
              {"hair", hair},
              {"bodies", o.bodies},
              {"air_cells", o.air},
              {"strands", o.strands},
              {"vertices", o.vertices},
              {"substeps", o.substeps},
              {"operations_per_vertex_substep", operations.all}});
  if (parameters.solver == SolverKind::kGaussSeidel)
    row["iterations"] = o.iterations;
  else
    row["damping_s"] = parameters.damping_time;
  addFractions(row, o, result, operations.all * static_cast<double>(result.vertices) * o.substeps);
  if (passes != nullptr) {
    std::vector<double> ms;
    for (const auto& [pass, time] : passes->drainTimes()) ms.push_back(time);
    if (!ms.empty()) row["air_gpu_ms"] = spreadOf(ms).median;
  }
  return row;
}

int step(const StepOptions& o) {
  Scene scene = benchScene(o.scene, o.strands, o.vertices, o.seed);
  if (o.rest == "straight") straighten(scene.groom.strands);
  Bench bench;
  bench.name = "step";
  bench.params = {{"scene", o.scene},       {"rest", o.rest},
                  {"solver", o.solver},     {"bodies", o.bodies},
                  {"air_cells", o.air},     {"shake_hz", o.shake},
                  {"strands", o.strands},   {"vertices", o.vertices},
                  {"substeps", o.substeps}, {"iterations", o.iterations},
                  {"seed", o.seed},         {"instruction_set", o.target},
                  {"hair", o.hair}};
  bench.more = {{"backend", o.backend}, {"threads", o.threads}};
  bench.heading = fmt::format("scene {}, bodies {}, {} x {}, {} substeps, {} iterations, solver {}\n",
                              o.scene, o.bodies, o.strands, o.vertices, o.substeps, o.iterations, o.solver);
  bench.table = Table(columnsOf({{{"case", "backend"},
                                  {"solver"},
                                  {"scene"},
                                  {"rest"},
                                  {"hair"},
                                  {"damping_s", "damping s"},
                                  {"bodies"},
                                  {"air_cells"},
                                  {"strands"},
                                  {"vertices"},
                                  {"substeps"},
                                  {"iterations"}},
                                 runColumns(),
                                 {{"air_gpu_ms"},
                                  {"operations_per_vertex_substep"},
                                  {"fraction_of_peak", "of peak", "{:.3f}"},
                                  {"fraction_of_peak_cpu", "cpu", "{:.3f}"},
                                  {"peak_operations_per_s", "peak op/s", "{:.3g}"},
                                  {"state_bytes_moved", "B moved"},
                                  {"fraction_of_copy", "of copy", "{:.3f}"},
                                  {"copied_bytes_per_s", "copy B/s", "{:.3g}"}}}));
  Table parts({{"case", "backend"},
               {"hair"},
               {"part", "part"},
               {"per_vertex_substep", "operations", "{:.1f}"},
               {"share", "of all", "{:.3f}"}});
  for (const BackendInfo& info : knownBackends()) {
    if (o.backend != "all" && o.backend != info.name && o.backend != "auto") continue;
    const bool runs = info.available && std::find(info.solvers.begin(), info.solvers.end(),
                                                  solverKind(o.solver)) != info.solvers.end();
    if (!runs && o.backend == "all") continue;
    for (const std::string& hair : o.hair)
      bench.table.add(run(o, scene, hair, o.backend == "auto" ? "auto" : info.name, parts));
    if (o.backend == "auto") break;
  }
  if (o.operations) {
    bench.more["operations"] = parts.json();
    bench.closing = "operations per vertex and substep, by part of the step\n" + parts.text();
    for (const nlohmann::json& row : parts.rows())
      bench.comments.push_back(fmt::format("operations of {}, {} hair, {}: {:.6g} per vertex and substep",
                                           row["case"].get<std::string>(), row["hair"].get<std::string>(),
                                           row["part"].get<std::string>(),
                                           row["per_vertex_substep"].get<double>()));
  }
  print(bench, o.print);
  return 0;
}

}  // namespace

std::function<int()> addStepBench(CLI::App& app) {
  const auto o = std::make_shared<StepOptions>();
  std::vector<std::string> hairs;
  std::string hair_help = "kinds of hair, one row each, separated by commas;";
  for (const HairKind& hair : kHairKinds) {
    hairs.emplace_back(hair.name);
    hair_help += fmt::format(" {}: {};", hair.name, hair.help);
  }
  hair_help.pop_back();
  app.footer(
      "ms:      wall time of a step and of reading its guides.\n"
      "cpu ms:  processor time of all threads of this process for the same, without other programs' load.\n"
      "gpu ms:  time of a step's dispatches alone, by the GPU's clock.\n"
      "         CSV and JSON also have the wall time of a GPU's step: submit_ms, submitting its commands "
      "and\n"
      "         uploads, and wait_ms, until its guides have been copied back.\n"
      "B/vtx:   memory of the simulation on heap and GPU, per vertex. With a software driver (llvmpipe) it\n"
      "         includes the driver's compiled programs.\n"
      "allocs:  calls of operator new during all timed steps.\n"
      "of peak: the counted operations of the step, over the rate that the same threads reach with\n"
      "         multiply-adds alone, measured (peak op/s); then the same for the least processor time. On a "
      "GPU,\n"
      "         gpu ms where available, over the rate of a shader with multiply-adds alone.\n"
      "of copy: the least bytes that the step moves, all positions and velocities read and written once\n"
      "         (B moved), over the rate at which the same threads, or the GPU, copy memory (copy B/s).\n"
      "parts:   rows of --operations. rod: predict (inertial points, tangents, frames), twist (strains, "
      "twist\n"
      "         system), bend (forces, elimination of the bending system), move (its substitution, "
      "elimination\n"
      "         of the length system), pulls (tensions: lengths substituted; dense metric and stiff "
      "tensions),\n"
      "         again (second length pass, of strands in the dense metric or near bodies), velocities "
      "(exact\n"
      "         lengths), contact, other (once per step, and roots). gauss_seidel: bend is its angular "
      "sweeps,\n"
      "         move its distances and tethers.\n"
      "Examples:\n"
      "  strandbench step --backend all\n"
      "  strandbench step --bodies mesh --operations\n"
      "  strandbench step --backend simd --hair plain,undamped,tapered,uneven,curves\n"
      "  strandbench step --strands 100000 --substeps 6 --scene curly --shake 2 --bodies mesh --air 64");
  addBackend(app, o->backend, {"auto", "gpu", "simd", "reference", "all"});
  app.add_option("--target", o->target, "instruction set of the simd backend: AVX3 (AVX-512), AVX2, SSE4");
  app.add_option("--solver", o->solver, "rod or gauss_seidel")
      ->check(CLI::IsMember({"rod", "gauss_seidel"}))
      ->capture_default_str();
  addScene(app, o->scene);
  app.add_option("--rest", o->rest,
                 "rest shape. groom: the scene's; straight: straight along the roots' directions")
      ->check(CLI::IsMember({"groom", "straight"}))
      ->capture_default_str();
  app.add_option("--hair", o->hair, hair_help)
      ->delimiter(',')
      ->check(CLI::IsMember(hairs))
      ->capture_default_str();
  app.add_option("--shake", o->shake, "frequency at which the head is shaken, Hz; 0 = the scene's own motion")
      ->check(finiteRange(0.0, 10.0))
      ->capture_default_str();
  app.add_option("--bodies", o->bodies,
                 "bodies. none; sphere: one sphere with friction, in the head; scene: all bodies of the "
                 "scene; mesh: the distance field of the scene's body and five primitives")
      ->check(CLI::IsMember({"none", "sphere", "scene", "mesh"}))
      ->capture_default_str();
  app.add_option("--air", o->air,
                 "cells per axis of the grids of wind and of forces between hairs, 16 to 128; 0 = no grids")
      ->check(CLI::Range(0, 128))
      ->capture_default_str();
  addStrands(app, o->strands);
  addVertices(app, o->vertices);
  addSubsteps(app, o->substeps);
  app.add_option("--iterations", o->iterations)->check(CLI::Range(1, 64))->capture_default_str();
  app.add_option("--damping", o->damping_time, "internal damping time of the rod, s; default: the scene's")
      ->check(finiteRange(0.0, 1.0));
  addThreads(app, o->threads);
  addSteps(app, o->steps);
  app.add_flag("--operations", o->operations,
               "also print the floating-point operations of each part of the step, per vertex and substep, "
               "counted by running the step's source with a counting number type; for a GPU they are the "
               "operations of the CPU code");
  addSeed(app, o->seed);
  addPrintOptions(app, o->print);
  return [o] { return step(*o); };
}

}  // namespace strandcast
