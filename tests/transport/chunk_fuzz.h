#pragma once
#include <cstddef>
#include <cstdint>

#include "fuzz_seeds.h"

namespace strandcast {

/// Reads chunks of all three kinds from arbitrary bytes, feeds them to the assemblers and aborts when one
/// hands out a message that breaks its promises. The fuzzer's entry point; the tests run it on seeded bytes.
/// Returns how many messages were completed.
size_t fuzzChunks(const uint8_t* data, size_t size);

/// Bytes of which some complete a message: small ones make chunks that fit each other.
std::vector<FuzzSeeds> chunkSeeds();

}  // namespace strandcast
