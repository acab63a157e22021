#pragma once
#include <array>
#include <vector>

#include "gl/buffer.h"
#include "gpu_compute/gpu_layout.h"
#include "gpu_compute/placed_bodies.h"

namespace strandcast::gpu {

/// A point in the command stream that can be waited for.
class Fence {
 public:
  Fence() = default;
  ~Fence();
  Fence(const Fence&) = delete;
  Fence& operator=(const Fence&) = delete;
  void set();   ///< after the commands given so far
  void wait();  ///< returns at once when not set

 private:
  GLsync sync_ = nullptr;
};

/// What a step is told (settings, bodies, lists of near bodies, bones): the CPU writes the next while the GPU
/// still copies the last to its own memory, from which the shaders read it. There the roots at rest lie too.
class UploadRing {
 public:
  /// What differs from step to step.
  struct Counts {
    size_t bodies, near;  ///< bodies: in all substeps; near: words of the lists, and of their leaders'
  };
  static Counts countsOf(const StepInput& input);

  /// `model` outlives this.
  UploadRing(const StrandModel& model, const Counts& capacity);

  const Counts& capacity() const { return capacity_; }
  bool takes(const Counts& counts) const {
    return counts.bodies <= capacity_.bodies && counts.near <= capacity_.near;
  }
  /// Takes the next slot, waiting while the GPU may still read it, copies `input` and binds the shader's
  /// blocks to the GPU's copy of it.
  void write(const StepInput& input);

 private:
  static constexpr size_t kSlots = 3;
  const StrandModel& model_;
  Counts capacity_;
  size_t bodies_at_, near_at_, poses_at_;  ///< bytes from the start of a slot, which bones end
  size_t bones_bytes_;                     ///< at both ends of the step
  gl::Buffer on_gpu_;
  std::array<gl::Buffer, kSlots> buffers_;
  std::array<char*, kSlots> memory_{};
  std::array<Fence, kSlots> fences_;
  size_t slot_ = 0;
  Leaders leaders_;
};

/// Positions on their way back.
class Readback {
 public:
  explicit Readback(size_t vertices);

  /// Gives the commands that copy `guides` (3 floats per vertex) here, over what newest() gave before.
  void copyFrom(const gl::Buffer& guides);
  /// Waits for the newest copy.
  std::span<const Vec3> newest();
  /// What newest() would return is there already.
  bool ready() const { return ready_; }

 private:
  size_t vertices_;
  gl::Buffer buffer_;
  const Vec3* memory_;
  Fence fence_;
  bool ready_ = false;
};

}  // namespace strandcast::gpu
