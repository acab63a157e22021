#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace strandcast {

/// What a reader has to say of a file beside its contents. Programs print it wherever a file is loaded.
struct FileReport {
  /// What the file has and the result lacks, each once, as it follows "without": "colours",
  /// "2 invisible prims (/fur/old, /fur/test)".
  std::vector<std::string> left_out;
  /// What was mended, guessed or is in doubt: a sentence each, without the file's name.
  std::vector<std::string> warnings;

  /// Adds to `left_out`, once.
  void leaveOut(const std::string& what);
  /// "without A, B" where something is left out; empty otherwise.
  std::string leftOutLine() const;
};

/// Adds what there is to say of `file` to what a scene says: what is left out to `notes`, the rest to
/// `warnings`.
void tell(const std::filesystem::path& file, const FileReport& report, std::vector<std::string>& notes,
          std::vector<std::string>& warnings);

}  // namespace strandcast
