#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "io/file_report.h"

namespace strandcast {

/// Counts what a glTF reader leaves out and repairs, by kind.
class GltfReport {
 public:
  /// Adds one occurrence, located at `part`, of a kind that may occur often: "primitives of points or lines".
  void leaveOut(const std::string& what, const std::string& part);
  void leaveOut(const std::string& what) { file_.leaveOut(what); }
  /// Adds one occurrence, located at `part`, of a repair or doubt that may occur often.
  void warn(const std::string& what, const std::string& part);
  void warn(const std::string& what) { file_.warnings.push_back(what); }
  /// "without A, B" for everything left out so far; empty otherwise.
  std::string leftOutLine() const { return report().leftOutLine(); }
  FileReport report() const;

 private:
  struct Kind {
    std::string what;
    uint64_t count = 0;
    std::string parts;  ///< the first few
  };
  static void count(std::vector<Kind>& kinds, const std::string& what, const std::string& part);
  static std::string text(const Kind& kind);

  std::vector<Kind> left_out_, warned_;
  FileReport file_;
};

/// A name from a file, made safe for one line of output: without control characters, at most 64 bytes.
std::string printable(const std::string& name);

}  // namespace strandcast
