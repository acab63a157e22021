#include "tests/io/reader_checks.h"
#include "tests/io/sample_files.h"

// Run as: fuzz_usda FOLDER. The folder, which may be empty at first, receives the seeds and the findings.
extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  strandcast::writeFuzzSeeds(
      *argc, *argv,
      {strandcast::samples::usda(), strandcast::samples::usdaStage(), strandcast::samples::usdaLabels()});
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  strandcast::checkUsdaReader(std::as_bytes(std::span(data, size)));
  return 0;
}
