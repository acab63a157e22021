#pragma once
#include <optional>
#include <vector>

#include "gl/program.h"
#include "gpu_compute/mapped_rings.h"

namespace strandcast::gpu {

/// One model on the GPU: its buffers and the dispatches of a step. Every call needs the context that made it
/// current.
class GpuStrands {
 public:
  /// Throws Error when the model does not fit the device.
  explicit GpuStrands(const StrandModel& model);

  void upload(const StrandState& state);
  void download(StrandState& state) const;
  void step(const StepInput& input);
  std::span<const Vec3> guides();
  /// guides() need not wait, nor the context.
  bool guidesReady() const { return !uploaded_.empty() || readback_.ready(); }

 private:
  /// Strands of at most `threads` vertices (and more than half as many, or 4).
  struct Group {
    gl::Program program;
    GLuint strands;
    GLuint workgroups;
  };
  void makeGroups(const StrandModel& model);
  void bind() const;

  size_t vertices_, strands_;
  gl::Buffer positions_, velocities_, rest_local_, rest_edge_, offsets_, order_, guides_;
  std::optional<UploadRing> uploads_;  ///< never empty
  Readback readback_;
  std::vector<Group> groups_;
  std::vector<Vec3> uploaded_;  ///< what guides() returns until the first step
};

}  // namespace strandcast::gpu
