#pragma once
#include <string>

namespace strandcast::gpu {

/// The environment variable that, set to 1, has the gpu backend run on drivers that it refuses.
inline constexpr const char* kUntestedVariable = "STRANDCAST_UNTESTED_GPU";

/// Why a driver, by its GL_RENDERER and GL_VERSION, must not be given this backend's programs, and what to
/// do; empty = it may. Only for drivers that end the process: a program that does not build elsewhere is an
/// Error of gl::Program.
///
/// zink (OpenGL over Vulkan) of Mesa 22.3.6 writes invalid SPIR-V for local arrays of bools, the pipeline
/// cannot be made, and the driver uses it all the same. Mesa 25.0.7 does not. Versions between were not
/// tried.
std::string faultOfDriver(const std::string& renderer, const std::string& version);

}  // namespace strandcast::gpu
