#pragma once
#include <filesystem>
#include <vector>

namespace strandcast {

/// A folder for what a program writes, made where it is not there. When nothing was put into one that was
/// made, it goes again.
class OutputFolder {
 public:
  /// Throws Error.
  explicit OutputFolder(const std::filesystem::path& folder);
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

 private:
  std::vector<std::filesystem::path> made_;  // innermost first
};

}  // namespace strandcast
