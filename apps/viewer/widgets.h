// Widgets of the panel: rows of settings, plots, images.
#pragma once
#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "core/parameters.h"
#include "io/image.h"

namespace strandcast {

/// Draws one row of the current panel: name, value, unit, help as a tooltip, and a button back to `usual`
/// where the value differs. Returns whether the value was changed, in range.
bool settingRow(const ParameterInfo& info, const std::vector<std::string>& choices,
                const std::vector<double>& usual, std::vector<double>& values);
/// The same for a text, which Enter confirms.
bool textRow(const std::string& name, const std::string& help, std::string& text);
/// A tooltip on the widget drawn last.
void helpHere(const std::string& text);

/// A ring of the newest values of one quantity.
class History {
 public:
  static constexpr size_t kLength = 240;
  void add(double value);
  size_t size() const { return count_ < kLength ? count_ : kLength; }
  double at(size_t i) const;  ///< 0 is the oldest
  double newest() const { return count_ > 0 ? at(size() - 1) : 0; }

 private:
  std::array<double, kLength> values_{};
  size_t count_ = 0;
};

/// Histories of one unit in one plot.
struct Plot {
  std::string title, unit;
  struct Line {
    std::string name;
    History history;
  };
  std::vector<Line> lines;

  /// Appends to the line of that name; a new name adds a line.
  void add(const std::string& name, double value);
  /// Draws into the current panel: lines from 0 to the largest value, with their newest values beside them.
  void draw(float width, float height) const;
};

/// An image as a texture that a panel can show. Needs a current OpenGL context for its whole life.
class ImageTexture {
 public:
  ImageTexture() = default;
  ~ImageTexture();
  ImageTexture(const ImageTexture&) = delete;
  ImageTexture& operator=(const ImageTexture&) = delete;

  /// Uploads an image.
  void set(const Image& image);
  bool isEmpty() const { return id_ == 0; }
  /// Draws the image `width` pixels wide into the current panel.
  void show(float width) const;

 private:
  unsigned id_ = 0;
  int width_ = 0, height_ = 0;
};

}  // namespace strandcast
