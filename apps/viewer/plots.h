#pragma once
#include <array>
#include <cstddef>
#include <string>
#include <vector>

namespace strandcast {

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

}  // namespace strandcast
