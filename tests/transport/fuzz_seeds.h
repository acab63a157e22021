#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace strandcast {

/// Valid inputs of one fuzzer, from which the fuzzer and the tests with random damage start. `of` names their
/// type: "delta16", "groom".
struct FuzzSeeds {
  std::string of;
  std::vector<std::vector<uint8_t>> inputs;
};

}  // namespace strandcast
