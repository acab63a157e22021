#pragma once
#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace strandcast {

/// Passes arbitrary bytes to a reader, and its result to all later stages. A reader may refuse the bytes with
/// a one-line Error that names the file. Any other fault (an inconsistent result, another exception,
/// disproportionate memory) prints the reason and aborts, which fails a test as well as a fuzzer run. Returns
/// whether the bytes were accepted.
bool checkTfxReader(std::span<const std::byte> bytes);
bool checkHairReader(std::span<const std::byte> bytes);
bool checkObjStrandsReader(std::span<const std::byte> bytes);
bool checkUsdaReader(std::span<const std::byte> bytes);
bool checkObjMeshReader(std::span<const std::byte> bytes);
bool checkGltfReader(std::span<const std::byte> bytes);
bool checkGltfSkinReader(std::span<const std::byte> bytes);
bool checkSdfReader(std::span<const std::byte> bytes);

/// For the fuzzers: writes the seeds to the folder that is the first argument that is no option, if there is
/// one.
void writeFuzzSeeds(int argc, char** argv, const std::vector<std::vector<std::byte>>& seeds);

}  // namespace strandcast
