#pragma once
#include <epoxy/gl.h>

#include <array>
#include <optional>

namespace strandcast::gpu {

/// How long the GPU works on a step's dispatches, by timer queries that are read when their answer is there.
class StepTimer {
 public:
  StepTimer();
  ~StepTimer();
  StepTimer(const StepTimer&) = delete;
  StepTimer& operator=(const StepTimer&) = delete;

  /// Around the commands of a step. One that finds all queries still unanswered is not measured.
  void begin();
  void end();
  /// Takes the answers that are there. Never waits.
  void poll();
  /// Seconds, of the newest step whose answer was there; none where the driver does not measure (it answers
  /// 0).
  std::optional<double> newest() const { return newest_; }

 private:
  std::array<GLuint, 4> queries_{};  ///< a ring
  size_t asked_ = 0, answered_ = 0;  ///< counts over the whole life
  bool running_ = false;
  std::optional<double> newest_;
};

}  // namespace strandcast::gpu
