// What a daemon does once before the first step.
#include <benchmark/benchmark.h>

#include "bench/bench_scene.h"
#include "core/sag_free.h"

namespace strandcast {
namespace {

void sagFreeStart(benchmark::State& state, const char* name) {
  const Scene scene = benchScene(name, 200, 32);
  const StrandModel made = sceneModel(scene);
  for (auto _ : state) {
    state.PauseTiming();
    StrandModel model = made;
    state.ResumeTiming();
    benchmark::DoNotOptimize(makeSagFree(model, scene.parameters.gravity).largest_factor);
  }
  state.SetItemsProcessed(state.iterations() * static_cast<int64_t>(made.vertices()));
}
BENCHMARK_CAPTURE(sagFreeStart, straight, "straight");
BENCHMARK_CAPTURE(sagFreeStart, curly, "curly");

}  // namespace
}  // namespace strandcast
