#include <optional>

#include "chunk_fuzz.h"
#include "fuzzed_part.h"

namespace {
std::optional<strandcast::FuzzedPart> part;
}

extern "C" int LLVMFuzzerInitialize(int* count, char*** arguments) {
  part.emplace(*count, *arguments, strandcast::chunkSeeds(), 0);
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::span<const uint8_t> input = part->input(data, size);
  strandcast::fuzzChunks(input.data(), input.size());
  return 0;
}
