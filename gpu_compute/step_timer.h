#pragma once
#include <epoxy/gl.h>

#include <array>
#include <optional>

namespace strandcast::gpu {

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

}  // namespace strandcast::gpu
