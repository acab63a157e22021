#pragma once
#include <cfloat>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "core/geometry.h"
#include "io/file_bytes.h"
#include "io/file_report.h"

namespace strandcast {

/// Iterates over the statements of a Wavefront OBJ text. Comments and line ends are removed; a line that ends
/// in a backslash is joined with the next. Shared by the readers of polylines and of meshes.
class ObjLines {
 public:
  /// Throws Error on UTF-16 text.
  ObjLines(std::span<const std::byte> bytes, std::string name)
      : text_(textOfFile(bytes, name)), name_(std::move(name)) {}

  /// Advances to the next statement that has a word; false at the end of the text.
  bool next();
  /// The words of the statement; the first is its keyword. Valid until next().
  const std::vector<std::string_view>& words() const { return words_; }
  /// The first word in lower case: no two keywords differ by case alone.
  std::string keyword() const;
  /// Number of statements so far whose keyword the format does not define.
  size_t unknown() const { return unknown_; }
  size_t line() const { return line_; }  ///< 1-based, where the statement starts

  std::string where(size_t line) const { return name_ + ", line " + std::to_string(line); }
  [[noreturn]] void fail(const std::string& what, size_t line, const std::string& remedy = kDamaged) const {
    throw Error(what, where(line), remedy);
  }

  /// The x y z of a `v` statement; further columns (w, colours) are ignored. A coordinate that is not finite,
  /// or beyond a float, becomes NaN: the caller leaves out what uses such a vertex. Throws Error when there
  /// are fewer than three coordinates, or a coordinate is not a number.
  Vec3 position() const;
  /// The 0-based vertex index of a corner such as "7", "-1" or "7/2/3". Negative indices count back from
  /// `vertices`, the number of vertices read so far. A later line may still define the vertex: call
  /// checkIndex() at the end of the file.
  uint32_t vertexIndex(std::string_view corner, size_t vertices) const;
  /// Throws Error when a file of `vertices` vertices has no vertex `vertex`.
  void checkIndex(uint32_t vertex, size_t vertices, size_t line) const;

  static constexpr const char* kDamaged = "mend the line or export the file again";

 private:
  std::string_view takeLine();
  float coordinate(std::string_view word) const;

  std::string_view text_;
  std::string name_;
  size_t next_byte_ = 0;
  size_t lines_read_ = 0;
  size_t line_ = 0;
  size_t unknown_ = 0;
  std::string joined_;
  std::vector<std::string_view> words_;
};

/// Reports `count` of `what`, followed by `of`, as left out when `count` is above 0: "without 3 faces of two
/// corners". The plural of `what` takes an s.
void addOmissionCount(FileReport& report, size_t count, const std::string& what, const std::string& of);

}  // namespace strandcast
