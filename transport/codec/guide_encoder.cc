#include "transport/codec/guide_encoder.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "transport/codec/octahedral.h"

namespace strandcast {
namespace {

/// A component is off by half a step at most, a position by sqrt(3) times that. The rest of the bound is for
/// the rounding of floats on the way to the head's frame and back.
constexpr float kStepOfError = 0.95f * 2 / 1.7320508f;
/// An encoding that cannot hold one strand in so many is left for kDelta16.
constexpr size_t kUnfitShare = 8;

Encoding encodingOf(Codec codec) {
  switch (codec) {
    case Codec::kFloat32:
      return Encoding::kFloat32;
    case Codec::kOctahedral12:
    case Codec::kTemporal:
      return Encoding::kOctahedral12;
    case Codec::kOctahedral16:
      return Encoding::kOctahedral16;
    case Codec::kDelta16:
      break;
  }
  return Encoding::kDelta16;
}

bool fits16(int32_t value) { return value >= -32768 && value <= 32767; }

void writeFloat32(const GuideFrame& frame, const StrandRun& run, GuideChunk& chunk) {
  chunk.encoding = Encoding::kFloat32;
  chunk.key_frame = 0;
  chunk.payload.resize(run.vertex_count * sizeof(Vec3));
  std::memcpy(chunk.payload.data(), frame.positions.data() + run.first_vertex, chunk.payload.size());
}

}  // namespace

void GuideEncoder::setGroom(const StrandSet& guides) {
  geometry_ = GuideGeometry(guides);
  runs_ = divideGuides(guides);
  keys_.assign(options_.codec == Codec::kTemporal ? runs_.size() : 0, {});
  report_ = {nameOf(options_.codec), options_.codec == Codec::kFloat32 ? 0.0 : double{options_.max_error}};
  reported_frame_ = 0;
  step_ = kStepOfError * options_.max_error;
}

bool GuideEncoder::isClose(const HeadFrame& head, const Vec3& decoded, const Vec3& wanted) {
  const auto squared = static_cast<double>((head.toWorld(decoded) - wanted).squaredNorm());
  squared_error_ = std::max(squared_error_, squared);
  return squared <= double{options_.max_error} * options_.max_error;  // false for NaN
}

bool GuideEncoder::quantizeRoot(const HeadFrame& head, const Vec3& root, uint32_t number,
                                const StrandRun& run, int32_t (&index)[3]) {
  const Vec3 local = head.toHead(root);
  const Vec3& rest = geometry_.roots[run.first_strand + number];
  for (int c = 0; c < 3; ++c) {
    index[c] = gridIndex(local[c], step_);
    const int32_t moved = index[c] - gridIndex(rest[c], step_);
    if (!fits16(moved)) return false;
    symbols_.roots[static_cast<size_t>(c) * run.strand_count + number] = static_cast<uint16_t>(moved);
  }
  const Vec3 decoded(gridPosition(index[0], step_), gridPosition(index[1], step_),
                     gridPosition(index[2], step_));
  return isClose(head, decoded, root);
}

bool GuideEncoder::quantizeDelta(const HeadFrame& head, std::span<const Vec3> strand, uint32_t number,
                                 size_t first_edge, const StrandRun& run) {
  int32_t before[3];
  if (!quantizeRoot(head, strand[0], number, run, before)) return false;
  const size_t plane = run.vertex_count - run.strand_count;
  for (size_t i = 1; i < strand.size(); ++i) {
    const Vec3 local = head.toHead(strand[i]);
    Vec3 decoded;
    for (int c = 0; c < 3; ++c) {
      const int32_t index = gridIndex(local[c], step_), edge = index - before[c];
      if (!fits16(edge)) return false;
      symbols_.edges[static_cast<size_t>(c) * plane + first_edge + i - 1] = static_cast<uint16_t>(edge);
      before[c] = index;
      decoded[c] = gridPosition(index, step_);
    }
    if (!isClose(head, decoded, strand[i])) return false;
  }
  return true;
}

bool GuideEncoder::quantizeOctahedral(const HeadFrame& head, std::span<const Vec3> strand, uint32_t number,
                                      size_t first_edge, const StrandRun& run, int bits) {
  int32_t root[3];
  if (!quantizeRoot(head, strand[0], number, run, root)) return false;
  Vec3 before(gridPosition(root[0], step_), gridPosition(root[1], step_), gridPosition(root[2], step_));
  const size_t plane = run.vertex_count - run.strand_count;
  const size_t first_vertex = geometry_.offsets[run.first_strand + number];
  for (size_t i = 1; i < strand.size(); ++i) {
    // Aimed from where the receiver has the vertex before: errors do not add up.
    const Vec3 edge = head.toHead(strand[i]) - before;
    const OctahedralPoint point = edge.squaredNorm() > 0 ? toOctahedral(edge, bits) : OctahedralPoint{};
    symbols_.edges[first_edge + i - 1] = point.u;
    symbols_.edges[plane + first_edge + i - 1] = point.v;
    before += geometry_.lengths[first_vertex + i] * fromOctahedral(point, bits);
    if (!isClose(head, before, strand[i])) return false;
  }
  return true;
}

void GuideEncoder::quantize(const GuideFrame& frame, const StrandRun& run, Encoding encoding) {
  shapeSymbols(geometry_, run, encoding, symbols_, strand_ends_);
  const HeadFrame head(frame.head);
  const size_t plane = run.vertex_count - run.strand_count;
  exact_.clear();
  worst_squared_ = 0;
  for (uint32_t s = 0; s < run.strand_count; ++s) {
    const uint32_t first = geometry_.offsets[run.first_strand + s];
    const std::span<const Vec3> strand(frame.positions.data() + first,
                                       geometry_.offsets[run.first_strand + s + 1] - first);
    const size_t first_edge = first - run.first_vertex - s;
    squared_error_ = 0;
    const bool fits = encoding == Encoding::kDelta16
                          ? quantizeDelta(head, strand, s, first_edge, run)
                          : quantizeOctahedral(head, strand, s, first_edge, run, edgeBits(encoding));
    if (fits) {
      worst_squared_ = std::max(worst_squared_, squared_error_);
      continue;
    }
    exact_.push_back(static_cast<uint16_t>(s));
    for (size_t c = 0; c < 3; ++c) symbols_.roots[c * run.strand_count + s] = 0;
    for (size_t c = 0; c < static_cast<size_t>(symbols_.edge_planes); ++c)
      std::fill_n(symbols_.edges.begin() + static_cast<ptrdiff_t>(c * plane + first_edge), strand.size() - 1,
                  uint16_t{0});
  }
}

void GuideEncoder::writePayload(const GuideFrame& frame, const StrandRun& run, uint32_t index,
                                GuideChunk& chunk) {
  uint8_t mode = 0;
  SymbolPrediction prediction;
  prediction.edge_bits = edgeBits(chunk.encoding);
  prediction.strand_ends = strand_ends_;
  chunk.key_frame = 0;
  if (!keys_.empty()) {
    // Each chunk has its key frames at a time of its own, so that frames are about equally large.
    const Key& key = keys_[index];
    const uint64_t phase = frame.frame + uint64_t{index} * options_.key_interval / runs_.size();
    const bool has_key = key.frame != 0 && key.encoding == chunk.encoding && key.frame < frame.frame &&
                         frame.frame - key.frame < options_.key_interval;
    if (has_key && phase % options_.key_interval != 0) {
      mode |= kFromKey;
      prediction.key = &key.symbols;
      chunk.key_frame = key.frame;
    } else {
      mode |= kKeep;
    }
  }
  if (SymbolPacker::prefersAlongStrand(symbols_, prediction)) {
    mode |= kAlongStrand;
    prediction.along_strand = true;
  }
  const auto exact_strands = static_cast<uint16_t>(exact_.size());
  std::vector<uint8_t>& bytes = chunk.payload;
  bytes.resize(kPayloadHeadBytes + exact_.size() * sizeof(uint16_t));
  bytes[0] = mode;
  bytes[1] = 0;
  std::memcpy(bytes.data() + 2, &exact_strands, sizeof exact_strands);
  std::memcpy(bytes.data() + 4, &step_, sizeof step_);
  if (!exact_.empty())
    std::memcpy(bytes.data() + kPayloadHeadBytes, exact_.data(), exact_.size() * sizeof(uint16_t));
  for (const uint16_t s : exact_) {
    const uint32_t first = geometry_.offsets[run.first_strand + s];
    const size_t length = (geometry_.offsets[run.first_strand + s + 1u] - first) * sizeof(Vec3);
    bytes.resize(bytes.size() + length);
    std::memcpy(bytes.data() + bytes.size() - length, frame.positions.data() + first, length);
  }
  packer_.pack(symbols_, prediction, bytes);
  if ((mode & kKeep) != 0) {
    Key& key = keys_[index];
    key.frame = frame.frame;
    key.encoding = chunk.encoding;
    std::swap(key.symbols, symbols_);
  }
}

void GuideEncoder::encode(const GuideFrame& frame, uint32_t index, GuideChunk& chunk) {
  const StrandRun& run = runs_[index];
  fillGuideHeader(frame, runs_, index, chunk);
  chunk.encoding = encodingOf(options_.codec);
  if (frame.frame != reported_frame_) {
    reported_frame_ = frame.frame;
    report_.frame_bytes = report_.strands_sent_finer = 0;
    report_.worst_error = 0;
  }
  if (chunk.encoding == Encoding::kFloat32) {
    writeFloat32(frame, run, chunk);
  } else {
    quantize(frame, run, chunk.encoding);
    if (chunk.encoding != Encoding::kDelta16 && exact_.size() * kUnfitShare > run.strand_count) {
      chunk.encoding = Encoding::kDelta16;
      quantize(frame, run, chunk.encoding);
    }
    const size_t exact_strands = exact_.size();
    writePayload(frame, run, index, chunk);
    if (chunk.payload.size() >= run.vertex_count * sizeof(Vec3)) {
      if (!keys_.empty()) keys_[index].frame = 0;  // nobody is told of it
      writeFloat32(frame, run, chunk);
      report_.strands_sent_finer += run.strand_count;
    } else {
      report_.strands_sent_finer += exact_strands;
      report_.worst_error = std::max(report_.worst_error, std::sqrt(worst_squared_));
    }
  }
  report_.frame_bytes += chunk.payload.size();
}

}  // namespace strandcast
