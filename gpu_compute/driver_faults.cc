#include "gpu_compute/driver_faults.h"

#include <charconv>
#include <cstdlib>
#include <string_view>

namespace strandcast::gpu {
namespace {

constexpr int kFirstGoodZink = 25;  // Mesa's major version

/// Mesa's major version, 22 of "4.6 (Core Profile) Mesa 22.3.6"; 0 if the text names none.
int mesaMajor(std::string_view version) {
  constexpr std::string_view kMesa = "Mesa ";
  const size_t at = version.find(kMesa);
  int major = 0;
  if (at != std::string_view::npos)
    std::from_chars(version.data() + at + kMesa.size(), version.data() + version.size(), major);
  return major;
}

bool allowsUntestedDriver() {
  const char* const text = std::getenv(kUntestedVariable);
  return text != nullptr && std::string_view(text) == "1";
}

}  // namespace

std::string driverFault(const std::string& renderer, const std::string& version) {
  if (!renderer.starts_with("zink") || mesaMajor(version) >= kFirstGoodZink || allowsUntestedDriver())
    return {};
  return "zink before Mesa 25 ends the process where it builds this backend's programs (" + renderer + ", " +
         version + "); use the GPU's own OpenGL driver, or set " + kUntestedVariable + "=1 to try";
}

}  // namespace strandcast::gpu
