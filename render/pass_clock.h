#pragma once
#include <epoxy/gl.h>

#include <chrono>
#include <vector>

namespace strandcast {

/// Times between the passes of a picture: by time stamps of the device; on software renderers by the clock of
/// the processor, waiting for every pass. llvmpipe 22.3.6 works tile by tile and keeps the stamps of the last
/// tile alone, so that a pass would be given one tile's share of its time, and an earlier one the rest.
class PassClock {
 public:
  PassClock();  ///< of the current context
  ~PassClock();
  PassClock(const PassClock&) = delete;
  PassClock& operator=(const PassClock&) = delete;

  void restart() { stamps_ = 0; }
  void stamp();
  /// Between one stamp since restart() and the next; waits for it.
  double milliseconds(size_t from) const;

 private:
  const bool by_processor_;
  size_t stamps_ = 0;
  std::vector<GLuint> queries_;                                ///< of the device's stamps
  std::vector<std::chrono::steady_clock::time_point> clocks_;  ///< of the processor's
};

}  // namespace strandcast
