#pragma once
#include <epoxy/gl.h>

#include <chrono>
#include <vector>

namespace strandcast {

/// Times of the passes of a picture by the device's time stamps; on software renderers by the CPU clock,
/// waiting for every pass. llvmpipe 22.3.6 renders tile by tile and keeps only the last tile's stamps. A pass
/// would get one tile's share of its time, and an earlier pass the rest.
class PassClock {
 public:
  PassClock();  ///< for the current context
  ~PassClock();
  PassClock(const PassClock&) = delete;
  PassClock& operator=(const PassClock&) = delete;

  void restart() { stamps_ = 0; }
  /// Marks the end of a pass.
  void stamp();
  /// Time between stamp `from` since restart() and the next one; waits for it.
  double milliseconds(size_t from) const;

 private:
  const bool by_processor_;
  size_t stamps_ = 0;
  std::vector<GLuint> queries_;                                ///< device time stamps
  std::vector<std::chrono::steady_clock::time_point> clocks_;  ///< CPU time stamps
};

}  // namespace strandcast
