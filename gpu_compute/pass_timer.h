#pragma once
#include <epoxy/gl.h>

#include <chrono>
#include <string>
#include <utility>
#include <vector>

namespace strandcast::gpu {

/// GPU time of each pass of a frame, by timestamp queries. On software renderers, which do not measure, by
/// the CPU's clock, waiting for every pass. Costs nothing while off. Needs a current context for its whole
/// life.
class PassTimer {
 public:
  PassTimer() = default;
  ~PassTimer();
  PassTimer(const PassTimer&) = delete;
  PassTimer& operator=(const PassTimer&) = delete;

  /// Starts measuring. `each`: every pass by itself; else only whole frames. Reserves memory for `frames`
  /// frames; further ones may allocate.
  void measure(bool each, size_t frames);
  void stop() { on_ = false; }
  void begin();  ///< starts a frame
  /// Ends pass `name`: all commands since the last call. "all" ends the frame. `name` must outlive take().
  void passed(const char* name);
  /// Names and milliseconds of the passes since the last take(), in order. Waits for the GPU.
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
