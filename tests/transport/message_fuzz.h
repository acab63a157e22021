#pragma once
#include <cstddef>
#include <cstdint>

#include "fuzz_seeds.h"

namespace strandcast {

/// Decodes bytes as each LCM message, and feeds what decodes to the assemblers. Entry point of the fuzzer;
/// the tests run it on damaged messages. Returns the number of messages decoded.
size_t fuzzMessages(const uint8_t* data, size_t size);

/// Seeds of each message; guides in every codec.
std::vector<FuzzSeeds> messageSeeds();

/// As both, for the samples of DDS in CDR. The first byte selects the type of the message.
size_t fuzzCdr(const uint8_t* data, size_t size);
std::vector<FuzzSeeds> cdrSeeds();

}  // namespace strandcast
