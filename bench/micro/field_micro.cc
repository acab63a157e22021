// Samples a distance field at points near the surface, and at points all around it.
#include <benchmark/benchmark.h>

#include <random>

#include "bench/bench_scene.h"

namespace strandcast {
namespace {

const TriangleMesh& body() {
  static const TriangleMesh made = benchScene("straight", 1, 8).body;
  return made;
}

const DistanceField& field() {
  static const auto made = [] {
    ContactPrimitive shape;
    bakeField(body(), 0.008f, 0, shape);
    return shape.field;
  }();
  return *made;
}

std::vector<Vec3> points(float spread) {
  std::mt19937 random(1);
  std::normal_distribution<float> normal;
  std::vector<Vec3> out;
  for (int i = 0; i < 4096; ++i) {
    const Vec3& on = body().positions[random() % body().positions.size()];
    out.emplace_back(on + spread * Vec3(normal(random), normal(random), normal(random)));
  }
  return out;
}

void fieldSample(benchmark::State& state, float spread) {
  const DistanceField& in = field();
  const std::vector<Vec3> at = points(spread);
  for (auto _ : state)
    for (const Vec3& point : at) benchmark::DoNotOptimize(in.at(point));
  state.SetItemsProcessed(state.iterations() * static_cast<int64_t>(at.size()));
}
BENCHMARK_CAPTURE(fieldSample, near_the_surface, 0.003f);
BENCHMARK_CAPTURE(fieldSample, anywhere, 0.1f);

}  // namespace
}  // namespace strandcast
