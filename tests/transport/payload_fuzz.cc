#include "payload_fuzz.h"

#include <cstdlib>

#include "transport/codec/guide_decoder.h"

namespace strandcast {
namespace {

GroomDescription payloadGroom() {
  return hairGroom(40, [](size_t s) { return 1 + s % 20; });
}

}  // namespace

bool fuzzPayload(const uint8_t* data, size_t size) {
  static const GroomDescription kGroom = payloadGroom();
  static const GuideChunk kKey = splitFrame(kGroom, payloadFrame(kGroom, 1), {Codec::kTemporal})[0];
  if (size == 0) return false;
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
  return seeds;
}

}  // namespace strandcast
