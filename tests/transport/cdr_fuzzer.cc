#include <optional>

#include "fuzzed_part.h"
#include "message_fuzz.h"

namespace {
std::optional<strandcast::FuzzedPart> part;
}

extern "C" int LLVMFuzzerInitialize(int* count, char*** arguments) {
  part.emplace(*count, *arguments, strandcast::cdrSeeds(), 1);
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::span<const uint8_t> input = part->input(data, size);
  strandcast::fuzzCdr(input.data(), input.size());
  return 0;
}
