// What drivers can and cannot do: faults that end the process, and subgroups.
#pragma once
#include <string>

namespace strandcast::gpu {

/// The environment variable that, set to 1, makes the gpu backend run on drivers that it refuses.
inline constexpr const char* kUntestedVariable = "STRANDCAST_UNTESTED_GPU";

/// Why a driver, by its GL_RENDERER and GL_VERSION, must not compile this backend's programs, and what the
/// user can do; empty: it may. Only for drivers that crash the process; where a program merely fails to
/// build, gl::Program throws Error.
///
/// zink (OpenGL over Vulkan) of Mesa 22.3.6 writes invalid SPIR-V for local arrays of bools; creating the
/// pipeline fails, and the driver uses it all the same. Mesa 25.0.7 is correct. Versions between were not
/// tested.
std::string driverFault(const std::string& renderer, const std::string& version);

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
