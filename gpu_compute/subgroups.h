#pragma once
#include <string>

namespace strandcast::gpu {

/// Properties of a driver's subgroups in compute shaders (GL_KHR_shader_subgroup).
struct Subgroups {
  std::string vendor;     ///< GL_VENDOR
  int size = 0;           ///< GL_SUBGROUP_SIZE_KHR; 0 without the extension
  bool shuffles = false;  ///< compute shaders have subgroups and subgroupShuffle()
};
/// Properties of the current context.
Subgroups subgroupsOfDevice();

/// Whether a workgroup of `workgroup` invocations is certainly one subgroup whose invocations can exchange
/// registers. False for a larger subgroup: a shader that enables subgroups is then compiled for that size
/// (RDNA: wave64) and leaves invocations idle. False for a size that the driver only announces: OpenGL does
/// not guarantee that all subgroups have it, and Mesa's driver for Intel announces 32 and compiles for 8 or
/// 16 under register pressure. NVIDIA's hardware has no other size.
bool isOneSubgroup(const Subgroups& subgroups, int workgroup);

}  // namespace strandcast::gpu
