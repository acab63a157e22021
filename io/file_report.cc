#include "io/file_report.h"

#include <fmt/format.h>

#include <algorithm>

namespace strandcast {

void FileReport::addOmission(const std::string& what) {
  if (std::find(left_out.begin(), left_out.end(), what) == left_out.end()) left_out.push_back(what);
}

std::string FileReport::omissionsLine() const {
  return left_out.empty() ? "" : fmt::format("without {}", fmt::join(left_out, ", "));
}

void appendReport(const std::filesystem::path& file, const FileReport& report,
                  std::vector<std::string>& notes, std::vector<std::string>& warnings) {
  if (!report.left_out.empty())
    notes.push_back(fmt::format("{}: read {}", file.string(), report.omissionsLine()));
  for (const std::string& warning : report.warnings)
    warnings.push_back(fmt::format("{}: {}", file.string(), warning));
}

void GltfReport::count(std::vector<Kind>& kinds, const std::string& what, const std::string& part) {
  constexpr uint64_t kNamed = 3;
  auto kind = std::find_if(kinds.begin(), kinds.end(), [&](const Kind& known) { return known.what == what; });
  if (kind == kinds.end()) kind = kinds.insert(kinds.end(), Kind{what, 0, ""});
  ++kind->count;
  if (kind->count <= kNamed) kind->parts += (kind->count > 1 ? ", " : "") + part;
  if (kind->count == kNamed + 1) kind->parts += ", ...";
}

std::string GltfReport::text(const Kind& kind) {
  return kind.count == 1 ? fmt::format("{} ({})", kind.what, kind.parts)
                         : fmt::format("{} ({}: {})", kind.what, kind.count, kind.parts);
}

void GltfReport::addOmission(const std::string& what, const std::string& part) {
  count(omissions_, what, part);
}

void GltfReport::warn(const std::string& what, const std::string& part) { count(warned_, what, part); }

FileReport GltfReport::report() const {
  FileReport out = file_;
  for (const Kind& kind : omissions_) out.addOmission(text(kind));
  for (const Kind& kind : warned_) out.warnings.push_back(text(kind));
  return out;
}

std::string printable(const std::string& name) {
  constexpr size_t kMax = 64;
  std::string out = name.substr(0, kMax);
  for (char& c : out)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
  return out;
}

}  // namespace strandcast
