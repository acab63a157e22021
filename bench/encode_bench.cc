#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>

#include "bench/bench_simulation.h"
#include "bench/verbs.h"
#include "core/error.h"
#include "core/hash.h"
#include "options/number_range.h"
#include "service/scene_simulation.h"
#include "transport/codec/guide_encoder.h"

namespace strandcast {
namespace {

struct EncodeOptions {
  std::string scene = "wavy", backend = "gpu";
  int strands = 100'000, vertices = 32, substeps = 4, threads = 0, warmup = 20, steps = 60;
  double shake = 1;
  uint64_t seed = 1;
  std::optional<double> most_over_gpu;  // ms
  PrintOptions print;
};

using EncodeClock = std::chrono::steady_clock;

/// Guides of a simulation; notes when they are readable by the CPU.
class TimedGuides final : public GuideSource {
 public:
  TimedGuides(Simulation& simulation, bool packs) : simulation_(simulation), packs_(packs) {}
  size_t vertices() const override { return simulation_.model().vertices(); }
  std::span<const Vec3> positions(size_t first, size_t count) override {
    const std::span<const Vec3> out = simulation_.guidesOf(first, count);
    taken += count;
    readable = EncodeClock::now();
    return out;
  }
  std::span<const PackedRun> packed(const GuideGrid& grid, const PackingFrame& frame) override {
    if (!packs_) return {};
    const std::span<const PackedRun> out = simulation_.packGuides(grid, frame);
    readable = EncodeClock::now();
    return out;
  }

  EncodeClock::time_point readable;
  size_t taken = 0;  ///< vertices taken as positions

 private:
  Simulation& simulation_;
  const bool packs_;
};

/// What encoding the steps of a simulation took and gave.
struct EncodedSteps {
  Spread wall_ms, chunks_ms, all_ms;
  std::optional<double> gpu_ms;  ///< median, the step's dispatches and those that pack
  uint64_t different = 0;        ///< frames whose bytes differ from those that the CPU makes of the positions
  uint64_t taken = 0, bytes = 0;
  double worst_error = 0;
  std::string device;
};

uint64_t hashOf(GuideEncoder& encoder, const GuideFrame& frame, GuideSource& guides) {
  ContentHash hash;
  encoder.encodeAll(frame, guides,
                    [&](const GuideChunk& chunk) { hash.add(chunk.payload.data(), chunk.payload.size()); });
  return hash.value();
}

EncodedSteps encodeSteps(const EncodeOptions& o, const Scene& scene, const std::string& backend, bool packs) {
  Parameters parameters = scene.parameters;
  parameters.substeps = o.substeps;
  Simulation simulation(sceneModel(scene), {}, parameters,
                        createBackend(knownBackends(), backend, o.threads));
  const HeadMotion motion = benchMotion(scene, o.shake);
  CodecOptions codec;
  codec.threads = o.threads;
  GuideEncoder encoder(codec), again(codec), by_processor(codec);
  for (GuideEncoder* each : {&encoder, &again, &by_processor}) each->setGroom(scene.groom.strands);

  EncodedSteps out;
  out.device = simulation.backend().device();
  std::vector<double> wall, chunks, all, gpu;
  GuideFrame frame;
  using Ms = std::chrono::duration<double, std::milli>;
  const auto advance = [&](GuideSource& guides) {
    simulation.setHeadPose(motion(simulation.time() + simulation.parameters().time_step));
    simulation.step();
    simulation.resetDiverged();
    ++frame.frame;
    frame.head = simulation.headPose();
    encoder.encodeAll(frame, guides, [](const GuideChunk&) {});
  };
  for (int step = 0; step < o.warmup + o.steps; ++step) {
    TimedGuides guides(simulation, packs);
    const auto start = EncodeClock::now();
    advance(guides);
    const auto end = EncodeClock::now();
    if (step < o.warmup) continue;
    wall.push_back(Ms(guides.readable - start).count());
    chunks.push_back(Ms(end - guides.readable).count());
    all.push_back(Ms(end - start).count());
    const std::optional<double> stepped = simulation.backend().gpuSeconds();
    const std::optional<double> packed = packs ? simulation.backend().packSeconds() : std::nullopt;
    if (stepped) gpu.push_back(1e3 * (*stepped + packed.value_or(0)));
    out.taken += guides.taken;
    out.bytes += encoder.report().frame_bytes;
    out.worst_error = std::max(out.worst_error, encoder.report().worst_error);
  }
  // Further steps, whose bytes are compared. Between timed ones a GPU would wait, and lower its clock.
  for (int step = 0; step < o.steps; ++step) {
    TimedGuides guides(simulation, packs), positions(simulation, false);
    advance(guides);
    if (hashOf(again, frame, guides) != hashOf(by_processor, frame, positions)) ++out.different;
  }
  out.wall_ms = spreadOf(wall);
  out.chunks_ms = spreadOf(chunks);
  out.all_ms = spreadOf(all);
  if (!gpu.empty()) out.gpu_ms = spreadOf(gpu).median;
  return out;
}

int encode(const EncodeOptions& o) {
  const Scene scene = benchScene(o.scene, o.strands, o.vertices, o.seed);
  Bench bench;
  bench.name = "encode";
  bench.params = {{"scene", o.scene},       {"strands", o.strands}, {"vertices", o.vertices},
                  {"substeps", o.substeps}, {"steps", o.steps},     {"shake_hz", o.shake},
                  {"seed", o.seed}};
  bench.more = {{"backend", o.backend}, {"threads", o.threads}};
  bench.heading =
      fmt::format("scene {}, {} x {}, {} substeps, delta16\n", o.scene, o.strands, o.vertices, o.substeps);
  bench.table = Table({{"case", "encoded by"},
                       {"device", "device"},
                       {"strands"},
                       {"vertices"},
                       {"ms_min", "ms min", "{:.3f}"},
                       {"ms_median", "median", "{:.3f}"},
                       {"ms_p95", "p95", "{:.3f}"},
                       {"gpu_ms", "gpu ms", "{:.3f}"},
                       {"over_gpu_ms", "over gpu", "{:.3f}"},
                       {"chunks_ms", "chunks ms", "{:.3f}"},
                       {"all_ms", "all ms", "{:.3f}"},
                       {"bytes_per_vertex", "B/vertex", "{:.2f}"},
                       {"read_bytes_per_vertex", "B read", "{:.2f}"},
                       {"max_error_mm", "error mm", "{:.2g}"},
                       {"frames"},
                       {"frames_different", "different"}});
  std::vector<std::string> failures;
  const bool on_gpu = o.backend == "gpu";
  for (const bool packs : {true, false}) {
    if (packs && !on_gpu) continue;
    const EncodedSteps run = encodeSteps(o, scene, o.backend, packs);
    const double per_vertex = 1.0 / (static_cast<double>(scene.groom.strands.vertices()) * o.steps);
    const double bytes = static_cast<double>(run.bytes) * per_vertex;
    const double taken = static_cast<double>(run.taken) * sizeof(Vec3) * per_vertex;
    nlohmann::json row{{"case", packs ? "gpu" : "cpu"},
                       {"device", run.device},
                       {"strands", o.strands},
                       {"vertices", o.vertices},
                       {"ms_min", run.wall_ms.min},
                       {"ms_median", run.wall_ms.median},
                       {"ms_p95", run.wall_ms.p95},
                       {"chunks_ms", run.chunks_ms.median},
                       {"all_ms", run.all_ms.median},
                       {"bytes_per_vertex", bytes},
                       {"max_error_mm", 1e3 * run.worst_error},
                       {"frames", o.steps},
                       {"frames_different", run.different}};
    if (on_gpu) row["read_bytes_per_vertex"] = packs ? bytes + taken : taken;
    if (run.gpu_ms) {
      row["gpu_ms"] = *run.gpu_ms;
      row["over_gpu_ms"] = run.wall_ms.median - *run.gpu_ms;
    }
    if (packs && run.different > 0)
      failures.push_back(
          fmt::format("{} of {} frames have other bytes than the CPU writes", run.different, o.steps));
    if (packs && o.most_over_gpu) {
      if (!run.gpu_ms)
        failures.push_back("the driver does not measure GPU time: --most-over-gpu cannot be judged");
      else if (run.wall_ms.median - *run.gpu_ms > *o.most_over_gpu)
        failures.push_back(fmt::format("wall time exceeds GPU time by {:.3f} ms, more than {:.3f} ms",
                                       run.wall_ms.median - *run.gpu_ms, *o.most_over_gpu));
    }
    bench.table.add(row);
  }
  bench.more["failures"] = failures;
  bench.closing = failures.empty() && on_gpu ? "the GPU's bytes are the CPU's\n" : "";
  for (const std::string& failure : failures) bench.closing += "FAILED: " + failure + '\n';
  print(bench, o.print);
  return failures.empty() ? 0 : 1;
}

}  // namespace

std::function<int()> addEncodeBench(CLI::App& app) {
  const auto o = std::make_shared<EncodeOptions>();
  app.footer(
      "median: wall time from the start of a step until its payloads (or, encoded by the cpu, its positions) "
      "are\n"
      "readable by the CPU. gpu ms: of the step's dispatches and those that pack. chunks ms: from then until "
      "all\n"
      "chunks are made. The bytes of as many further frames are compared with those that the CPU makes of "
      "their\n"
      "positions.\n"
      "Exit code 1: bytes differ, or --most-over-gpu is exceeded.\n"
      "Examples:\n"
      "  strandbench encode --most-over-gpu 0.3\n"
      "  strandbench encode --strands 4000 --json\n"
      "  strandbench encode --backend simd --strands 20000");
  addScene(app, o->scene);
  addStrands(app, o->strands);
  addVertices(app, o->vertices);
  addSubsteps(app, o->substeps);
  addThreads(app, o->threads, "threads that encode, and of the simd backend; 0 = all");
  addSteps(app, o->steps);
  addSeed(app, o->seed);
  addBackend(app, o->backend, {"gpu", "simd"});
  app.add_option("--warmup", o->warmup, "untimed steps")->check(CLI::Range(0, 10000))->capture_default_str();
  app.add_option("--shake", o->shake, "shakes of the head per second; 0 = the scene's own motion")
      ->check(finiteRange(0.0, 10.0))
      ->capture_default_str();
  app.add_option("--most-over-gpu", o->most_over_gpu,
                 "ms by which the median may exceed the GPU's time; more is a failure")
      ->check(finiteRange(0.0, 1000.0));
  addPrintOptions(app, o->print);
  return [o] { return encode(*o); };
}

}  // namespace strandcast
