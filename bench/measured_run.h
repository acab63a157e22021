#pragma once
#include <functional>
#include <optional>
#include <vector>

#include "bench/table.h"
#include "core/simulation.h"

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
