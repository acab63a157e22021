#pragma once
#include <cstddef>
#include <cstdint>

#include "fuzz_seeds.h"

namespace strandcast {

/// Reads chunks of all kinds from arbitrary bytes, feeds them to the assemblers, and aborts when one returns
/// a message that violates its guarantees. Entry point of the fuzzer; the tests run it on seeded bytes.
/// Returns the number of messages completed.
size_t fuzzChunks(const uint8_t* data, size_t size);

/// Inputs of which some complete a message: small numbers make chunks that fit each other.
std::vector<FuzzSeeds> chunkSeeds();

}  // namespace strandcast
