#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace strandcast {

/// Sound inputs of one fuzzer: where it, and the tests that damage them at random, begin. `of` names what
/// they are: "delta16", "groom".
struct FuzzSeeds {
  std::string of;
  std::vector<std::vector<uint8_t>> inputs;
};

}  // namespace strandcast
