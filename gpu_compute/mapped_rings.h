#pragma once
#include <array>
#include <vector>

#include "gl/buffer.h"
#include "gpu_compute/step_input.h"

namespace strandcast::gpu {

/// A fence in the command stream. Needs a current context for its whole life.
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

/// Uploads the input of steps: settings, bodies, near-body lists, poses of bones. The CPU writes one slot of
/// mapped memory while the GPU still copies earlier slots to its own memory. Shaders read the GPU's copy,
/// which also holds the rest poses of the roots.
class UploadRing {
 public:
  /// Sizes that differ from step to step.
  struct Counts {
    size_t bodies, near;  ///< bodies x substeps; words of the near-body lists and of their leaders' lists
  };
  static Counts countsOf(const StepInput& input);

  /// `model` must outlive this. Throws Error if the GPU cannot map memory.
  UploadRing(const StrandModel& model, const Counts& capacity);

  const Counts& capacity() const { return capacity_; }
  bool fits(const Counts& counts) const {
    return counts.bodies <= capacity_.bodies && counts.near <= capacity_.near;
  }
  /// Copies `input` through the next slot, and binds the blocks of shaders/step_input.glsl to the GPU's copy.
  /// Waits while the GPU may still read the slot. Precondition: fits(countsOf(input)).
  void write(const StepInput& input);

 private:
  static constexpr size_t kSlots = 3;
  const StrandModel& model_;
  Counts capacity_;
  size_t bodies_at_, near_at_, poses_at_;  ///< byte offsets in a slot; poses of bones are last
  size_t bones_bytes_;                     ///< of poses at the start and the end of the step
  gl::Buffer on_gpu_;
  std::array<gl::Buffer, kSlots> buffers_;
  std::array<char*, kSlots> memory_{};
  std::array<Fence, kSlots> fences_;
  size_t slot_ = 0;
  Leaders leaders_;
};

/// Mapped memory of the CPU to which the GPU copies results.
class Readback {
 public:
  /// Throws Error if the GPU cannot map memory.
  explicit Readback(size_t bytes);

  /// Records the copy of `bytes` bytes of `from` from byte `first` on, to the same offset in the memory.
  void copyFrom(const gl::Buffer& from, size_t first, size_t bytes);
  /// Waits for the copies recorded so far.
  void wait();
  /// The memory as an array. Precondition: wait() was called after the last of them.
  template <class T>
  std::span<const T> as() const {
    return {static_cast<const T*>(memory_), buffer_.bytes() / sizeof(T)};
  }

 private:
  gl::Buffer buffer_;
  const void* memory_;
  Fence fence_;
};

}  // namespace strandcast::gpu
