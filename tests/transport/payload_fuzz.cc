#include "payload_fuzz.h"

#include <array>
#include <cstdlib>

#include "bound_hairs.h"
#include "transport/codec/guide_decoder.h"
#include "transport/codec/hair_codec.h"

namespace strandcast {
namespace {

GroomDescription payloadGroom() {
  return hairGroom(40, [](size_t s) { return 1 + s % 20; });
}

using HairHead = std::array<uint32_t, 3>;  // arrays, hair_count, vertex_count

HairDescription payloadHairs(const StrandSet& guides, bool with_arrays) {
  return boundHairs(
      guides, 60, [](size_t h) { return 2 + h % 12; }, with_arrays);
}

bool fuzzHairs(std::span<const uint8_t> bytes) {
  static const GroomDescription kGroom = payloadGroom();
  static const HairChunk kSound =
      encodeHairs(payloadHairs(kGroom.guides, true), kGroom.guides, kDefaultHairError)[0];
  HairHead head;
  if (bytes.size() < sizeof head) return false;
  std::memcpy(head.data(), bytes.data(), sizeof head);
  HairChunk chunk = kSound;
  chunk.arrays = head[0];
  chunk.hair_count = head[1];
  chunk.vertex_count = head[2];
  chunk.payload.assign(bytes.begin() + sizeof head, bytes.end());
  HairDescription hairs;
  const bool is_decoded = decodeHairs(chunk, kGroom.guides, hairs);
  // A byte of the payload holds 16 numbers at most; a vector may have room for twice what it has.
  const size_t most = 2 * 16 * chunk.payload.size() + 16;
  for (const size_t room : {hairs.hairs.positions.capacity(), hairs.hairs.offsets.capacity(),
                            hairs.hairs.radii.capacity(), hairs.bindings.capacity(), hairs.ids.capacity()})
    if (room > most) std::abort();
  if (!is_decoded) return false;
  checkHairs(hairs, kGroom.guides, "a decoded payload");  // throws on what an encoder would refuse
  if (hairs.hairs.strands() != chunk.hair_count || hairs.hairs.vertices() != chunk.vertex_count) std::abort();
  return true;
}

FuzzSeeds hairSeeds() {
  const GroomDescription groom = payloadGroom();
  FuzzSeeds seeds{"hairs", {}};
  for (const bool with_arrays : {true, false}) {
    const HairChunk chunk =
        encodeHairs(payloadHairs(groom.guides, with_arrays), groom.guides, kDefaultHairError)[0];
    const HairHead head{chunk.arrays, chunk.hair_count, chunk.vertex_count};
    std::vector<uint8_t>& input = seeds.inputs.emplace_back(1 + sizeof head, kFuzzedHairs);
    std::memcpy(input.data() + 1, head.data(), sizeof head);
    input.insert(input.end(), chunk.payload.begin(), chunk.payload.end());
  }
  return seeds;
}

}  // namespace

bool fuzzPayload(const uint8_t* data, size_t size) {
  static const GroomDescription kGroom = payloadGroom();
  static const GuideChunk kKey = splitFrame(kGroom, payloadFrame(kGroom, 1), {Codec::kTemporal})[0];
  if (size == 0) return false;
  if (data[0] == kFuzzedHairs) return fuzzHairs({data + 1, size - 1});
  static GuideDecoder decoder;  // static, because creating its zstd context takes longer than all else
  decoder.setGroom(kGroom.guides);
  std::vector<Vec3> positions(kGroom.guides.vertices());
  if (decoder.decode(kKey, positions) != DecodeResult::kDone) std::abort();
  GuideChunk chunk = kKey;
  chunk.frame = 2;
  chunk.encoding = static_cast<Encoding>(data[0] % kFuzzedEncodings);
  chunk.key_frame = data[0] / kFuzzedEncodings % 3;
  chunk.payload.assign(data + 1, data + size);
  if (decoder.decode(chunk, positions) != DecodeResult::kDone) return false;
  for (const Vec3& position : positions) {
    if (!position.allFinite()) std::abort();
  }
  return true;
}

std::vector<FuzzSeeds> payloadSeeds() {
  const GroomDescription groom = payloadGroom();
  std::vector<FuzzSeeds> seeds;
  for (const CodecInfo& info : codecList()) {
    seeds.push_back({info.name, {}});
    for (const bool zstd : {false, true}) {
      CodecOptions options{info.codec};
      options.zstd = zstd;
      GuideEncoder encoder(options);
      encoder.setGroom(groom.guides);
      for (uint64_t number = 1; number <= 2; ++number) {
        GuideChunk chunk;
        encoder.encode(payloadFrame(groom, number), 0, chunk);
        std::vector<uint8_t>& input = seeds.back().inputs.emplace_back(std::move(chunk.payload));
        const auto head =
            static_cast<uint8_t>(static_cast<uint32_t>(chunk.encoding) + kFuzzedEncodings * chunk.key_frame);
        input.insert(input.begin(), head);
      }
    }
  }
  seeds.push_back(hairSeeds());
  return seeds;
}

}  // namespace strandcast
