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
/// The same on a plane; more is left for what a strand is off along itself, which no direction can mend.
constexpr float kTangentStepOfError = 0.6f * 2 / 1.4142136f;
/// An encoding that cannot hold one strand in so many is left for kDelta16.
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

constexpr float kMaxSquaredEdge = 1e12f;  // m^2, beyond any hair

float squaredError(const HeadFrame& head, const Vec3& decoded, const Vec3& wanted) {
  return (head.toWorld(decoded) - wanted).squaredNorm();
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
  histories_.assign(options_.codec == Codec::kTemporal ? runs_.size() : 0, {});
  report_ = {nameOf(options_.codec), options_.codec == Codec::kFloat32 ? 0.0 : double{options_.max_error}};
  reported_frame_ = 0;
  step_ = kStepOfError * options_.max_error;
  tangent_step_ = kTangentStepOfError * options_.max_error;
  squared_limit_ = options_.max_error * options_.max_error;
}

Vec3 GuideEncoder::quantizeRoot(const HeadFrame& head, const Vec3& root, uint32_t number,
                                const StrandRun& run, int32_t (&index)[3], Fit& fit) {
  const Vec3 local = head.toHead(root);
  const Vec3& rest = geometry_.roots[run.first_strand + number];
  Vec3 decoded;
  for (int c = 0; c < 3; ++c) {
    index[c] = gridIndex(local[c], step_);
    const int32_t moved = index[c] - gridIndex(rest[c], step_);
    fit.holds &= fits16(moved);
    symbols_.roots[static_cast<size_t>(c) * run.strand_count + number] = static_cast<uint16_t>(moved);
    decoded[c] = gridPosition(index[c], step_);
  }
  const float error = squaredError(head, decoded, root);
  fit.squared_error = std::max(fit.squared_error, error);
  fit.holds &= error <= squared_limit_;  // false for NaN
  return decoded;
}

// Both go through the whole strand before they look at how it fits: a strand that does not is rare, and
// waiting for each vertex costs more than the work.

void GuideEncoder::quantizeDelta(const HeadFrame& head, std::span<const Vec3> strand, uint32_t number,
                                 size_t first_edge, const StrandRun& run, Fit& fit) {
  int32_t before[3];
  quantizeRoot(head, strand[0], number, run, before, fit);
  const size_t plane = run.vertex_count - run.strand_count;
  uint16_t* const edges = symbols_.edges.data() + first_edge;
  float worst = fit.squared_error;
  bool holds = fit.holds;
  for (size_t i = 1; i < strand.size(); ++i) {
    const Vec3 local = head.toHead(strand[i]);
    Vec3 decoded;
    for (size_t c = 0; c < 3; ++c) {
      const int32_t index = gridIndex(local[static_cast<int>(c)], step_), edge = index - before[c];
      holds &= fits16(edge);
      edges[c * plane + i - 1] = static_cast<uint16_t>(edge);
      before[c] = index;
      decoded[static_cast<int>(c)] = gridPosition(index, step_);
    }
    const float error = squaredError(head, decoded, strand[i]);
    worst = std::max(worst, error);
    holds &= error <= squared_limit_;
  }
  fit = {worst, holds};
}

void GuideEncoder::quantizeOctahedral(const HeadFrame& head, std::span<const Vec3> strand, uint32_t number,
                                      size_t first_edge, const StrandRun& run, int bits, Fit& fit) {
  int32_t root[3];
  Vec3 before = quantizeRoot(head, strand[0], number, run, root, fit);
  const size_t plane = run.vertex_count - run.strand_count;
  const size_t first_vertex = geometry_.offsets[run.first_strand + number];
  uint16_t* const edges = symbols_.edges.data() + first_edge;
  float worst = fit.squared_error;
  bool holds = fit.holds;
  for (size_t i = 1; i < strand.size(); ++i) {
    // Aimed from where the receiver has the vertex before: errors do not add up.
    const Vec3 edge = head.toHead(strand[i]) - before;
    const float squared_length = edge.squaredNorm();
    const bool has_direction = squared_length > 0 && squared_length < kMaxSquaredEdge;  // false for NaN
    const OctahedralPoint point = has_direction ? toOctahedral(edge, bits) : OctahedralPoint{};
    edges[i - 1] = point.u;
    edges[plane + i - 1] = point.v;
    before += geometry_.lengths[first_vertex + i] * fromOctahedral(point, bits);
    const float error = squaredError(head, before, strand[i]);
    worst = std::max(worst, error);
    holds &= error <= squared_limit_;
  }
  fit = {worst, holds};
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
    Fit fit;
    if (encoding == Encoding::kDelta16) {
      quantizeDelta(head, strand, s, first_edge, run, fit);
    } else {
      quantizeOctahedral(head, strand, s, first_edge, run, edgeBits(encoding), fit);
    }
    judge(s, fit);
    if (fit.holds) continue;
    for (size_t c = 0; c < 3; ++c) symbols_.roots[c * run.strand_count + s] = 0;
    for (size_t c = 0; c < static_cast<size_t>(symbols_.edge_planes); ++c)
      std::fill_n(symbols_.edges.begin() + static_cast<ptrdiff_t>(c * plane + first_edge), strand.size() - 1,
                  uint16_t{0});
  }
}

void GuideEncoder::judge(uint32_t number, const Fit& fit) {
  if (fit.holds)
    worst_squared_ = std::max(worst_squared_, fit.squared_error);
  else
    exact_.push_back(static_cast<uint16_t>(number));
}

void GuideEncoder::quantizeTangents(const GuideFrame& frame, const StrandRun& run,
                                    const TangentHistory* history) {
  shapeSymbols(geometry_, run, Encoding::kTangent, symbols_, strand_ends_);
  const HeadFrame head(frame.head);
  const Vec3* const positions = frame.positions.data() + run.first_vertex;
  wanted_.resize(run.vertex_count);
  decoded_.resize(run.vertex_count);
  directions_.resize(run.vertex_count - run.strand_count);
  for (uint32_t v = 0; v < run.vertex_count; ++v) wanted_[v] = head.toHead(positions[v]);
  for (uint32_t s = 0; s < run.strand_count; ++s) {
    const Vec3& rest = geometry_.roots[run.first_strand + s];
    const uint32_t v = geometry_.offsets[run.first_strand + s] - run.first_vertex;
    for (int c = 0; c < 3; ++c) {
      const int32_t moved = gridIndex(wanted_[v][c] - rest[c], tangent_step_), most = 32767;
      const int32_t symbol = std::clamp(moved, -most, most);
      symbols_.roots[static_cast<size_t>(c) * run.strand_count + s] = static_cast<uint16_t>(symbol);
      decoded_[v][c] = rest[c] + gridPosition(symbol, tangent_step_);
    }
  }
  walkTangents(geometry_, run, history, decoded_, directions_,
               [&](const tangent::Edge& edge, tangent::Lanes& x, tangent::Lanes& y) {
                 tangent::chooseOffsets(edge, wanted_, tangent_step_, symbols_, x, y);
               });
  exact_.clear();
  worst_squared_ = 0;
  uint32_t v = 0;
  for (uint32_t s = 0; s < run.strand_count; ++s) {
    Fit fit;
    for (const uint32_t end = geometry_.offsets[run.first_strand + s + 1] - run.first_vertex; v < end; ++v) {
      const float error = squaredError(head, decoded_[v], positions[v]);
      fit.squared_error = std::max(fit.squared_error, error);
      fit.holds &= error <= squared_limit_;  // false for NaN
    }
    judge(s, fit);
  }
}

void GuideEncoder::writePreamble(const GuideFrame& frame, const StrandRun& run, uint8_t mode, float step,
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
    const uint32_t first = geometry_.offsets[run.first_strand + s];
    const size_t length = (geometry_.offsets[run.first_strand + s + 1u] - first) * sizeof(Vec3);
    bytes.resize(bytes.size() + length);
    std::memcpy(bytes.data() + bytes.size() - length, frame.positions.data() + first, length);
  }
}

void GuideEncoder::writeSymbols(const GuideFrame& frame, const StrandRun& run, GuideChunk& chunk) {
  SymbolPrediction prediction;
  prediction.edge_bits = edgeBits(chunk.encoding);
  prediction.strand_ends = strand_ends_;
  prediction.along_strand = SymbolPacker::prefersAlongStrand(symbols_, prediction);
  writePreamble(frame, run, prediction.along_strand ? uint8_t{kAlongStrand} : uint8_t{0}, step_,
                chunk.payload);
  packer_.pack(symbols_, prediction, chunk.payload);
}

void GuideEncoder::encodeTangents(const GuideFrame& frame, const StrandRun& run, uint32_t index,
                                  GuideChunk& chunk) {
  TangentHistory* const own = histories_.empty() ? nullptr : &histories_[index];
  const TangentHistory* history = nullptr;
  // A gap in the numbers: others were casting, or readers may have changed.
  if (own && own->frame != 0 && own->frame + 1 == frame.frame) {
    // Each chunk stands alone at a time of its own, so that frames are about equally large.
    const uint64_t phase = frame.frame + uint64_t{index} * options_.key_interval / runs_.size();
    if (phase % options_.key_interval != 0) history = own;
  }
  quantizeTangents(frame, run, history);
  if (exact_.size() * kUnfitShare > run.strand_count) {
    if (own) own->frame = 0;  // nobody is told of it
    chunk.encoding = Encoding::kDelta16;
    return;
  }
  chunk.key_frame = history ? history->frame : 0;
  writePreamble(frame, run, 0, tangent_step_, chunk.payload);
  static const TangentSizes kNone;
  packTangents(symbols_, strand_ends_, history ? history->sizes : kNone, sizes_, chunk.payload);
  if (own) own->accept(frame.frame, history == nullptr, directions_, sizes_);
}

void GuideEncoder::encode(const GuideFrame& frame, uint32_t index, GuideChunk& chunk) {
  const StrandRun& run = runs_[index];
  fillGuideHeader(frame, runs_, index, chunk);
  chunk.encoding = encodingOf(options_.codec);
  chunk.key_frame = 0;
  if (frame.frame != reported_frame_) {
    reported_frame_ = frame.frame;
    report_.frame_bytes = report_.strands_sent_finer = 0;
    report_.worst_error = 0;
  }
  if (chunk.encoding == Encoding::kFloat32) {
    writeFloat32(frame, run, chunk);
    report_.frame_bytes += chunk.payload.size();
    return;
  }
  if (chunk.encoding == Encoding::kTangent) encodeTangents(frame, run, index, chunk);
  if (chunk.encoding != Encoding::kTangent) {
    quantize(frame, run, chunk.encoding);
    if (chunk.encoding != Encoding::kDelta16 && exact_.size() * kUnfitShare > run.strand_count) {
      chunk.encoding = Encoding::kDelta16;
      quantize(frame, run, chunk.encoding);
    }
    writeSymbols(frame, run, chunk);
  }
  if (chunk.payload.size() >= run.vertex_count * sizeof(Vec3)) {
    if (!histories_.empty()) histories_[index].frame = 0;  // nobody is told of it
    writeFloat32(frame, run, chunk);
    report_.strands_sent_finer += run.strand_count;
  } else {
    report_.strands_sent_finer += exact_.size();
    report_.worst_error = std::max(report_.worst_error, std::sqrt(double{worst_squared_}));
  }
  report_.frame_bytes += chunk.payload.size();
}

}  // namespace strandcast
