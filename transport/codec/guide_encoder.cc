#include "transport/codec/guide_encoder.h"

#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_pipeline.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>

namespace strandcast {

struct GuideEncoder::Pipeline {
  struct Stage {
    ChunkEncoder encoder;
    GuideChunk chunk;
    ChunkReport report;
  };
  Pipeline(int threads, EncodedGroom& groom, const StrandCoder& coder) : arena(threads) {
    // Chunks leave in order: those that are done early wait for those before them.
    for (int i = 0; i < 2 * threads; ++i) stages.push_back({ChunkEncoder(groom, coder), {}, {}});
  }
  oneapi::tbb::task_arena arena;
  std::vector<Stage> stages;
};

GuideEncoder::GuideEncoder(const CodecOptions& options, const StrandCoder& coder)
    : groom_{options, {}, {}, {}, {}}, coder_(coder), own_(groom_, coder) {}

GuideEncoder::~GuideEncoder() = default;

void GuideEncoder::setGroom(const StrandSet& guides) {
  const CodecOptions& options = groom_.options;
  groom_.geometry = GuideGeometry(guides);
  groom_.runs = divideGuides(guides);
  groom_.rests.assign(groom_.runs.size(), {});
  groom_.histories.assign(options.codec == Codec::kTemporal ? groom_.runs.size() : 0, {});
  report_ = {nameOf(options.codec), options.codec == Codec::kFloat32 ? 0.0 : double{options.max_error}};
  reported_frame_ = 0;
}

void GuideEncoder::add(const GuideFrame& frame, const GuideChunk& chunk, const ChunkReport& report) {
  if (frame.frame != reported_frame_) {
    reported_frame_ = frame.frame;
    report_.frame_bytes = report_.strands_sent_finer = 0;
    report_.worst_error = 0;
  }
  report_.frame_bytes += chunk.payload.size();
  report_.strands_sent_finer += report.strands_sent_finer;
  report_.worst_error = std::max(report_.worst_error, report.worst_error);
}

void GuideEncoder::encode(const GuideFrame& frame, uint32_t index, GuideChunk& chunk) {
  const ChunkReport report = own_.encode(frame, index, chunk);
  add(frame, chunk, report);
}

void GuideEncoder::encodeAll(const GuideFrame& frame, const std::function<void(GuideChunk&)>& send) {
  namespace tbb = oneapi::tbb;
  const auto count = static_cast<uint32_t>(groom_.runs.size());
  const int asked = groom_.options.threads, there = tbb::info::default_concurrency();
  const int threads = std::min({asked > 0 ? asked : there, there, kMaxEncodingThreads});
  if (threads == 1 || count <= 1) {
    for (uint32_t i = 0; i < count; ++i) {
      encode(frame, i, own_chunk_);
      send(own_chunk_);
    }
    return;
  }
  if (!pipeline_) pipeline_ = std::make_unique<Pipeline>(threads, groom_, coder_);
  std::vector<Pipeline::Stage>& stages = pipeline_->stages;
  // Of chunks under way no two are as many apart as there are stages.
  const auto stage = [&](uint32_t index) -> Pipeline::Stage& { return stages[index % stages.size()]; };
  uint32_t next = 0;
  pipeline_->arena.execute([&] {
    tbb::parallel_pipeline(
        stages.size(),
        tbb::make_filter<void, uint32_t>(tbb::filter_mode::serial_in_order,
                                         [&](tbb::flow_control& flow) -> uint32_t {
                                           if (next == count) flow.stop();
                                           return next == count ? 0 : next++;
                                         }) &
            tbb::make_filter<uint32_t, uint32_t>(tbb::filter_mode::parallel,
                                                 [&](uint32_t index) {
                                                   Pipeline::Stage& own = stage(index);
                                                   own.report = own.encoder.encode(frame, index, own.chunk);
                                                   return index;
                                                 }) &
            tbb::make_filter<uint32_t, void>(tbb::filter_mode::serial_in_order, [&](uint32_t index) {
              Pipeline::Stage& own = stage(index);
              add(frame, own.chunk, own.report);
              send(own.chunk);
            }));
  });
}

}  // namespace strandcast
