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
  keys_.clear();
  kept_strands_ = 0;
}

DecodeResult GuideDecoder::decode(const GuideChunk& chunk, std::span<Vec3> positions) {
  const StrandRun run{chunk.first_strand, chunk.strand_count, chunk.first_vertex, chunk.vertex_count};
  DecodeResult result = DecodeResult::kDamaged;
  switch (chunk.encoding) {
    case Encoding::kFloat32:
      if (chunk.payload.size() == positions.size_bytes() && chunk.key_frame == 0) {
        std::memcpy(static_cast<void*>(positions.data()), chunk.payload.data(), chunk.payload.size());
        result = DecodeResult::kDone;
      }
      break;
    case Encoding::kDelta16:
    case Encoding::kOctahedral12:
    case Encoding::kOctahedral16:
      result = decodeSymbols(chunk, run, positions);
      break;
  }
  return result == DecodeResult::kDone && !allFinite(positions) ? DecodeResult::kDamaged : result;
}

DecodeResult GuideDecoder::decodeSymbols(const GuideChunk& chunk, const StrandRun& run,
                                         std::span<Vec3> positions) {
  std::span<const uint8_t> bytes = chunk.payload;
  if (bytes.size() < kPayloadHeadBytes) return DecodeResult::kDamaged;
  const uint8_t mode = bytes[0];
  uint16_t exact_strands;
  float step;
  std::memcpy(&exact_strands, bytes.data() + 2, sizeof exact_strands);
  std::memcpy(&step, bytes.data() + 4, sizeof step);
  bytes = bytes.subspan(kPayloadHeadBytes);
  const bool from_key = (mode & kFromKey) != 0, keeps = (mode & kKeep) != 0;
  if (mode > (kAlongStrand | kFromKey | kKeep) || (from_key && keeps) || from_key != (chunk.key_frame != 0) ||
      !(step > 0 && step <= kMaxGridStep) || exact_strands > run.strand_count ||
      bytes.size() < exact_strands * sizeof(uint16_t)) {
    return DecodeResult::kDamaged;
  }
  const uint8_t* const exact = bytes.data();
  const auto exactStrand = [&](size_t i) {
    uint16_t strand;
    std::memcpy(&strand, exact + i * sizeof strand, sizeof strand);
    return strand;
  };
  bytes = bytes.subspan(exact_strands * sizeof(uint16_t));
  size_t exact_bytes = 0;
  for (size_t i = 0; i < exact_strands; ++i) {
    const uint16_t s = exactStrand(i);
    if (s >= run.strand_count || (i > 0 && s <= exactStrand(i - 1))) return DecodeResult::kDamaged;
    exact_bytes += (geometry_.offsets[run.first_strand + s + 1u] - geometry_.offsets[run.first_strand + s]) *
                   sizeof(Vec3);
  }
  if (bytes.size() < exact_bytes) return DecodeResult::kDamaged;
  const uint8_t* exact_positions = bytes.data();
  bytes = bytes.subspan(exact_bytes);

  shapeSymbols(geometry_, run, chunk.encoding, symbols_, strand_ends_);
  SymbolPrediction prediction;
  prediction.along_strand = (mode & kAlongStrand) != 0;
  prediction.edge_bits = edgeBits(chunk.encoding);
  prediction.strand_ends = strand_ends_;
  if (from_key) {
    const auto key = keys_.find(run.first_strand);
    if (key == keys_.end() || key->second.frame != chunk.key_frame ||
        key->second.encoding != chunk.encoding || key->second.run.strand_count != run.strand_count)
      return DecodeResult::kNoKey;
    prediction.key = &key->second.symbols;
  }
  if (!unpacker_.unpack(bytes, prediction, symbols_)) return DecodeResult::kDamaged;
  Pose head{Vec3(chunk.head_position.data()), Quat::Identity()};
  head.rotation.coeffs() = Eigen::Map<const Eigen::Vector4f>(chunk.head_rotation.data());
  rebuild(head, run, chunk.encoding, step, positions);
  for (size_t i = 0; i < exact_strands; ++i) {
    const uint32_t s = run.first_strand + exactStrand(i), first = geometry_.offsets[s];
    const size_t length = (geometry_.offsets[s + 1] - first) * sizeof(Vec3);
    std::memcpy(static_cast<void*>(positions.data() + (first - run.first_vertex)), exact_positions, length);
    exact_positions += length;
  }
  if (keeps) keep(chunk, run);
  return DecodeResult::kDone;
}

void GuideDecoder::rebuild(const Pose& head_pose, const StrandRun& run, Encoding encoding, float step,
                           std::span<Vec3> positions) const {
  const HeadFrame head(head_pose);
  const size_t plane = run.vertex_count - run.strand_count;
  const int bits = edgeBits(encoding);
  const uint16_t* const edges = symbols_.edges.data();
  for (uint32_t s = 0; s < run.strand_count; ++s) {
    const uint32_t strand = run.first_strand + s, first = geometry_.offsets[strand];
    const uint32_t count = geometry_.offsets[strand + 1] - first;
    Vec3* const out = positions.data() + (first - run.first_vertex);
    int32_t index[3];
    for (int c = 0; c < 3; ++c) {
      index[c] = gridIndex(geometry_.roots[strand][c], step) +
                 signed16(symbols_.roots[static_cast<size_t>(c) * run.strand_count + s]);
    }
    Vec3 at(gridPosition(index[0], step), gridPosition(index[1], step), gridPosition(index[2], step));
    out[0] = head.toWorld(at);
    size_t edge = first - run.first_vertex - s;
    if (encoding == Encoding::kDelta16) {
      for (uint32_t i = 1; i < count; ++i, ++edge) {
        for (size_t c = 0; c < 3; ++c) index[c] += signed16(edges[c * plane + edge]);
        at = Vec3(gridPosition(index[0], step), gridPosition(index[1], step), gridPosition(index[2], step));
        out[i] = head.toWorld(at);
      }
    } else {
      for (uint32_t i = 1; i < count; ++i, ++edge) {
        at += geometry_.lengths[first + i] * fromOctahedral({edges[edge], edges[plane + edge]}, bits);
        out[i] = head.toWorld(at);
      }
    }
  }
}

void GuideDecoder::keep(const GuideChunk& chunk, const StrandRun& run) {
  // Runs of one publisher do not overlap; what claims to be more than the groom is damaged or malicious.
  const auto old = keys_.find(run.first_strand);
  if (old != keys_.end()) kept_strands_ -= old->second.run.strand_count;
  if (kept_strands_ + run.strand_count > geometry_.roots.size()) {
    keys_.clear();
    kept_strands_ = 0;
  }
  kept_strands_ += run.strand_count;
  Key& key = keys_[run.first_strand];
  key.frame = chunk.frame;
  key.encoding = chunk.encoding;
  key.run = run;
  std::swap(key.symbols, symbols_);
}

}  // namespace strandcast
