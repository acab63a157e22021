#pragma once
#include <cstddef>
#include <cstdint>

#include "fuzz_seeds.h"
#include "moving_hair.h"

namespace strandcast {

/// What the first byte chooses: the encoding, or one that there is none of, and the frame that it builds on.
inline constexpr int kFuzzedEncodings = 6;

/// Hair one strand of which is far away, so that it is sent as it is.
inline GuideFrame payloadFrame(const GroomDescription& groom, uint64_t number) {
  GuideFrame frame = hairFrame(groom, number);
  frame.positions[groom.guides.offsets[7]].x() += 900;
  return frame;
}

/// Decodes arbitrary bytes as the payload of a chunk of payloadFrame() 2, behind a sound one of frame 1;
/// aborts when what comes out is not finite. The fuzzer's entry point. Returns whether it was taken.
bool fuzzPayload(const uint8_t* data, size_t size);

/// Of each codec, payloads of payloadFrame() 1 and 2 as fuzzPayload() takes them.
std::vector<FuzzSeeds> payloadSeeds();

}  // namespace strandcast
