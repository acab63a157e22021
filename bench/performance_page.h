#pragma once
#include <filesystem>
#include <map>
#include <string>

namespace strandcast {

/// docs/performance.md and its plots, generated.
struct PerformancePage {
  std::string text;
  std::map<std::string, std::string> images;  ///< SVG documents by file name
};
/// Generates the page from the machines' folders in `results`. Deterministic: the same files give the same
/// bytes. Throws Error.
PerformancePage performancePage(const std::filesystem::path& results);

}  // namespace strandcast
