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
#include "groom/file_bytes.h"
#include "groom/file_report.h"

namespace strandcast {

/// Walks a Wavefront OBJ text statement by statement: comments and line ends taken off, lines that end in a
/// backslash joined with the next. Shared by the readers of polylines and of meshes.
class ObjLines {
 public:
  /// Throws Error on UTF-16 text.
  ObjLines(std::span<const std::byte> bytes, std::string name)
      : text_(textOfFile(bytes, name)), name_(std::move(name)) {}

  /// Moves to the next statement that has a word in it; false at the end of the text.
  bool next();
  /// The statement's words; the first is its keyword. Valid until next().
  const std::vector<std::string_view>& words() const { return words_; }
  /// The first word in lower case, as no two keywords differ by case alone.
  std::string keyword() const;
  /// Statements so far whose keyword the format does not have.
  size_t unknown() const { return unknown_; }
  size_t line() const { return line_; }  ///< 1-based, where the statement starts

  std::string where(size_t line) const { return name_ + ", line " + std::to_string(line); }
  [[noreturn]] void fail(const std::string& what, size_t line, const std::string& remedy = kDamaged) const {
    throw Error(what, where(line), remedy);
  }

  /// The x y z of a `v` statement; further columns (w, colours) are left alone. A coordinate that is no
  /// finite number, or beyond a float, is NaN: what uses such a vertex is to be left out. Throws Error where
  /// there are fewer than three coordinates, or text that is not a number.
  Vec3 position() const;
  /// The vertex index of a corner such as "7", "-1" or "7/2/3": 0-based, negative ones counted back from
  /// `vertices`, the vertices read so far. A later line may still define the vertex, so only the end of the
  /// file can tell if it exists: checkIndex().
  uint32_t vertexIndex(std::string_view corner, size_t vertices) const;
  /// Throws Error where a file of `vertices` vertices has no such one.
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

/// "without 3 faces of two corners": adds `count` of `what`, whose plural takes an s, where there are any.
void leaveOutCount(FileReport& report, size_t count, const std::string& what, const std::string& of);

}  // namespace strandcast
