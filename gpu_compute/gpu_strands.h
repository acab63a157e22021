#pragma once
#include <array>
#include <optional>
#include <vector>

#include "gpu_compute/gauss_seidel_strands.h"
#include "gpu_compute/mapped_rings.h"
#include "gpu_compute/rod_strands.h"
#include "gpu_compute/seen_bodies.h"
#include "gpu_compute/step_timer.h"

namespace strandcast::gpu {

/// One model on the GPU: its state, and the commands of a step. Every call needs the context that made it
/// current.
class GpuStrands {
 public:
  /// Throws Error when the model does not fit the device. `model` and `programs` outlive this.
  /// `few_vertices` and `compiles_slowly`: see RodStrands.
  GpuStrands(const StrandModel& model, ProgramCache& programs, size_t few_vertices, bool compiles_slowly);

  /// Makes what steps with such settings, and with bodies or without, need beyond the state. Throws Error
  /// when it does not fit the device.
  void expect(const Parameters& parameters, bool bodies);
  void upload(const StrandState& state);
  void download(StrandState& state);
  /// The first step with a solver, and its first with bodies or a goal pull, compile and expect() what was
  /// not; that may throw Error. No other one does, nor allocates, unless there are more bodies than ever
  /// before or other shapes.
  void step(const StepInput& input);
  /// Room for velocities(), before the first step that has some.
  void expectAccelerations();
  /// Velocities now, natural order, valid until the next call. Waits for pending steps.
  std::span<const Vec3> velocities();
  std::span<const Vec3> guides();
  /// guides() need not wait, nor the context.
  bool guidesReady() const { return !uploaded_.empty() || readback_.ready(); }
  // For what works on the same GPU before a step.
  const gl::Buffer& positions() const { return positions_; }        ///< of vertices, 4 numbers each, m
  const gl::Buffer& velocityBuffer() const { return velocities_; }  ///< the same, m/s
  /// The shapes of bodies, made to hold what the next step will be told.
  const gl::Buffer& shapes(const ShapeData* shapes);
  /// Where accelerations of vertices go, 3 numbers each, m/s^2: the next step heeds them.
  const gl::Buffer& accelerations();
  std::vector<Vec3> downloadAccelerations() const;

  /// Of the dispatches of a recent step alone; see StepTimer.
  std::optional<double> gpuSeconds() const { return timer_.newest(); }

 private:
  void bind() const;
  /// Those of the shapes that are on the GPU already.
  void takeBends(const ShapeData& shapes) const;
  void takeShapes(const ShapeData* shapes);
  void makeSights();
  void expectUploads(const UploadRing::Counts& wanted);
  void checkMemory(const char* what) const;  ///< after what was made since discardErrors()

  ProgramCache& programs_;
  const StrandModel& model_;
  const size_t few_vertices_;
  const bool compiles_slowly_;
  size_t vertices_;
  gl::Buffer positions_;   ///< xyz; w: tension of the edge that ends at the vertex
  gl::Buffer velocities_;  ///< xyz; w: StrandModel::rest_distance
  gl::Buffer frames_;      ///< of the edge that starts at the vertex
  gl::Buffer offsets_;
  gl::Buffer guides_;  ///< see shaders/step_input.glsl
  gl::Buffer shapes_;  ///< ShapeData::words of the newest step
  uint64_t shapes_revision_ = 0;
  bool groomed_;              ///< strands have tethers or factors
  bool accelerated_ = false;  ///< guides_ has the next step's accelerations
  // What not every step needs, empty until one is expected that does.
  gl::Buffer contacts_;    ///< StrandState::contacts; with bodies see shaders/contact_sights.glsl
  bool pressed_ = false;   ///< some of them may not be 0
  gl::Buffer rest_local_;  ///< see bonePoint() in shaders/step_input.glsl
  gl::Buffer grooming_;    ///< see shaders/grooming.glsl
  std::optional<GaussSeidelStrands> gauss_seidel_;
  std::optional<RodStrands> rod_;
  std::array<bool, 8> expected_{};  ///< by solver, goal pull and bodies
  SeenBodies seen_;
  std::optional<UploadRing> uploads_;  ///< never empty
  Readback readback_;
  StepTimer timer_;
  std::vector<std::array<float, 4>> velocities_packed_;
  std::vector<Vec3> velocities_read_;
  std::vector<Vec3> uploaded_;  ///< what guides() returns until the first step, empty from then on
};

}  // namespace strandcast::gpu
