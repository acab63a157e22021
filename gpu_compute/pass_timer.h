#pragma once
#include <epoxy/gl.h>

#include <chrono>
#include <string>
#include <utility>
#include <vector>

namespace strandcast::gpu {

/// How long the GPU works on each pass of a frame: by timestamps, or, on renderers that do not measure, by
/// the clock of the CPU, waiting for every pass. Off, it costs nothing.
class PassTimer {
 public:
  PassTimer() = default;
  ~PassTimer();
  PassTimer(const PassTimer&) = delete;
  PassTimer& operator=(const PassTimer&) = delete;

  /// `each`: every pass for itself, one after the other; else only the whole frame. Allocates room for so
  /// many frames; beyond them frames do.
  void measure(bool each, size_t frames);
  void stop() { on_ = false; }
  void begin();                   ///< of a frame
  void passed(const char* name);  ///< all commands since the last call are of this pass
  /// Milliseconds by name, of the frames since the last call of this. Waits for them.
  std::vector<std::pair<std::string, double>> take();

 private:
  struct Mark {
    const char* name;
    GLuint query;
    std::chrono::steady_clock::time_point when;
  };
  void mark(const char* name);

  bool on_ = false, each_ = false, by_clock_ = false;
  std::vector<GLuint> free_;
  std::vector<Mark> marks_;
};

}  // namespace strandcast::gpu
