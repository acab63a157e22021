#include "bench/measured_run.h"

#include <fmt/format.h>
#include <time.h>

#include <algorithm>
#include <chrono>

#include "bench/counted_memory.h"

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

}  // namespace strandcast
