#include <cstdint>
#include <string>

#include "core/error.h"
#include "options/settings.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  strandcast::Settings settings;
  try {
    strandcast::readConfigText(std::string(reinterpret_cast<const char*>(data), size), "fuzz.toml", settings);
  } catch (const strandcast::Error&) {
  }
  return 0;
}
