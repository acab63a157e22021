#pragma once
#include <filesystem>
#include <map>
#include <string>

namespace strandcast {

/// docs/performance.md and its plots, generated.
struct PerformancePage {
  std::string text;
  std::map<std::string, std::string> images;  ///< by file name: SVG
};
/// From the folders of machines in `results`. The same files give the same bytes. Throws Error.
PerformancePage performancePage(const std::filesystem::path& results);

}  // namespace strandcast
