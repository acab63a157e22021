#include "bench/verbs.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <array>
#include <chrono>
#include <cmath>
#include <memory>
#include <thread>

#include "bench/bench_simulation.h"
#include "bench/counted_memory.h"
#include "bench/reader_process.h"
#include "core/backend.h"
#include "core/error.h"
#include "core/quantile.h"
#include "options/console.h"
#include "options/number_range.h"
#include "service/network.h"
#include "service/scene_simulation.h"
#include "transport/codec/guide_decoder.h"
#include "transport/codec/guide_encoder.h"
#include "transport/dds.h"
#include "transport/frame_queue.h"

namespace strandcast {
namespace {

using Clock = std::chrono::steady_clock;

struct EndToEndOptions {
  std::vector<double> rates{60, 120, 240};
  int strands = 5000, vertices = 32, substeps = 0, threads = 0, hairs = 10000, segments = 31;
  double seconds = 10;
  uint64_t seed = 1;
  std::string backend = "auto", scene = "wavy", codec = "delta16";
  PrintOptions print;
};

constexpr uint64_t kWarmUp = 30;  // frames excluded from the statistics

int64_t nanoseconds(Clock::time_point time) {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(time.time_since_epoch()).count();
}
double ms(int64_t from, int64_t to) { return 1e-6 * static_cast<double>(to - from); }

/// Times of a frame's stages, ns by the steady clock, which both processes share; 0 = did not happen.
struct FrameTimes {
  int64_t due = 0;        ///< the pose of the head for this frame is known
  int64_t begun = 0;      ///< the simulation thread is awake
  int64_t stepped = 0;    ///< the guides are ready
  int64_t published = 0;  ///< all guides are encoded and handed to the network
  int64_t arrived = 0;    ///< received and decoded in the other process
  int64_t taken = 0;      ///< the renderer thread is awake
  int64_t grown = 0;      ///< the hair is grown
};

/// Measures encoding and decoding of a frame in isolation.
class CodecTimer {
 public:
  CodecTimer(const StrandSet& guides, const CodecOptions& options) : encoder_(options) {
    encoder_.setGroom(guides);
    decoder_.setGroom(guides);
    chunks_.resize(encoder_.runs().size());
  }
  void measure(const GuideFrame& frame) {
    positions_.resize(frame.positions.size());
    const Clock::time_point start = Clock::now();
    encoder_.encodeAll(frame, [&](GuideChunk& chunk) { std::swap(chunks_[chunk.chunk_index], chunk); });
    const Clock::time_point encoded = Clock::now();
    for (const GuideChunk& chunk : chunks_)
      decoder_.decode(chunk, std::span(positions_).subspan(chunk.first_vertex, chunk.vertex_count));
    encode_ms.push_back(ms(nanoseconds(start), nanoseconds(encoded)));
    decode_ms.push_back(ms(nanoseconds(encoded), nanoseconds(Clock::now())));
  }
  std::vector<double> encode_ms, decode_ms;

 private:
  GuideEncoder encoder_;
  GuideDecoder decoder_;
  std::vector<GuideChunk> chunks_;
  std::vector<Vec3> positions_;
};

/// Measures one rate; returns a row of the table.
nlohmann::json castAt(const EndToEndOptions& o, const Scene& scene, double rate) {
  Parameters parameters = scene.parameters;
  parameters.solver = SolverKind::kRod;
  parameters.time_step = static_cast<float>(1 / rate);
  // Substeps of 1/360 s, or as near as the frame interval allows.
  parameters.substeps = o.substeps > 0 ? o.substeps : std::max(1, static_cast<int>(std::lround(360 / rate)));
  const size_t heap_before = heapBytes();
  Simulation simulation(sceneModel(scene), {}, parameters,
                        createBackend(knownBackends(), o.backend, o.threads, parameters.solver));
  simulation.step();
  const size_t heap = heapBytes() - heap_before;

  CodecOptions codec;
  codec.codec = codecNamed(o.codec, "--codec");
  const std::unique_ptr<Publisher> publisher = makeDdsPublisher({benchDomain(), 1, newSession(), codec});
  GroomDescription groom;
  groom.revision = 1;
  groom.guides = scene.groom.strands;
  publisher->announce(groom, {});
  const uint64_t frames = kWarmUp + static_cast<uint64_t>(std::max(1.0, o.seconds * rate));
  ReaderProcess reader(benchDomain(), frames, o.hairs, o.segments);
  reader.waitReady();
  for (int i = 0; i < 500 && publisher->matchedReaders() == 0; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));

  std::vector<FrameTimes> times(frames + 1);
  GuideFrame frame;
  frame.revision = 1;
  frame.positions.resize(simulation.model().vertices());
  uint64_t step_allocations = 0, late = 0, bytes = 0;
  const auto interval = std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(1 / rate));
  Clock::time_point due = Clock::now() + interval;
  const Clock::time_point start = due;
  for (uint64_t number = 1; number <= frames; ++number, due += interval) {
    if (Clock::now() > due + interval) {  // like the daemon, falls behind instead of catching up
      ++late;
      due = Clock::now();
    }
    std::this_thread::sleep_until(due);
    FrameTimes& t = times[number];
    t.due = nanoseconds(due);
    t.begun = nanoseconds(Clock::now());
    const uint64_t before = allocationsOfThisThread();
    simulation.setHeadPose(scene.motion(simulation.time() + parameters.time_step));
    simulation.step();
    const std::span<const Vec3> guides = simulation.guides();
    std::copy(guides.begin(), guides.end(), frame.positions.begin());
    if (number > kWarmUp) step_allocations += allocationsOfThisThread() - before;
    t.stepped = nanoseconds(Clock::now());
    frame.frame = number;
    frame.head = simulation.headPose();
    frame.simulation_time = simulation.time();
    frame.publish_time = systemTime();
    publisher->publish(frame);
    t.published = nanoseconds(Clock::now());
    bytes += publisher->encoding().frame_bytes;
  }
  const double seconds = std::chrono::duration<double>(Clock::now() - start).count();

  const nlohmann::json read = reader.report();
  for (const nlohmann::json& f : read["frames"]) {
    FrameTimes& t = times.at(f[0].get<size_t>());
    t.arrived = f[1];
    t.taken = f[2];
    t.grown = f[3];
  }
  std::array<std::vector<double>, 7> phases;  // the last one is the total
  for (uint64_t number = kWarmUp + 1; number <= frames; ++number) {
    const FrameTimes& t = times[number];
    if (t.grown == 0) continue;
    const int64_t at[] = {t.due, t.begun, t.stepped, t.published, t.arrived, t.taken, t.grown};
    for (size_t p = 0; p < 6; ++p) phases[p].push_back(ms(at[p], at[p + 1]));
    phases[6].push_back(ms(t.due, t.grown));
  }
  if (phases[6].empty())
    throw Error("no frame arrived", fmt::format("{:g} Hz", rate), "is the network interface lo up?");
  const Measurement measured = simulation.measure();
  const uint64_t hash = stateHash(simulation.state());
  CodecTimer codec_timer(scene.groom.strands, codec);
  for (int more = 0; more < 20; ++more) {
    simulation.setHeadPose(scene.motion(simulation.time() + parameters.time_step));
    simulation.step();
    const std::span<const Vec3> guides = simulation.guides();
    std::copy(guides.begin(), guides.end(), frame.positions.begin());
    frame.head = simulation.headPose();
    ++frame.frame;
    codec_timer.measure(frame);
  }
  const double counted = static_cast<double>(frames - kWarmUp);
  nlohmann::json row{
      {"rate_hz", rate},
      {"strands", o.strands},
      {"vertices", o.vertices},
      {"substeps", parameters.substeps},
      {"codec", o.codec},
      {"device", simulation.backend().device()},
      {"grown_on", read["renderer"].is_null() ? nlohmann::json("not grown") : read["renderer"]},
      {"hairs", o.hairs},
      {"frames", frames - kWarmUp},
      {"frames_grown", phases[6].size()},
      {"fps_cast", static_cast<double>(frames) / seconds},
      {"fps_grown", static_cast<double>(frames) / seconds * static_cast<double>(phases[6].size()) / counted},
      {"frames_late", late},
      {"frames_lost", read["lost"]},
      {"frame_bytes", static_cast<double>(bytes) / static_cast<double>(frames)},
      {"encode_ms_apart", quantileOf(codec_timer.encode_ms, 0.5)},
      {"decode_ms_apart", quantileOf(codec_timer.decode_ms, 0.5)},
      {"bytes_per_vertex", static_cast<double>(heap) / static_cast<double>(simulation.model().vertices())},
      {"allocations", step_allocations},
      {"mean_stretch", measured.mean_stretch},
      {"max_stretch", measured.max_stretch},
      {"state_hash", fmt::format("{:016x}", hash)}};
  for (const auto& [key, part] : {std::pair{"ms_min", 0.0},
                                  {"ms_p10", 0.1},
                                  {"ms_p25", 0.25},
                                  {"ms_median", 0.5},
                                  {"ms_p75", 0.75},
                                  {"ms_p90", 0.9},
                                  {"ms_p95", 0.95},
                                  {"ms_p99", 0.99},
                                  {"ms_max", 1.0}})
    row[key] = quantileOf(phases[6], part);
  const char* names[] = {"wake", "step", "publish", "wire", "take", "grow"};
  for (size_t p = 0; p < 6; ++p) {
    row[fmt::format("{}_ms", names[p])] = quantileOf(phases[p], 0.5);
    row[fmt::format("{}_ms_p99", names[p])] = quantileOf(phases[p], 0.99);
  }
  return row;
}

int endToEnd(const EndToEndOptions& o) {
  std::string reason;
  if (!ddsAvailable(&reason)) throw Error(reason, "strandbench end-to-end", "");
  const Scene scene = benchScene(o.scene, o.strands, o.vertices, o.seed);
  Bench bench;
  bench.name = "end-to-end";
  bench.params = {{"scene", o.scene}, {"seed", o.seed}, {"seconds", o.seconds}, {"threads", o.threads}};
  bench.heading = fmt::format(
      "{} guides x {}, codec {}, DDS on this machine, two processes; {}\n  ms, medians of phases\n",
      o.strands, o.vertices, o.codec,
      o.hairs > 0 ? fmt::format("{} hairs of {} segments grown", o.hairs, o.segments)
                  : "no growth (--hairs 0)");
  bench.table = Table({{"rate_hz", "Hz", "{:g}"},
                       {"strands"},
                       {"vertices"},
                       {"substeps", "sub"},
                       {"codec"},
                       {"hairs"},
                       {"frames"},
                       {"frames_grown"},
                       {"fps_cast", "cast/s", "{:.1f}"},
                       {"fps_grown", "grown/s", "{:.1f}"},
                       {"frames_late", "late"},
                       {"frames_lost", "lost"},
                       {"frame_bytes"},
                       {"wake_ms", "wake", "{:.2f}"},
                       {"step_ms", "step", "{:.2f}"},
                       {"publish_ms", "publish", "{:.2f}"},
                       {"wire_ms", "wire", "{:.2f}"},
                       {"take_ms", "take", "{:.2f}"},
                       {"grow_ms", "grow", "{:.2f}"},
                       {"wake_ms_p99"},
                       {"step_ms_p99"},
                       {"publish_ms_p99"},
                       {"wire_ms_p99"},
                       {"take_ms_p99"},
                       {"grow_ms_p99"},
                       {"encode_ms_apart", "(encode)", "{:.2f}"},
                       {"decode_ms_apart", "(decode)", "{:.2f}"},
                       {"ms_min"},
                       {"ms_p10"},
                       {"ms_p25"},
                       {"ms_median", "ALL p50", "{:.2f}"},
                       {"ms_p75"},
                       {"ms_p90"},
                       {"ms_p95"},
                       {"ms_p99", "p99", "{:.2f}"},
                       {"ms_max", "max", "{:.2f}"},
                       {"bytes_per_vertex"},
                       {"allocations", "allocs"},
                       {"mean_stretch"},
                       {"max_stretch", "max stretch", "{:.1e}"},
                       {"state_hash"},
                       {"device", "device"},
                       {"grown_on", "grown on"}});
  {
    ProgressBar bar;
    for (size_t i = 0; i < o.rates.size(); ++i) {
      bar.show(fmt::format("{:g} Hz", o.rates[i]),
               static_cast<double>(i) / static_cast<double>(o.rates.size()));
      bench.table.add(castAt(o, scene, o.rates[i]));
    }
  }
  print(bench, o.print);
  return 0;
}

}  // namespace

std::function<int()> addEndToEndBench(CLI::App& app) {
  const auto o = std::make_shared<EndToEndOptions>();
  app.footer(
      "This process simulates and publishes, a second one receives and renders, with DDS on this machine "
      "between\n"
      "them. Phases of a frame, whose times add up:\n"
      "  wake     from the head's motion being known to the daemon running\n"
      "  step     simulation, until the guides are available\n"
      "  publish  encoding, and passing all chunks to DDS\n"
      "  wire     until the last chunk is received and decoded (decoding overlaps with receiving)\n"
      "  take     until the renderer runs\n"
      "  grow     guides uploaded, hair grown, the device's fence signalled\n"
      "(encode), (decode): times of these alone, on further frames, after the measurement. A slow renderer "
      "skips\n"
      "frames: cast/s and grown/s differ by them. allocs: calls of operator new by the daemon's thread while "
      "it\n"
      "steps.\n"
      "Examples:\n"
      "  strandbench end-to-end --rates 120\n"
      "  strandbench end-to-end --hairs 0          for machines without a GPU");
  app.add_option("--rates", o->rates, "frames per second")
      ->delimiter(',')
      ->check(finiteRange(35.0, 1000.0))
      ->capture_default_str();
  addStrands(app, o->strands, "number of guides");
  addVertices(app, o->vertices, "vertices per guide");
  app.add_option("--substeps", o->substeps, "substeps per frame; 0 = as near to 1/360 s as frames allow")
      ->check(CLI::Range(0, 64));
  addBackend(app, o->backend, {"auto", "gpu", "simd", "reference"});
  addThreads(app, o->threads);
  addScene(app, o->scene);
  addSeed(app, o->seed);
  app.add_option("--codec", o->codec, "codec of the frames")->capture_default_str();
  app.add_option("--hairs", o->hairs, "hairs grown per frame; 0 = no growth")
      ->check(CLI::Range(0, 4000000))
      ->capture_default_str();
  app.add_option("--segments", o->segments, "segments per hair")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  app.add_option("--seconds", o->seconds, "seconds of publishing per rate")
      ->check(finiteRange(0.1, 3600.0))
      ->capture_default_str();
  addPrintOptions(app, o->print);
  return [o] { return endToEnd(*o); };
}

}  // namespace strandcast
