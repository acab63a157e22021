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

}  // namespace strandcast::gpu
