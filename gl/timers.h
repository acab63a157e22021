// Device times: of the passes of a picture, of a step, and of the passes of a step.
#pragma once
#include <epoxy/gl.h>

#include <array>
#include <chrono>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace strandcast::gl {

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

/// GPU time of a step's dispatches, by timer queries that are read without waiting. Needs a current context
/// for its whole life.
class StepTimer {
 public:
  StepTimer();
  ~StepTimer();
  StepTimer(const StepTimer&) = delete;
  StepTimer& operator=(const StepTimer&) = delete;

  /// Call these before and after the commands of a step. A step is not measured while all queries are
  /// pending.
  void begin();
  void end();
  /// Reads the results that are available. Never waits.
  void poll();
  /// Seconds of the newest step whose result is known; none if the driver does not measure (it reports 0).
  std::optional<double> newest() const { return newest_; }

 private:
  std::array<GLuint, 4> queries_{};  ///< ring buffer
  size_t asked_ = 0, answered_ = 0;  ///< total counts
  bool running_ = false;
  std::optional<double> newest_;
};

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

}  // namespace strandcast::gl
