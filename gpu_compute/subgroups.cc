#include "gpu_compute/subgroups.h"

#include <epoxy/gl.h>

namespace strandcast::gpu {

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
