// Steps one block of strands, for each instruction set of this machine.
#include <benchmark/benchmark.h>

#include <map>

#include "bench/bench_scene.h"
#include "core/strand_block.h"
#include "simd/simd_kernels.h"

namespace strandcast {
namespace {

/// Sixteen curly strands, the largest number of lanes; made once.
const Scene& sceneOf(int vertices) {
  static std::map<int, Scene> made;
  const auto [place, is_new] = made.try_emplace(vertices);
  if (is_new) place->second = benchScene("curly", 16, vertices);
  return place->second;
}

void stepOfBlock(benchmark::State& state, const simd::SimdTarget& target, SolverKind solver) {
  const int vertices = static_cast<int>(state.range(0));
  const Scene& scene = sceneOf(vertices);
  const StrandModel model = sceneModel(scene);
  BlockStore<float> store;
  store.load(model, target.kernel.lanes);
  store.upload(restState(model, model.rest_roots));
  const std::vector<float, CacheLineAllocator<float>> room(blockScratch(store.maxVertices(), store.lanes()));
  auto scratch = room;
  Parameters parameters = scene.parameters;
  parameters.solver = solver;
  const StepInput input{&parameters};
  store.prepare(parameters, false);
  for (auto _ : state) {
    target.kernel.step_block(store.block(0, input, scratch.data()), input, scratch.data());
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * vertices * target.kernel.lanes * parameters.substeps);
}

const bool is_registered = [] {
  static const std::vector<simd::SimdTarget> targets = simd::runnableTargets();
  for (const simd::SimdTarget& target : targets)
    for (const SolverKind solver : {SolverKind::kRod, SolverKind::kGaussSeidel})
      benchmark::RegisterBenchmark(
          (solverName(solver) + "_block/" + target.name).c_str(),
          [&target, solver](benchmark::State& state) { stepOfBlock(state, target, solver); })
          ->Arg(16)
          ->Arg(32)
          ->Arg(128);
  return true;
}();

}  // namespace
}  // namespace strandcast
