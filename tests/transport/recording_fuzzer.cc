#include "recording_fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  strandcast::fuzzRecording(data, size);
  return 0;
}
