// Simulations of benchmarks: timed steps, and the scenes and options that several verbs share.
#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "bench/table.h"
#include "core/simulation.h"
#include "scenes/scene.h"

namespace strandcast {

/// Statistics of repeated measurements.
struct Spread {
  double min = 0, median = 0, p95 = 0;
};
/// Precondition: at least one value.
Spread spreadOf(std::vector<double> values);

/// Processor time of this process so far, ms, all threads.
double processorMs();

/// Times, memory and results of a simulation's timed steps.
struct MeasuredRun {
  std::string backend, device;
  int substeps = 0;
  size_t strands = 0, vertices = 0;
  Spread ms;      ///< wall time of a step and of reading its guides
  Spread cpu_ms;  ///< the same in processor time of all threads of this process
  /// Medians, ms. submit: issuing the step's commands and uploads. wait: until the guides are available,
  /// which a GPU computes and copies back meanwhile. A CPU finishes within submit.
  double submit_ms = 0, wait_ms = 0;
  std::optional<double> gpu_ms;  ///< of a step's dispatches, median, by the GPU's clock
  size_t heap_bytes = 0;     ///< of the simulation after its first step, including all that it was made of
  size_t gpu_bytes = 0;      ///< of its GPU buffers at that time
  uint64_t allocations = 0;  ///< during the timed steps
  Measurement measured;
  uint64_t hash = 0;

  double perVertexSubstep() const {  ///< ns, median
    return 1e6 * ms.median / (static_cast<double>(vertices) * substeps);
  }
  double bytesPerVertex() const {
    return static_cast<double>(heap_bytes + gpu_bytes) / static_cast<double>(vertices);
  }
};

/// A simulation whose steps are timed.
class TimedSimulation {
 public:
  using Motion = std::function<Pose(double)>;
  /// `make` must allocate all that the simulation keeps, because memory is measured around it.
  TimedSimulation(const std::function<Simulation()>& make, Motion motion, int steps);
  /// Takes the next step and reads its guides; records them where `timed`.
  void step(bool timed);
  Simulation& simulation() { return simulation_; }
  MeasuredRun result();

 private:
  size_t heap_before_, gpu_before_;
  Simulation simulation_;
  Motion motion_;
  MeasuredRun run_;
  std::vector<double> ms_, cpu_ms_, submit_ms_, wait_ms_, gpu_ms_;
};

/// Takes `warmup` untimed steps, then times `steps` steps.
MeasuredRun measureSteps(const std::function<Simulation()>& make, const TimedSimulation::Motion& motion,
                         int warmup, int steps);

/// The columns that every run of a simulation has, and the cells for them.
std::vector<Column> runColumns();
nlohmann::json cellsOf(const MeasuredRun& run);
/// Concatenates lists of columns.
std::vector<Column> columnsOf(std::initializer_list<std::vector<Column>> parts);

}  // namespace strandcast

namespace CLI {
class App;
}

namespace strandcast {

/// Declares --json and --csv.
void addPrintOptions(CLI::App& app, PrintOptions& print);

// Options shared by several verbs, each with one name, range and help. The present value is the default.
void addScene(CLI::App& app, std::string& scene);
void addSeed(CLI::App& app, uint64_t& seed);
void addStrands(CLI::App& app, int& strands, const std::string& about = "number of strands");
void addVertices(CLI::App& app, int& vertices, const std::string& about = "vertices per strand");
void addSubsteps(CLI::App& app, int& substeps, const std::string& about = "substeps per step");
void addThreads(CLI::App& app, int& threads,
                const std::string& about = "threads of the simd backend; 0 = all");
void addSteps(CLI::App& app, int& steps, const std::string& about = "timed steps, after a warm-up");
/// A backend; `names` lists those allowed.
void addBackend(CLI::App& app, std::string& backend, const std::vector<std::string>& names,
                const std::string& about = "backend that simulates");

/// A procedural scene with `strands` strands of `vertices` vertices. Throws Error.
Scene benchScene(const std::string& name, int strands, int vertices, uint64_t seed = 1);

/// A head shaken `hertz` times a second by 35 degrees to either side; 0: the scene's own motion.
HeadMotion benchMotion(const Scene& scene, double hertz);

/// The bodies in the hair of the contact benchmarks: shoulders, a comb, a hand, an ear. `pivot`: of the head,
/// m.
std::vector<ContactPrimitive> fivePrimitives(const Vec3& pivot);

/// Statistics of the bake of a body's distance field.
struct Bake {
  std::string mesh;
  size_t triangles = 0, field_bytes = 0, working_bytes = 0;
  double seconds = 0;
  float cell = 0;  ///< m
};
/// Bakes a mesh as a distance field into `field`. Throws Error.
Bake bakeField(const TriangleMesh& mesh, float cell, int threads, ContactPrimitive& field);

/// Enables all of air/ on grids of `cells` per axis: wind that hair and bodies block, and forces between
/// hairs.
void addAir(Parameters& parameters, int cells, bool mac_cormack = false);

}  // namespace strandcast
