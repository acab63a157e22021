#pragma once
#include <cstddef>
#include <cstdint>

#include "fuzz_seeds.h"
#include "moving_hair.h"

namespace strandcast {

/// The first byte of an input is kFuzzedHairs, or encoding + kFuzzedEncodings * key_frame, which includes an
/// unknown encoding.
inline constexpr int kFuzzedEncodings = 6;
inline constexpr uint8_t kFuzzedHairs = 255;

/// Hair with one strand far away, so that it is sent as float32.
inline GuideFrame payloadFrame(const GroomDescription& groom, uint64_t number) {
  GuideFrame frame = hairFrame(groom, number);
  frame.positions[groom.guides.offsets[7]].x() += 900;
  return frame;
}

/// Decodes arbitrary bytes as the payload of a chunk of payloadFrame() 2, after a valid one of frame 1; or as
/// that of bound hairs, behind the chunk's arrays (uint32), hair_count and vertex_count. Aborts when a
/// decoded position is not finite or hairs would not be announced. Entry point of the fuzzer. Returns whether
/// the payload was accepted.
bool fuzzPayload(const uint8_t* data, size_t size);

/// For hairs and each codec, payloads of payloadFrame() 1 and 2 as fuzzPayload() expects
/// them.
std::vector<FuzzSeeds> payloadSeeds();

}  // namespace strandcast
