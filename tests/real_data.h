#pragma once
#include <cstdlib>
#include <filesystem>

namespace strandcast {

/// Real grooms, bodies and motions, which are no part of the project: the folder that STRANDCAST_DATA names,
/// or shared/data beside the project. Tests skip what is not there, and say so.
inline std::filesystem::path dataFolder() {
  const char* named = std::getenv("STRANDCAST_DATA");
  return named != nullptr ? named : STRANDCAST_SOURCE_DIR "/../shared/data";
}

}  // namespace strandcast
