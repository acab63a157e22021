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

namespace strandcast {

/// Walks a Wavefront OBJ text statement by statement: comments and line ends taken off, lines that end in a
/// backslash joined with the next. Shared by the readers of polylines and of meshes.
class ObjLines {
 public:
  ObjLines(std::span<const std::byte> bytes, std::string name)
      : text_(textOfFile(bytes)), name_(std::move(name)) {}

  /// Moves to the next statement that has a word in it; false at the end of the text.
  bool next();
  /// The statement's words; the first is its keyword. Valid until next().
  const std::vector<std::string_view>& words() const { return words_; }
  size_t line() const { return line_; }  ///< 1-based, where the statement starts

  std::string where(size_t line) const { return name_ + ", line " + std::to_string(line); }
  [[noreturn]] void fail(const std::string& what, size_t line, const std::string& remedy = kDamaged) const {
    throw Error(what, where(line), remedy);
  }

  /// The x y z of a `v` statement; further columns (w, colours) are left alone. Throws Error unless all are
  /// finite.
  Vec3 position() const;
  /// The vertex index of a corner such as "7", "-1" or "7/2/3": 0-based, negative ones counted back from
  /// `vertices`, the vertices read so far. A later line may still define the vertex, so only the end of the
  /// file can tell if it exists.
  uint32_t vertexIndex(std::string_view corner, size_t vertices) const;

  static constexpr const char* kDamaged = "mend the line or export the file again";

 private:
  std::string_view takeLine();

  std::string_view text_;
  std::string name_;
  size_t next_byte_ = 0;
  size_t lines_read_ = 0;
  size_t line_ = 0;
  std::string joined_;
  std::vector<std::string_view> words_;
};

}  // namespace strandcast
