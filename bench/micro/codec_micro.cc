// Encodes and decodes a frame of moving guides, for each codec, on one thread.
#include <benchmark/benchmark.h>

#include "bench/bench_scene.h"
#include "simd/simd_backend.h"
#include "transport/codec/guide_decoder.h"
#include "transport/codec/guide_encoder.h"

namespace strandcast {
namespace {

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

const bool is_registered = [] {
  for (const CodecInfo& info : codecList()) {
    const Codec codec = info.codec;
    benchmark::RegisterBenchmark((std::string("codec_encode/") + info.name).c_str(),
                                 [codec](benchmark::State& state) { encode(state, codec); });
    benchmark::RegisterBenchmark((std::string("codec_decode/") + info.name).c_str(),
                                 [codec](benchmark::State& state) { decode(state, codec); });
  }
  return true;
}();

}  // namespace
}  // namespace strandcast
