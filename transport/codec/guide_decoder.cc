#include "transport/codec/guide_decoder.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace strandcast {
namespace {

bool allFinite(std::span<const Vec3> positions) {
  // A float32 is not finite when all bits of its exponent are set; testing whole words costs almost nothing.
  const auto* bytes = reinterpret_cast<const uint8_t*>(positions.data());
  uint32_t any = 0;
  for (size_t i = 0; i < positions.size_bytes(); i += sizeof(uint32_t)) {
    uint32_t bits;
    std::memcpy(&bits, bytes + i, sizeof bits);
    any |= (bits & 0x7f800000u) == 0x7f800000u;
  }
  return any == 0;
}

bool isKnown(Encoding encoding) {
  return encoding <= Encoding::kOctahedral16 || encoding == Encoding::kTangent;
}

HeadFrame headOf(const GuideChunk& chunk) {
  Pose head{Vec3(chunk.head_position.data()), Quat::Identity()};
  head.rotation.coeffs() = Eigen::Map<const Eigen::Vector4f>(chunk.head_rotation.data());
  return HeadFrame(head);
}

}  // namespace

void GuideDecoder::setGroom(const StrandSet& guides) {
  geometry_ = GuideGeometry(guides);
  histories_.clear();
  history_strands_ = 0;
}

DecodeResult GuideDecoder::decode(const GuideChunk& chunk, std::span<Vec3> positions) {
  const StrandRun run{chunk.first_strand, chunk.strand_count, chunk.first_vertex, chunk.vertex_count};
  DecodeResult result = DecodeResult::kDamaged;
  if (chunk.encoding == Encoding::kFloat32) {
    if (chunk.payload.size() == positions.size_bytes() && chunk.key_frame == 0) {
      std::memcpy(static_cast<void*>(positions.data()), chunk.payload.data(), chunk.payload.size());
      result = DecodeResult::kDone;
    }
  } else if (isKnown(chunk.encoding) && readPreamble(chunk, run)) {
    const bool is_tangent = chunk.encoding == Encoding::kTangent;
    shapeSymbols(run, chunk.encoding, symbols_);
    result = is_tangent ? decodeTangents(chunk, run, positions) : decodeSymbols(chunk, run, positions);
  }
  if (result != DecodeResult::kDone || chunk.encoding == Encoding::kFloat32)
    return result == DecodeResult::kDone && !allFinite(positions) ? DecodeResult::kDamaged : result;

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
  if (exact_strands > 0) std::memcpy(preamble_.exact.data(), bytes.data(), exact_strands * sizeof(uint16_t));
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
  if ((preamble_.mode & ~(kAlongStrand | kInBlocks)) != 0 || chunk.key_frame != 0)
    return DecodeResult::kDamaged;
  const bool in_blocks = (preamble_.mode & kInBlocks) != 0;
  if (!(in_blocks ? unpacker_.unpackBlocks(preamble_.symbols, symbols_)
                  : unpacker_.decompress(preamble_.symbols, symbols_)))
    return DecodeResult::kDamaged;
  placeStrands(chunk, run, nullptr, nullptr, positions);
  return DecodeResult::kDone;
}

DecodeResult GuideDecoder::decodeTangents(const GuideChunk& chunk, const StrandRun& run,
                                          std::span<Vec3> positions) {
  if (preamble_.mode != kInBlocks || chunk.key_frame >= chunk.frame) return DecodeResult::kDamaged;
  const auto found = histories_.find(run.first_strand);
  const Memory* const memory =
      found != histories_.end() && found->second.strand_count == run.strand_count ? &found->second : nullptr;
  const TangentHistory* history = nullptr;
  if (chunk.key_frame != 0) {
    if (!memory || memory->history.frame != chunk.key_frame) return DecodeResult::kNoKey;
    history = &memory->history;
  }
  if (!unpacker_.unpackBlocks(preamble_.symbols, symbols_)) return DecodeResult::kDamaged;
  if (!memory) coder_.rest_directions(geometry_, run, rest_);
  placeStrands(chunk, run, memory ? &memory->rest : &rest_, history, positions);
  Memory& own = resetHistory(run);
  if (!memory) own.rest.swap(rest_);
  own.history.accept(chunk.frame, chunk.key_frame == 0, directions_);
  return DecodeResult::kDone;
}

void GuideDecoder::placeStrands(const GuideChunk& chunk, const StrandRun& run, const DirectionRows* rest,
                                const TangentHistory* history, std::span<Vec3> positions) {
  placeRoots(run, chunk.encoding);
  const HeadFrame head = headOf(chunk);
  const StrandDecoding job{.geometry = geometry_,
                           .run = run,
                           .head = head,
                           .roots = roots_.data(),
                           .step = preamble_.step,
                           .bits = edgeBits(chunk.encoding),
                           .along_strand = (preamble_.mode & kAlongStrand) != 0,
                           .rest = rest,
                           .history = history,
                           .edges = symbols_.edges.data(),
                           .directions = &directions_,
                           .positions = positions.data()};
  if (chunk.encoding == Encoding::kDelta16)
    coder_.decode_delta(job, rows_);
  else if (chunk.encoding == Encoding::kTangent)
    coder_.decode_tangents(job, rows_);
  else
    coder_.decode_octahedral(job, rows_);
}

void GuideDecoder::placeRoots(const StrandRun& run, Encoding encoding) {
  const float step = preamble_.step;
  roots_.resize(run.strand_count);
  for (uint32_t s = 0; s < run.strand_count; ++s) {
    const Vec3& rest = geometry_.roots[run.first_strand + s];
    for (int c = 0; c < 3; ++c) {
      const int32_t symbol =
          static_cast<int16_t>(symbols_.roots[static_cast<size_t>(c) * run.strand_count + s]);
      const int32_t index = restGridIndex(rest[c], step) + symbol;
      roots_[s][c] = encoding == Encoding::kTangent   ? rest[c] + gridPosition(symbol, step)
                     : encoding == Encoding::kDelta16 ? static_cast<float>(index)
                                                      : gridPosition(index, step);
    }
  }
}

GuideDecoder::Memory& GuideDecoder::resetHistory(const StrandRun& run) {
  // Runs of one publisher do not overlap; more strands than the groom has come from damage or malice.
  const auto old = histories_.find(run.first_strand);
  if (old != histories_.end()) history_strands_ -= old->second.strand_count;
  if (history_strands_ + run.strand_count > geometry_.roots.size()) {
    histories_.clear();
    history_strands_ = 0;
  }
  history_strands_ += run.strand_count;
  Memory& memory = histories_[run.first_strand];
  memory.strand_count = run.strand_count;
  return memory;
}

}  // namespace strandcast
