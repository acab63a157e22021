#include <cstdint>
#include <string>

#include "core/error.h"
#include "options/settings.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  strandcast::Settings settings;
  try {
    strandcast::readConfigText(text, "fuzz.toml", settings);
  } catch (const strandcast::Error&) {
  }
  try {
    strandcast::readCharactersText(text, "fuzz.toml");
  } catch (const strandcast::Error&) {
  }
  return 0;
}
