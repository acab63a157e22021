// Splats hair onto the grid of forces between hairs, for each backend, on one thread.
#include <benchmark/benchmark.h>

#include "air/hair_grid.h"
#include "bench/bench_scene.h"

namespace strandcast {
namespace {

void splat(benchmark::State& state, const char* backend) {
  static const StrandModel model = sceneModel(benchScene("curly", 1000, 32));
  const Workers workers(1);
  HairGrid<float> grid(passesOf(backend), workers, model, static_cast<int>(state.range(0)), restBox(model));
  const StrandState rest = restState(model, model.rest_roots);
  for (auto _ : state) {
    grid.locate(rest.positions, rest.velocities, Pose{});
    grid.splat();
  }
  benchmark::DoNotOptimize(grid.splatHash());
  state.SetItemsProcessed(state.iterations() * static_cast<int64_t>(model.vertices()));
}
BENCHMARK_CAPTURE(splat, simd, "simd")->Arg(32)->Arg(64);
BENCHMARK_CAPTURE(splat, reference, "reference")->Arg(32);

}  // namespace
}  // namespace strandcast
