#pragma once
#include <span>
#include <vector>

#include "transport/chunks.h"
#include "transport/messages.h"

namespace strandcast {

/// Where lost strands probably are: carried on along their last motion relative to the head, at their last
/// edge lengths, for kMaxExtrapolation at most; then they stand still on the head until they are received
/// again.
class Concealment {
 public:
  static constexpr double kMaxExtrapolation = 0.1;  // s

  void setGroom(const StrandSet& guides);
  /// Takes note of the strands of `frame` in `received`, by their runs; those with strand_count 0 are
  /// skipped.
  void learn(const GuideFrame& frame, std::span<const StrandRun> received);
  /// Fills in the strands that learn() was not told of in this frame. False when one of them was never
  /// received: then it cannot be said where it is. Sets frame.strands_concealed.
  bool conceal(GuideFrame& frame);

 private:
  struct Times {
    double last = 0, before = 0;  // s of simulation time; of a strand received `count` times
    uint32_t count = 0;
    uint64_t frame = 0;
  };
  void extrapolate(uint32_t strand, double time, std::span<Vec3> out) const;

  std::vector<uint32_t> offsets_;
  std::vector<Vec3> last_, before_;  // per vertex, m, in the head's frame
  std::vector<Times> times_;         // per strand
};

}  // namespace strandcast
