// Micro-benchmarks of hot functions, by Google Benchmark: --benchmark_filter=codec, --benchmark_format=csv.
// Each result is of one thread and counts vertices, samples or points per second.
#include <benchmark/benchmark.h>

#include <map>
#include <random>

#include "air/hair_grid.h"
#include "bench/bench_simulation.h"
#include "bench/machine.h"
#include "core/sag_free.h"
#include "core/strand_block.h"
#include "simd/simd_backend.h"
#include "simd/simd_kernels.h"
#include "transport/codec/guide_decoder.h"
#include "transport/codec/guide_encoder.h"

namespace strandcast {
namespace {

// Encodes and decodes a frame of moving guides, for each codec, on one thread.

struct Film {
  StrandSet guides;
  std::vector<GuideFrame> frames;
};

const Film& film() {
  static const Film made = [] {
    const Scene scene = benchScene("wavy", 5000, 32);
    Parameters parameters = scene.parameters;
    parameters.solver = SolverKind::kRod;
    Simulation simulation(sceneModel(scene), {}, parameters, makeSimdBackend(1));
    Film out;
    out.guides = scene.groom.strands;
    for (int step = 0; step < 38; ++step) {
      simulation.setHeadPose(scene.motion(simulation.time() + parameters.time_step));
      simulation.step();
      if (step < 30) continue;
      GuideFrame frame;
      frame.head = simulation.headPose();
      frame.positions.assign(simulation.guides().begin(), simulation.guides().end());
      out.frames.push_back(std::move(frame));
    }
    return out;
  }();
  return made;
}

/// Plays the film forwards and backwards, so that no frame jumps.
const GuideFrame& frameAt(uint64_t number, GuideFrame& frame) {
  const size_t last = film().frames.size() - 1, place = number % (2 * last);
  frame = film().frames[place <= last ? place : 2 * last - place];
  frame.frame = number;
  return frame;
}

std::vector<GuideChunk> encoded(GuideEncoder& encoder, const GuideFrame& frame) {
  std::vector<GuideChunk> chunks(encoder.runs().size());
  for (uint32_t i = 0; i < chunks.size(); ++i) {
    fillGuideHeader(frame, encoder.runs(), i, chunks[i]);
    encoder.encode(frame, i, chunks[i]);
  }
  return chunks;
}

void encode(benchmark::State& state, Codec codec) {
  GuideEncoder encoder({codec});
  encoder.setGroom(film().guides);
  GuideFrame frame;
  std::vector<GuideChunk> chunks(encoder.runs().size());
  for (uint64_t number = 1; auto _ : state) {
    state.PauseTiming();
    frameAt(number++, frame);
    state.ResumeTiming();
    for (uint32_t i = 0; i < chunks.size(); ++i) {
      fillGuideHeader(frame, encoder.runs(), i, chunks[i]);
      encoder.encode(frame, i, chunks[i]);
    }
  }
  const auto vertices = static_cast<int64_t>(film().guides.vertices());
  state.SetItemsProcessed(state.iterations() * vertices);
  state.counters["bytes_per_vertex"] =
      static_cast<double>(encoder.report().frame_bytes) / static_cast<double>(vertices);
}

void decode(benchmark::State& state, Codec codec) {
  GuideEncoder encoder({codec});
  encoder.setGroom(film().guides);
  GuideDecoder decoder;
  decoder.setGroom(film().guides);
  std::vector<Vec3> positions(film().guides.vertices());
  GuideFrame frame;
  for (uint64_t number = 1; auto _ : state) {
    state.PauseTiming();
    const std::vector<GuideChunk> chunks = encoded(encoder, frameAt(number++, frame));
    state.ResumeTiming();
    for (const GuideChunk& chunk : chunks)
      if (decoder.decode(chunk, std::span(positions).subspan(chunk.first_vertex, chunk.vertex_count)) !=
          DecodeResult::kDone)
        state.SkipWithError("a chunk is not decoded");
  }
  state.SetItemsProcessed(state.iterations() * static_cast<int64_t>(positions.size()));
}

const bool codecs_are_registered = [] {
  for (const CodecInfo& info : codecList()) {
    const Codec codec = info.codec;
    benchmark::RegisterBenchmark((std::string("codec_encode/") + info.name).c_str(),
                                 [codec](benchmark::State& state) { encode(state, codec); });
    benchmark::RegisterBenchmark((std::string("codec_decode/") + info.name).c_str(),
                                 [codec](benchmark::State& state) { decode(state, codec); });
  }
  return true;
}();

// Samples a distance field at points near the surface, and at points all around it.

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

// Steps one block of strands, for each instruction set of this machine.

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

const bool blocks_are_registered = [] {
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

// The sag-free computation, which a daemon does once before the first step.

void sagFreeStart(benchmark::State& state, const char* name) {
  static std::map<std::string, StrandModel> models;
  const auto [place, is_new] = models.try_emplace(name);
  if (is_new) place->second = sceneModel(benchScene(name, 200, 32));
  const StrandModel& made = place->second;
  for (auto _ : state) {
    state.PauseTiming();
    StrandModel model = made;
    state.ResumeTiming();
    benchmark::DoNotOptimize(makeSagFree(model, Parameters().gravity).largest_factor);
  }
  state.SetItemsProcessed(state.iterations() * static_cast<int64_t>(made.vertices()));
}
BENCHMARK_CAPTURE(sagFreeStart, straight, "straight");
BENCHMARK_CAPTURE(sagFreeStart, curly, "curly");

// Splats hair onto the grid of forces between hairs, for each backend, on one thread.

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

int main(int argc, char** argv) {
  benchmark::AddCustomContext("commit", strandcast::buildCommit());
  benchmark::AddCustomContext("machine", strandcast::describe(strandcast::thisMachine()));
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
}
