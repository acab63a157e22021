#pragma once
#include <cstddef>
#include <cstdint>

#include "fuzz_seeds.h"

namespace strandcast {

/// Reads bytes as each message of LCM, and what can be read as far as the assemblers. The fuzzer's entry
/// point; the tests run it on damaged messages. Returns how many messages could be read.
size_t fuzzMessages(const uint8_t* data, size_t size);

/// Of each message; guides in every codec.
std::vector<FuzzSeeds> messageSeeds();

}  // namespace strandcast
