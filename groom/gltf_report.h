#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "groom/file_report.h"

namespace strandcast {

/// What a glTF reader leaves out and mends, counted by kind while it reads.
class GltfReport {
 public:
  /// Of `what` there may be several, each in a part of its own: "primitives of points or lines".
  void leaveOut(const std::string& what, const std::string& part);
  void leaveOut(const std::string& what) { file_.leaveOut(what); }
  /// Something mended or in doubt, of which there may be several, each in a part of its own.
  void warn(const std::string& what, const std::string& part);
  void warn(const std::string& what) { file_.warnings.push_back(what); }
  /// "without A, B" of what was left out so far; empty otherwise.
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

/// A name out of a file as it may stand in a line: without control characters, 64 bytes at most.
std::string printable(const std::string& name);

}  // namespace strandcast
