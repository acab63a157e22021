#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace strandcast {

/// Remarks of a reader on a file, besides the contents. Programs print them wherever they load a file.
struct FileReport {
  /// Contents of the file that the result lacks, each once, phrased to follow "without": "colours", "2
  /// invisible prims (/fur/old, /fur/test)".
  std::vector<std::string> left_out;
  /// Repairs, guesses and doubts: one sentence each, without the name of the file.
  std::vector<std::string> warnings;

  /// Adds an entry to `left_out` unless it is already there.
  void leaveOut(const std::string& what);
  /// "without A, B" when something is left out; empty otherwise.
  std::string leftOutLine() const;
};

/// Appends the report on `file` to the messages of a scene: `left_out` to `notes`, the warnings to
/// `warnings`.
void tell(const std::filesystem::path& file, const FileReport& report, std::vector<std::string>& notes,
          std::vector<std::string>& warnings);

}  // namespace strandcast
