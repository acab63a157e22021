#include "gpu_compute/guide_packer.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>

#include "core/error.h"
#include "gpu_compute/shaders.h"

namespace strandcast::gpu {
namespace {

// As in shaders/pack_guides.comp.
constexpr size_t kPairNumbers = 16, kMaxPackedPairBytes = 33;
constexpr size_t kHeadWords = 4, kRunWords = 4, kLineWords = 32;
constexpr uint32_t kFirstEdge = 0x80000000u, kSampledEdge = 0x40000000u;
constexpr uint32_t kPaddingSymbol = 0x10000u;
/// A sample of every 16th strand decides on the prediction: SymbolPacker::prefersAlongStrand().
constexpr uint32_t kPackerSampleEvery = 16;
/// Bytes that start() copies beyond those of the frame before, and a 16th of those: frames differ little.
constexpr size_t kCopyMargin = 4096;

size_t wholeLines(size_t words) { return (words + kLineWords - 1) / kLineWords * kLineWords; }
size_t pairsFor(size_t numbers) { return (numbers + kPairNumbers - 1) / kPairNumbers; }
size_t pairsOf(const StrandRun& run) {
  return pairsFor(size_t{3} * run.strand_count) + pairsFor(size_t{3} * (run.vertex_count - run.strand_count));
}
size_t pairsOf(const GuideGrid& grid) {
  size_t pairs = 0;
  for (const StrandRun& run : grid.runs) pairs += pairsOf(run);
  return pairs;
}

size_t firstDataWord(const GuideGrid& grid) { return wholeLines(kHeadWords + kRunWords * grid.runs.size()); }

/// Of Packed, with space for the longest data of every run.
size_t packedBytes(const GuideGrid& grid) {
  size_t words = firstDataWord(grid);
  for (const StrandRun& run : grid.runs) words += wholeLines((pairsOf(run) * kMaxPackedPairBytes + 3) / 4);
  return words * sizeof(uint32_t);
}

std::vector<std::array<uint32_t, 8>> runTable(const GuideGrid& grid) {
  std::vector<std::array<uint32_t, 8>> table;
  size_t quads = 0;
  for (const StrandRun& run : grid.runs) {
    table.push_back({run.first_strand, run.strand_count, run.first_vertex, run.vertex_count,
                     static_cast<uint32_t>(quads), 0, 0, 0});
    quads += pairsOf(run) * kPairNumbers / 4;
  }
  return table;
}

std::vector<uint32_t> edgeVertices(const StrandModel& model, const GuideGrid& grid) {
  std::vector<uint32_t> out;
  out.reserve(model.vertices() - model.strands());
  for (const StrandRun& run : grid.runs)
    for (uint32_t s = 0; s < run.strand_count; ++s) {
      const uint32_t first = model.offsets[run.first_strand + s],
                     end = model.offsets[run.first_strand + s + 1];
      for (uint32_t v = first + 1; v < end; ++v)
        out.push_back(v | (v == first + 1 ? kFirstEdge : 0) |
                      (s % kPackerSampleEvery == 0 ? kSampledEdge : 0));
    }
  return out;
}

}  // namespace

GuidePacker::GuidePacker(const StrandModel& model, const GuideGrid& grid, ProgramCache& programs)
    : grid_number_(grid.number),
      program_(&programs.get("pack_guides.comp", shaders::kPackGuidesComp, "")),
      step_((gl::discardErrors(), grid.step)),
      per_step_(grid.per_step),
      squared_limit_(grid.squared_limit),
      runs_(grid.runs.size()),
      first_data_word_(static_cast<uint32_t>(firstDataWord(grid))),
      run_table_(std::span<const std::array<uint32_t, 8>>(runTable(grid))),
      edge_vertices_(std::span<const uint32_t>(edgeVertices(model, grid))),
      rest_roots_(std::span<const int32_t>(grid.rest_roots)),
      symbols_(pairsOf(grid) * kPairNumbers * sizeof(uint32_t), nullptr, 0),
      packed_(packedBytes(grid), nullptr, 0),
      readback_(packed_.bytes()),
      next_copy_(packed_.bytes()) {
  if (gl::ranOutOfMemory())
    throw Error("packing guides does not fit the GPU's memory", fmt::format("{} vertices", model.vertices()),
                "use fewer strands or --backend simd");
  glClearNamedBufferData(symbols_.id(), GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, &kPaddingSymbol);
  clearTaken();
}

void GuidePacker::clearTaken() {
  glClearNamedBufferSubData(packed_.id(), GL_R32UI, 0, sizeof(uint32_t), GL_RED_INTEGER, GL_UNSIGNED_INT,
                            &first_data_word_);
}

void GuidePacker::start(const gl::Buffer& guides, const gl::Buffer& offsets, const PackingFrame& frame) {
  frame_ = frame;
  guides.bindStorage(0);
  offsets.bindStorage(1);
  run_table_.bindStorage(2);
  edge_vertices_.bindStorage(3);
  rest_roots_.bindStorage(4);
  symbols_.bindStorage(5);
  packed_.bindStorage(6);
  symbols_.bindStorage(7);
  std::array<float, 9> rotation;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column)
      rotation[static_cast<size_t>(3 * row + column)] = frame.rotation(row, column);
  glProgramUniform1fv(program_->id(), 0, 9, rotation.data());
  glProgramUniform3fv(program_->id(), 9, 1, frame.position.data());
  glProgramUniform3fv(program_->id(), 10, 1, frame.origin.data());
  glProgramUniform3f(program_->id(), 11, step_, per_step_, squared_limit_);
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);  // an earlier start() may still be writing
  timer_.begin();
  dispatch(*program_, static_cast<uint32_t>(runs_.size()), 1);
  timer_.end();
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  copied_ = std::min(next_copy_, packed_.bytes());
  readback_.copyFrom(packed_, 0, copied_);
  clearTaken();  // for the next start(); finish() does not wait for it
  glFlush();
}

std::span<const PackedRun> GuidePacker::finish() {
  readback_.wait();
  const uint32_t* const words = readback_.as<uint32_t>().data();
  const size_t used = std::min(words[0] * sizeof(uint32_t), packed_.bytes());
  if (used > copied_) {
    readback_.copyFrom(packed_, copied_, used - copied_);
    readback_.wait();
    copied_ = used;
  }
  next_copy_ = used + used / 16 + kCopyMargin;
  for (size_t r = 0; r < runs_.size(); ++r) {
    const uint32_t* const head = words + kHeadWords + kRunWords * r;
    runs_[r] = {{reinterpret_cast<const uint8_t*>(words + head[3]), head[0]},
                head[1] != 0,
                std::bit_cast<float>(head[2])};
  }
  return runs_;
}

}  // namespace strandcast::gpu
