#pragma once
#include <functional>
#include <optional>
#include <vector>

#include "bench/table.h"
#include "core/simulation.h"

namespace strandcast {

/// Of repeated measurements.
struct Spread {
  double min = 0, median = 0, p95 = 0;
};
/// Of at least one value.
Spread spreadOf(std::vector<double> values);

/// Processor time that this program has taken so far, ms, all threads.
double processorMs();

/// How long the steps of a simulation took, in what memory, and what they computed.
struct MeasuredRun {
  std::string backend, device;
  int substeps = 0;
  size_t strands = 0, vertices = 0;
  Spread ms;      ///< of a step and of reading its guides, by the wall
  Spread cpu_ms;  ///< the same in processor time of all threads of this program
  /// Medians: of giving the step's commands with what it is told, and of waiting for the guides, which a GPU
  /// works out and copies back meanwhile. A CPU has done all when the first is over.
  double submit_ms = 0, wait_ms = 0;
  std::optional<double> gpu_ms;  ///< of a step's dispatches alone, median
  size_t heap_bytes = 0;         ///< that the simulation and all it is made of take after its first step,
  size_t gpu_bytes = 0;          ///< and its buffers on the GPU
  uint64_t allocations = 0;      ///< during the steps that were timed
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
  /// `make` makes all that the simulation keeps, so that its memory can be told.
  TimedSimulation(const std::function<Simulation()>& make, Motion motion, int steps);
  /// Takes the next step and reads its guides.
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

/// Warms up, times `steps` steps.
MeasuredRun measureSteps(const std::function<Simulation()>& make, const TimedSimulation::Motion& motion,
                         int warmup, int steps);

/// What every run of a simulation states, as columns and as the cells for them.
std::vector<Column> runColumns();
nlohmann::json cellsOf(const MeasuredRun& run);
/// One list of columns of several.
std::vector<Column> columnsOf(std::initializer_list<std::vector<Column>> parts);

}  // namespace strandcast
