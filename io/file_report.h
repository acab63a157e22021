// Reports of readers: what they left out of a file, repaired and guessed.
#pragma once
#include <cstdint>
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
  void addOmission(const std::string& what);
  /// "without A, B" when something is left out; empty otherwise.
  std::string omissionsLine() const;
};

/// Appends the report on `file` to the messages of a scene: `left_out` to `notes`, the warnings to
/// `warnings`.
void appendReport(const std::filesystem::path& file, const FileReport& report,
                  std::vector<std::string>& notes, std::vector<std::string>& warnings);

/// Counts what a glTF reader leaves out and repairs, by kind.
class GltfReport {
 public:
  /// Adds one occurrence, located at `part`, of a kind that may occur often: "primitives of points or lines".
  void addOmission(const std::string& what, const std::string& part);
  void addOmission(const std::string& what) { file_.addOmission(what); }
  /// Adds one occurrence, located at `part`, of a repair or doubt that may occur often.
  void warn(const std::string& what, const std::string& part);
  void warn(const std::string& what) { file_.warnings.push_back(what); }
  /// "without A, B" for everything left out so far; empty otherwise.
  std::string omissionsLine() const { return report().omissionsLine(); }
  FileReport report() const;

 private:
  struct Kind {
    std::string what;
    uint64_t count = 0;
    std::string parts;  ///< the first few
  };
  static void count(std::vector<Kind>& kinds, const std::string& what, const std::string& part);
  static std::string text(const Kind& kind);

  std::vector<Kind> omissions_, warned_;
  FileReport file_;
};

/// A name from a file, made safe for one line of output: without control characters, at most 64 bytes.
std::string printable(const std::string& name);

}  // namespace strandcast
