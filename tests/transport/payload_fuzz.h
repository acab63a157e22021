#pragma once
#include <cstddef>
#include <cstdint>

namespace strandcast {

/// Decodes arbitrary bytes as the payload of a chunk, its encoding and key frame chosen by the first byte,
/// behind a sound key frame; aborts when what comes out is not finite. The fuzzer's entry point. Returns
/// whether it was taken.
bool fuzzPayload(const uint8_t* data, size_t size);

}  // namespace strandcast
