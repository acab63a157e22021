#include "transport/codec/chunk_encoder.h"

#include <algorithm>
#include <cstring>
#include <limits>

namespace strandcast {
namespace {

/// Grid step over error bound. A component is off by at most half a step, a position by sqrt(3) times that.
/// The factor 0.95 leaves room for rounding on the way to the head's frame and back.
constexpr float kStepOfError = 0.95f * 2 / 1.7320508f;
/// Likewise on a plane. The factor 0.6 leaves room for the error along the strand, which no direction can
/// correct.
constexpr float kTangentStepOfError = 0.6f * 2 / 1.4142136f;
/// An encoding is replaced by kDelta16 if more than one strand in kUnfitShare does not fit it.
constexpr size_t kUnfitShare = 8;

Encoding encodingOf(Codec codec) {
  switch (codec) {
    case Codec::kFloat32:
      return Encoding::kFloat32;
    case Codec::kOctahedral12:
      return Encoding::kOctahedral12;
    case Codec::kTangent:
    case Codec::kTemporal:
      return Encoding::kTangent;
    case Codec::kOctahedral16:
      return Encoding::kOctahedral16;
    case Codec::kDelta16:
      break;
  }
  return Encoding::kDelta16;
}

constexpr float kNotHeld = std::numeric_limits<float>::infinity();

void writeFloat32(const GuideFrame& frame, const StrandRun& run, GuideChunk& chunk) {
  chunk.encoding = Encoding::kFloat32;
  chunk.key_frame = 0;
  chunk.payload.resize(run.vertex_count * sizeof(Vec3));
  std::memcpy(chunk.payload.data(), frame.positions.data() + run.first_vertex, chunk.payload.size());
}

}  // namespace

ChunkEncoder::ChunkEncoder(EncodedGroom& groom, const StrandCoder& coder)
    : groom_(&groom),
      squared_limit_(groom.options.max_error * groom.options.max_error),
      step_(kStepOfError * groom.options.max_error),
      tangent_step_(kTangentStepOfError * groom.options.max_error),
      coder_(coder),
      packer_(coder) {}

void ChunkEncoder::quantizeRoots(const GuideFrame& frame, const StrandRun& run, const HeadFrame& head,
                                 Encoding encoding) {
  roots_.resize(run.strand_count);
  worst_.resize(run.strand_count);
  const bool is_tangent = encoding == Encoding::kTangent;
  const float step = is_tangent ? tangent_step_ : step_;
  for (uint32_t s = 0; s < run.strand_count; ++s) {
    const Vec3& wanted = frame.positions[groom_->geometry.offsets[run.first_strand + s]];
    const Vec3& rest = groom_->geometry.roots[run.first_strand + s];
    const Vec3 local = head.toHead(wanted);
    Vec3 decoded, index;
    bool fits = true;
    for (int c = 0; c < 3; ++c) {
      // Tangents: difference from rest; otherwise grid coordinates.
      const int32_t place = gridIndex(is_tangent ? local[c] - rest[c] : local[c], step);
      const int32_t moved = is_tangent ? place : place - gridIndex(rest[c], step);
      const int32_t symbol = std::clamp(moved, -32767, 32767);
      fits &= symbol == moved;
      symbols_.roots[static_cast<size_t>(c) * run.strand_count + s] = static_cast<uint16_t>(symbol);
      index[c] = static_cast<float>(place);
      decoded[c] = is_tangent ? rest[c] + gridPosition(symbol, step) : gridPosition(place, step);
    }
    const float error = (head.toWorld(decoded) - wanted).squaredNorm();
    roots_[s] = encoding == Encoding::kDelta16 ? index : decoded;
    worst_[s] = fits && error <= squared_limit_ ? error : kNotHeld;  // false for NaN
  }
}

void ChunkEncoder::quantize(const GuideFrame& frame, uint32_t index, Encoding encoding,
                            const TangentHistory* history) {
  const StrandRun& run = groom_->runs[index];
  shapeSymbols(run, encoding, symbols_);
  const HeadFrame head(frame.head);
  quantizeRoots(frame, run, head, encoding);
  StrandEncoding job{.geometry = groom_->geometry,
                     .run = run,
                     .head = head,
                     .positions = frame.positions.data() + run.first_vertex,
                     .roots = roots_.data(),
                     .step = encoding == Encoding::kTangent ? tangent_step_ : step_,
                     .squared_limit = squared_limit_,
                     .bits = edgeBits(encoding),
                     .rest = &groom_->rests[index],
                     .history = history,
                     .edges = symbols_.edges.data(),
                     .worst = worst_.data()};
  if (encoding == Encoding::kDelta16) {
    coder_.encode_delta(job, rows_);
  } else if (encoding != Encoding::kTangent) {
    coder_.encode_octahedral(job, rows_);
  } else {
    if (groom_->rests[index].empty()) coder_.rest_directions(groom_->geometry, run, groom_->rests[index]);
    if (!groom_->histories.empty()) job.directions = &directions_;
    coder_.encode_tangents(job, rows_);
  }
  exact_.clear();
  worst_squared_ = 0;
  for (uint32_t s = 0; s < run.strand_count; ++s) {
    if (worst_[s] != kNotHeld)
      worst_squared_ = std::max(worst_squared_, worst_[s]);
    else
      exact_.push_back(static_cast<uint16_t>(s));
  }
}

void ChunkEncoder::findStrandEnds(const StrandRun& run) {
  strand_ends_.resize(run.strand_count);
  for (uint32_t s = 0; s < run.strand_count; ++s)
    strand_ends_[s] = groom_->geometry.offsets[run.first_strand + s + 1] - run.first_vertex - (s + 1);
}

/// The symbols of strands that are sent as float32 carry no information: zeros need the fewest bits.
void ChunkEncoder::forgetExactStrands(const StrandRun& run) {
  const size_t plane = run.vertex_count - run.strand_count;
  for (const uint16_t s : exact_) {
    const size_t begin = s == 0 ? 0 : strand_ends_[s - 1u], end = strand_ends_[s];
    for (size_t c = 0; c < 3; ++c) symbols_.roots[c * run.strand_count + s] = 0;
    for (size_t c = 0; c < static_cast<size_t>(symbols_.edge_planes); ++c)
      std::fill(symbols_.edges.begin() + static_cast<ptrdiff_t>(c * plane + begin),
                symbols_.edges.begin() + static_cast<ptrdiff_t>(c * plane + end), uint16_t{0});
  }
}

void ChunkEncoder::writePreamble(const GuideFrame& frame, const StrandRun& run, uint8_t mode, float step,
                                 std::vector<uint8_t>& bytes) const {
  const auto exact_strands = static_cast<uint16_t>(exact_.size());
  bytes.resize(kPayloadHeadBytes + exact_.size() * sizeof(uint16_t));
  bytes[0] = mode;
  bytes[1] = 0;
  std::memcpy(bytes.data() + 2, &exact_strands, sizeof exact_strands);
  std::memcpy(bytes.data() + 4, &step, sizeof step);
  if (!exact_.empty())
    std::memcpy(bytes.data() + kPayloadHeadBytes, exact_.data(), exact_.size() * sizeof(uint16_t));
  for (const uint16_t s : exact_) {
    const uint32_t first = groom_->geometry.offsets[run.first_strand + s];
    const size_t length = (groom_->geometry.offsets[run.first_strand + s + 1u] - first) * sizeof(Vec3);
    bytes.resize(bytes.size() + length);
    std::memcpy(bytes.data() + bytes.size() - length, frame.positions.data() + first, length);
  }
}

void ChunkEncoder::writeSymbols(const GuideFrame& frame, const StrandRun& run, GuideChunk& chunk) {
  SymbolPrediction prediction;
  prediction.edge_bits = edgeBits(chunk.encoding);
  findStrandEnds(run);
  prediction.strand_ends = strand_ends_;
  forgetExactStrands(run);
  prediction.along_strand = SymbolPacker::prefersAlongStrand(symbols_, prediction);
  const bool zstd = groom_->options.zstd;
  const int mode = (prediction.along_strand ? kAlongStrand : 0) | (zstd ? 0 : kInBlocks);
  writePreamble(frame, run, static_cast<uint8_t>(mode), step_, chunk.payload);
  if (zstd)
    packer_.compress(symbols_, prediction, chunk.payload);
  else
    packer_.packInBlocks(symbols_, prediction, chunk.payload);
}

void ChunkEncoder::encodeTangents(const GuideFrame& frame, uint32_t index, GuideChunk& chunk) {
  const StrandRun& run = groom_->runs[index];
  TangentHistory* const own = groom_->histories.empty() ? nullptr : &groom_->histories[index];
  const TangentHistory* history = nullptr;
  // After a gap in frame numbers another daemon may have cast, and readers may have changed: use a key frame.
  if (own && own->frame != 0 && own->frame + 1 == frame.frame) {
    // Key frames of different chunks are spread over frames, so that frames have about equal size.
    const uint64_t phase = frame.frame + uint64_t{index} * groom_->options.key_interval / groom_->runs.size();
    if (phase % groom_->options.key_interval != 0) history = own;
  }
  quantize(frame, index, Encoding::kTangent, history);
  if (exact_.size() * kUnfitShare > run.strand_count) {
    if (own) own->frame = 0;  // not sent
    chunk.encoding = Encoding::kDelta16;
    return;
  }
  chunk.key_frame = history ? history->frame : 0;
  writePreamble(frame, run, kInBlocks, tangent_step_, chunk.payload);
  packer_.packInBlocks(symbols_, {}, chunk.payload);
  if (own) own->accept(frame.frame, history == nullptr, directions_);
}

ChunkReport ChunkEncoder::encode(const GuideFrame& frame, uint32_t index, GuideChunk& chunk) {
  const StrandRun& run = groom_->runs[index];
  fillGuideHeader(frame, groom_->runs, index, chunk);
  chunk.encoding = encodingOf(groom_->options.codec);
  chunk.key_frame = 0;
  if (chunk.encoding == Encoding::kFloat32) {
    writeFloat32(frame, run, chunk);
    return {};
  }
  if (chunk.encoding == Encoding::kTangent) encodeTangents(frame, index, chunk);
  if (chunk.encoding != Encoding::kTangent) {
    quantize(frame, index, chunk.encoding, nullptr);
    if (chunk.encoding != Encoding::kDelta16 && exact_.size() * kUnfitShare > run.strand_count) {
      chunk.encoding = Encoding::kDelta16;
      quantize(frame, index, chunk.encoding, nullptr);
    }
    writeSymbols(frame, run, chunk);
  }
  if (chunk.payload.size() >= run.vertex_count * sizeof(Vec3)) {
    if (!groom_->histories.empty()) groom_->histories[index].frame = 0;  // not sent
    writeFloat32(frame, run, chunk);
    return {run.strand_count, 0};
  }
  return {exact_.size(), std::sqrt(double{worst_squared_})};
}

}  // namespace strandcast
