#include "transport/codec/guide_decoder.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "transport/codec/octahedral.h"

namespace strandcast {
namespace {

bool allFinite(std::span<const Vec3> positions) {
  // A float32 is not finite when all bits of its exponent are set; in whole words this costs next to nothing.
  const auto* bytes = reinterpret_cast<const uint8_t*>(positions.data());
  uint32_t any = 0;
  for (size_t i = 0; i < positions.size_bytes(); i += sizeof(uint32_t)) {
    uint32_t bits;
    std::memcpy(&bits, bytes + i, sizeof bits);
    any |= (bits & 0x7f800000u) == 0x7f800000u;
  }
  return any == 0;
}

int32_t signed16(uint16_t symbol) { return static_cast<int16_t>(symbol); }

}  // namespace

void GuideDecoder::setGroom(const StrandSet& guides) {
  geometry_ = GuideGeometry(guides);
  memories_.clear();
  remembered_strands_ = 0;
}

DecodeResult GuideDecoder::decode(const GuideChunk& chunk, std::span<Vec3> positions) {
  const StrandRun run{chunk.first_strand, chunk.strand_count, chunk.first_vertex, chunk.vertex_count};
  DecodeResult result = DecodeResult::kDamaged;
  if (chunk.encoding == Encoding::kFloat32) {
    if (chunk.payload.size() == positions.size_bytes() && chunk.key_frame == 0) {
      std::memcpy(static_cast<void*>(positions.data()), chunk.payload.data(), chunk.payload.size());
      result = DecodeResult::kDone;
    }
  } else if (chunk.encoding <= Encoding::kTangent && readPreamble(chunk, run)) {
    const bool is_tangent = chunk.encoding == Encoding::kTangent;
    shapeSymbols(geometry_, run, chunk.encoding, symbols_, strand_ends_);
    result = is_tangent ? decodeTangents(chunk, run, positions) : decodeSymbols(chunk, run, positions);
  }
  if (result != DecodeResult::kDone || chunk.encoding == Encoding::kFloat32)
    return result == DecodeResult::kDone && !allFinite(positions) ? DecodeResult::kDamaged : result;

  Pose head{Vec3(chunk.head_position.data()), Quat::Identity()};
  head.rotation.coeffs() = Eigen::Map<const Eigen::Vector4f>(chunk.head_rotation.data());
  const HeadFrame frame(head);
  for (Vec3& position : positions) position = frame.toWorld(position);
  const uint8_t* exact = preamble_.exact_positions.data();
  for (const uint16_t number : preamble_.exact) {
    const uint32_t s = run.first_strand + number, first = geometry_.offsets[s];
    const size_t length = (geometry_.offsets[s + 1] - first) * sizeof(Vec3);
    std::memcpy(static_cast<void*>(positions.data() + (first - run.first_vertex)), exact, length);
    exact += length;
  }
  return allFinite(positions) ? DecodeResult::kDone : DecodeResult::kDamaged;
}

bool GuideDecoder::readPreamble(const GuideChunk& chunk, const StrandRun& run) {
  std::span<const uint8_t> bytes = chunk.payload;
  if (bytes.size() < kPayloadHeadBytes) return false;
  uint16_t exact_strands;
  preamble_.mode = bytes[0];
  std::memcpy(&exact_strands, bytes.data() + 2, sizeof exact_strands);
  std::memcpy(&preamble_.step, bytes.data() + 4, sizeof preamble_.step);
  bytes = bytes.subspan(kPayloadHeadBytes);
  if (!(preamble_.step > 0 && preamble_.step <= kMaxGridStep) || exact_strands > run.strand_count ||
      bytes.size() < exact_strands * sizeof(uint16_t)) {
    return false;
  }
  preamble_.exact.resize(exact_strands);
  if (exact_strands > 0)
    std::memcpy(preamble_.exact.data(), bytes.data(), exact_strands * sizeof(uint16_t));
  bytes = bytes.subspan(exact_strands * sizeof(uint16_t));
  size_t exact_bytes = 0;
  for (size_t i = 0; i < exact_strands; ++i) {
    const uint16_t s = preamble_.exact[i];
    if (s >= run.strand_count || (i > 0 && s <= preamble_.exact[i - 1])) return false;
    exact_bytes += (geometry_.offsets[run.first_strand + s + 1u] - geometry_.offsets[run.first_strand + s]) *
                   sizeof(Vec3);
  }
  if (bytes.size() < exact_bytes) return false;
  preamble_.exact_positions = bytes.first(exact_bytes);
  preamble_.symbols = bytes.subspan(exact_bytes);
  return true;
}

DecodeResult GuideDecoder::decodeSymbols(const GuideChunk& chunk, const StrandRun& run,
                                         std::span<Vec3> positions) {
  if (preamble_.mode > kAlongStrand || chunk.key_frame != 0) return DecodeResult::kDamaged;
  SymbolPrediction prediction;
  prediction.along_strand = (preamble_.mode & kAlongStrand) != 0;
  prediction.edge_bits = edgeBits(chunk.encoding);
  prediction.strand_ends = strand_ends_;
  if (!unpacker_.unpack(preamble_.symbols, prediction, symbols_)) return DecodeResult::kDamaged;
  rebuild(run, chunk.encoding, positions);
  return DecodeResult::kDone;
}

DecodeResult GuideDecoder::decodeTangents(const GuideChunk& chunk, const StrandRun& run,
                                          std::span<Vec3> positions) {
  if (preamble_.mode != 0 || chunk.key_frame >= chunk.frame) return DecodeResult::kDamaged;
  const TangentHistory* history = nullptr;
  if (chunk.key_frame != 0) {
    const auto memory = memories_.find(run.first_strand);
    if (memory == memories_.end() || memory->second.history.frame != chunk.key_frame ||
        memory->second.strand_count != run.strand_count)
      return DecodeResult::kNoKey;
    history = &memory->second.history;
  }
  static const TangentSizes kNone;
  if (!unpackTangents(preamble_.symbols, strand_ends_, history ? history->sizes : kNone, sizes_, symbols_))
    return DecodeResult::kDamaged;
  for (uint32_t s = 0; s < run.strand_count; ++s) {
    Vec3& root = positions[geometry_.offsets[run.first_strand + s] - run.first_vertex];
    for (int c = 0; c < 3; ++c)
      root[c] =
          geometry_.roots[run.first_strand + s][c] + gridPosition(rootSymbol(run, s, c), preamble_.step);
  }
  const size_t plane = run.vertex_count - run.strand_count;
  directions_.resize(plane);
  walkTangents(geometry_, run, history, positions, directions_,
               [&](const tangent::Edge& edge, tangent::Lanes& x, tangent::Lanes& y) {
                 tangent::loadOffsets(edge, symbols_, preamble_.step, x, y);
               });
  remember(run).history.accept(chunk.frame, chunk.key_frame == 0, directions_, sizes_);
  return DecodeResult::kDone;
}

int32_t GuideDecoder::rootSymbol(const StrandRun& run, uint32_t number, int component) const {
  return signed16(symbols_.roots[static_cast<size_t>(component) * run.strand_count + number]);
}

void GuideDecoder::rebuild(const StrandRun& run, Encoding encoding, std::span<Vec3> positions) const {
  const size_t plane = run.vertex_count - run.strand_count;
  const int bits = edgeBits(encoding);
  const float step = preamble_.step;
  const uint16_t* const edges = symbols_.edges.data();
  for (uint32_t s = 0; s < run.strand_count; ++s) {
    const uint32_t strand = run.first_strand + s, first = geometry_.offsets[strand];
    const uint32_t count = geometry_.offsets[strand + 1] - first;
    Vec3* const out = positions.data() + (first - run.first_vertex);
    int32_t index[3];
    for (int c = 0; c < 3; ++c) {
      index[c] = gridIndex(geometry_.roots[strand][c], step) + rootSymbol(run, s, c);
    }
    Vec3 at(gridPosition(index[0], step), gridPosition(index[1], step), gridPosition(index[2], step));
    out[0] = at;
    size_t edge = first - run.first_vertex - s;
    if (encoding == Encoding::kDelta16) {
      for (uint32_t i = 1; i < count; ++i, ++edge) {
        for (size_t c = 0; c < 3; ++c) index[c] += signed16(edges[c * plane + edge]);
        out[i] =
            Vec3(gridPosition(index[0], step), gridPosition(index[1], step), gridPosition(index[2], step));
      }
    } else {
      for (uint32_t i = 1; i < count; ++i, ++edge) {
        at += geometry_.lengths[first + i] * fromOctahedral({edges[edge], edges[plane + edge]}, bits);
        out[i] = at;
      }
    }
  }
}

GuideDecoder::Memory& GuideDecoder::remember(const StrandRun& run) {
  // Runs of one publisher do not overlap; what claims to be more than the groom is damaged or malicious.
  const auto old = memories_.find(run.first_strand);
  if (old != memories_.end()) remembered_strands_ -= old->second.strand_count;
  if (remembered_strands_ + run.strand_count > geometry_.roots.size()) {
    memories_.clear();
    remembered_strands_ = 0;
  }
  remembered_strands_ += run.strand_count;
  Memory& memory = memories_[run.first_strand];
  memory.strand_count = run.strand_count;
  return memory;
}

}  // namespace strandcast
