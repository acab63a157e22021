#pragma once
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

namespace strandcast {

/// A root with a head 2 units above it. In 5 frames of 0.1 s the root walks along Z and the head rotates
/// about Y.
inline const std::string kSampleClip = R"(HIERARCHY
ROOT Hips
{
  OFFSET 0 1 0
  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
  JOINT MyHead
  {
    OFFSET 0 2 0
    CHANNELS 3 Yrotation Xrotation Zrotation
    End Site
    {
      OFFSET 0 0.5 0
    }
  }
}
MOTION
Frames: 5
Frame Time: 0.1
0 1 0 0 0 0 0 0 0
0 1 1 0 0 0 30 0 0
0.5 1 2 0 0 0 60 0 0
0 1 3 0 0 0 30 0 0
0 1 4 0 0 0 0 0 0
)";

/// A temporary file, removed by the destructor.
struct ScratchFile {
  std::filesystem::path path;
  ScratchFile(const std::string& name, const std::string& text)
      : path(std::filesystem::temp_directory_path() / ("strandcast_" + std::to_string(std::rand()) + name)) {
    std::ofstream(path, std::ios::binary) << text;
  }
  ~ScratchFile() {
    std::error_code ignored;
    std::filesystem::remove(path, ignored);
  }
};

}  // namespace strandcast
