#include "gpu_compute/driver.h"

#include <epoxy/gl.h>

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

Subgroups subgroupsOfDevice() {
  Subgroups out;
  if (const GLubyte* vendor = glGetString(GL_VENDOR)) out.vendor = reinterpret_cast<const char*>(vendor);
  if (!epoxy_has_gl_extension("GL_KHR_shader_subgroup")) return out;
  GLint stages = 0, features = 0;
  glGetIntegerv(GL_SUBGROUP_SIZE_KHR, &out.size);
  glGetIntegerv(GL_SUBGROUP_SUPPORTED_STAGES_KHR, &stages);
  glGetIntegerv(GL_SUBGROUP_SUPPORTED_FEATURES_KHR, &features);
  out.shuffles =
      (stages & GL_COMPUTE_SHADER_BIT) != 0 && (features & GL_SUBGROUP_FEATURE_SHUFFLE_BIT_KHR) != 0;
  return out;
}

bool isOneSubgroup(const Subgroups& subgroups, int workgroup) {
  return subgroups.shuffles && subgroups.size == workgroup && subgroups.vendor.starts_with("NVIDIA");
}

}  // namespace strandcast::gpu
