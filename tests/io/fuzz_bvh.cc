#include <cmath>
#include <cstdlib>

#include "core/error.h"
#include "io/bvh.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  try {
    const strandcast::BvhClip clip = strandcast::readBvh(std::as_bytes(std::span(data, size)), "fuzz.bvh");
    if (clip.values.size() != clip.frames * clip.channels) std::abort();
    if (!std::isfinite(clip.guessedUnit())) std::abort();
    for (size_t j = 0; j < clip.joints.size(); ++j) clip.pose(j, clip.frames - 1);
  } catch (const strandcast::Error&) {
  }
  return 0;
}
