#include "io/file_report.h"

#include <fmt/format.h>

#include <algorithm>

namespace strandcast {

void FileReport::leaveOut(const std::string& what) {
  if (std::find(left_out.begin(), left_out.end(), what) == left_out.end()) left_out.push_back(what);
}

std::string FileReport::leftOutLine() const {
  return left_out.empty() ? "" : fmt::format("without {}", fmt::join(left_out, ", "));
}

void tell(const std::filesystem::path& file, const FileReport& report, std::vector<std::string>& notes,
          std::vector<std::string>& warnings) {
  if (!report.left_out.empty())
    notes.push_back(fmt::format("{}: read {}", file.string(), report.leftOutLine()));
  for (const std::string& warning : report.warnings)
    warnings.push_back(fmt::format("{}: {}", file.string(), warning));
}

}  // namespace strandcast
