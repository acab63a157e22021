#pragma once
#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace strandcast {

/// Feeds arbitrary bytes to a reader and what it returns to everything behind it. Bytes may be refused with
/// an Error that is one line and names the file; anything else that is wrong (an inconsistent result, another
/// exception, memory out of proportion) prints why and aborts, which fails a test as well as a fuzzer run.
/// Returns whether the bytes were accepted.
bool checkTfxReader(std::span<const std::byte> bytes);
bool checkHairReader(std::span<const std::byte> bytes);
bool checkObjStrandsReader(std::span<const std::byte> bytes);
bool checkUsdaReader(std::span<const std::byte> bytes);
bool checkObjMeshReader(std::span<const std::byte> bytes);
bool checkGltfReader(std::span<const std::byte> bytes);
bool checkGltfSkinReader(std::span<const std::byte> bytes);
bool checkSdfReader(std::span<const std::byte> bytes);

/// For the fuzzers: when the first argument that is no option names a folder, puts the seeds into it.
void writeFuzzSeeds(int argc, char** argv, const std::vector<std::vector<std::byte>>& seeds);

}  // namespace strandcast
