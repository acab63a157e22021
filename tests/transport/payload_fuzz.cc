#include "payload_fuzz.h"

#include <cstdlib>

#include "transport/codec/guide_decoder.h"

namespace strandcast {

bool fuzzPayload(const uint8_t* data, size_t size) {
  static const GroomDescription kGroom = hairGroom(40, [](size_t s) { return 1 + s % 20; });
  static const GuideChunk kKey = splitFrame(kGroom, payloadFrame(kGroom, 1), {Codec::kTemporal})[0];
  if (size == 0) return false;
  static GuideDecoder decoder;  // its zstd context takes longer to make than all the rest
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

}  // namespace strandcast
