#pragma once
#include <filesystem>
#include <vector>

namespace strandcast {

/// Creates a folder for output where it does not exist. The destructor removes a created folder that is still
/// empty.
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
