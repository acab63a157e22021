#pragma once
#include <string>

namespace strandcast::gpu {

/// What a driver says of the subgroups of its compute shaders (GL_KHR_shader_subgroup).
struct Subgroups {
  std::string vendor;     ///< GL_VENDOR
  int size = 0;           ///< GL_SUBGROUP_SIZE_KHR; 0 without the extension
  bool shuffles = false;  ///< compute shaders have them, and subgroupShuffle()
};
/// Of the current context.
Subgroups subgroupsOfDevice();

/// Whether a workgroup of `workgroup` invocations is certainly one subgroup whose invocations can read each
/// other's registers. Not on a size that is larger: a shader that enables subgroups is then compiled for that
/// size (RDNA: wave64), with invocations that have nothing to do. Nor on a size that is only announced:
/// OpenGL does not promise that all subgroups are as large, and Mesa's driver for Intel announces 32 and
/// compiles for 8 or 16 where registers are short. NVIDIA's hardware has no other size.
bool isOneSubgroup(const Subgroups& subgroups, int workgroup);

}  // namespace strandcast::gpu
