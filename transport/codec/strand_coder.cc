// Compiled once per instruction set: Highway's foreach_target includes this file again for each.
#include "transport/codec/strand_coder.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "kernels/highway_targets.h"
#include "transport/codec/bit_blocks.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "transport/codec/strand_coder.cc"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace strandcast::codec::HWY_NAMESPACE {

// The order matters.
// clang-format off
#include "kernels/lanes_highway.inl"
#include "transport/codec/quantization.inl"
#include "transport/codec/strand_walks.inl"
#include "transport/codec/bit_blocks.inl"
#include "kernels/end_lanes.inl"
// clang-format on

void subtract(const uint16_t* symbols, size_t count, bool along, int bits, uint16_t* residuals) {
  if (count == 0) return;
  residuals[0] = signExtended(symbols[0], bits);
  for (size_t i = 1; i < count; ++i)
    residuals[i] = signExtended(static_cast<uint16_t>(symbols[i] - (along ? symbols[i - 1] : 0)), bits);
}

void fold(const uint16_t* residuals, size_t count, uint8_t* low, uint8_t* high) {
  for (size_t i = 0; i < count; ++i) {
    const uint16_t folded = zigzag(residuals[i]);
    low[i] = static_cast<uint8_t>(folded);
    high[i] = static_cast<uint8_t>(folded >> 8);
  }
}

void unfold(const uint8_t* low, const uint8_t* high, size_t count, uint16_t* symbols) {
  for (size_t i = 0; i < count; ++i) symbols[i] = unzigzag(static_cast<uint16_t>(low[i] | high[i] << 8));
}

StrandCoder coder() {
  StrandCoder made;
  made.encode_delta = &encodeDelta;
  made.encode_octahedral = &encodeOctahedral;
  made.encode_tangents = &encodeTangents;
  made.decode_delta = &decodeDelta;
  made.decode_octahedral = &decodeOctahedral;
  made.decode_tangents = &decodeTangents;
  made.rest_directions = &restDirections;
  made.pack = &packNumbers;
  made.unpack = &unpackNumbers;
  made.subtract = &subtract;
  made.fold = &fold;
  made.unfold = &unfold;
  return made;
}

}  // namespace strandcast::codec::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace strandcast {
namespace codec {

HWY_EXPORT(coder);

}  // namespace codec

std::vector<StrandCoder> runnableStrandCoders() {
  std::vector<StrandCoder> out;
  // HWY_TARGETS are the targets compiled. Lower bits are better ones.
  for (int64_t left = hwy::SupportedTargets() & HWY_TARGETS; left != 0; left &= left - 1) {
    const int64_t target = left & -left;
    hwy::ChosenTarget chosen;  // a local one: the process-wide choice is unchanged
    chosen.Update(target);
    out.push_back(codec::HWY_DISPATCH_TABLE(coder)[chosen.GetIndex()]());
    out.back().name = hwy::TargetName(target);
  }
  return out;
}

const StrandCoder& strandCoder() {
  static const StrandCoder best = runnableStrandCoders().front();
  return best;
}

}  // namespace strandcast
#endif  // HWY_ONCE
