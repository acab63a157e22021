#pragma once
#include <epoxy/gl.h>

#include <vector>

namespace strandcast {

/// Time stamps of the device between the passes of a picture.
class PassClock {
 public:
  PassClock() = default;
  ~PassClock();
  PassClock(const PassClock&) = delete;
  PassClock& operator=(const PassClock&) = delete;

  void restart() { stamps_ = 0; }
  void stamp();
  /// Between one stamp since restart() and the next; waits for it.
  double milliseconds(size_t from) const;

 private:
  std::vector<GLuint> queries_;
  size_t stamps_ = 0;
};

}  // namespace strandcast
