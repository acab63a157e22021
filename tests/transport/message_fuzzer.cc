#include "message_fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  strandcast::fuzzMessages(data, size);
  return 0;
}
