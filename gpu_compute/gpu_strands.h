#pragma once
#include <array>
#include <optional>
#include <vector>

#include "gl/current.h"
#include "gl/timers.h"
#include "gpu_compute/divergence_test.h"
#include "gpu_compute/gauss_seidel_strands.h"
#include "gpu_compute/guide_packer.h"
#include "gpu_compute/mapped_rings.h"
#include "gpu_compute/rod_strands.h"
#include "gpu_compute/step_input.h"

namespace strandcast::gpu {

/// One model on the GPU: its state and the dispatches of a step. Precondition of every call: the context in
/// which it was constructed is current. Not thread-safe.
class GpuStrands {
 public:
  /// Throws Error if the model does not fit the device. `model` and `programs` must outlive this.
  /// `small_model_vertices` and `compiles_slowly`: see RodStrands.
  GpuStrands(const StrandModel& model, ProgramCache& programs, size_t small_model_vertices,
             bool compiles_slowly);

  /// Allocates what steps with these settings, and with bodies or without, need beyond the state. Idempotent.
  /// Throws Error if it does not fit the device.
  void prepare(const Parameters& parameters, bool bodies);
  void upload(const StrandState& state);
  void download(StrandState& state);  ///< waits for pending steps
  /// The first step with a solver, and its first with bodies or a goal, compile shaders and call prepare() if
  /// necessary; they may throw Error. Later steps neither throw nor allocate, unless there are more bodies
  /// than ever before or new shapes.
  void step(const StepInput& input);
  /// Allocates the memory of velocities(). Call it before the first step with external accelerations.
  void prepareAccelerations();
  /// Velocities of vertices, natural order, m/s; valid until the next call. Waits for pending steps.
  std::span<const Vec3> velocities();
  size_t vertices() const { return vertices_; }
  /// Positions after the newest step as Backend::guidesOf(): those of `count` vertices from `first` on are
  /// copied to the CPU. Waits for the step. Where accelerations() has given their memory away, allocates.
  std::span<const Vec3> guidesOf(size_t first, size_t count);
  /// True if guidesOf() of all vertices need not wait and needs no current context.
  bool guidesReady() const { return !uploaded_.empty() || guides_read_; }
  /// As Backend::mayHaveDiverged(). The first call allocates and compiles a shader; it may throw Error.
  bool mayHaveDiverged();
  /// As Backend::packGuides().
  std::span<const PackedRun> packGuides(const GuideGrid& grid, const PackingFrame& frame);
  std::optional<double> packSeconds() const { return packer_ ? packer_->seconds() : std::nullopt; }
  // For systems that work on the same GPU before a step.
  const gl::Buffer& positions() const { return positions_; }        ///< 4 floats per vertex, xyz in m
  const gl::Buffer& velocityBuffer() const { return velocities_; }  ///< 4 floats per vertex, xyz in m/s
  /// ShapeData::words on the GPU, updated to `shapes` of the next step.
  const gl::Buffer& shapes(const ShapeData* shapes);
  /// Buffer for external accelerations, 3 floats per vertex, m/s^2. The next step applies them.
  const gl::Buffer& accelerations();
  std::vector<Vec3> downloadAccelerations() const;

  /// GPU time of the dispatches of a recent step, s; see gl::StepTimer::newest().
  std::optional<double> gpuSeconds() const { return timer_.newest(); }

 private:
  void bind() const;
  /// Uploads the bends of shapes that are on the GPU already.
  void uploadBends(const ShapeData& shapes) const;
  void uploadShapes(const ShapeData* shapes);
  /// Allocates the contact cache; keeps contact forces.
  void allocateContactCache();
  /// Replaces the upload ring if it is smaller than `wanted`; waits for the GPU then.
  void growUploadRing(const UploadRing::Counts& wanted);
  /// Throws Error if an allocation since discardErrors() ran out of memory.
  void checkMemory(const char* what) const;

  ProgramCache& programs_;
  const StrandModel& model_;
  const size_t small_model_vertices_;
  const bool compiles_slowly_;
  size_t vertices_;
  gl::Buffer positions_;   ///< xyz, m; w: tension of the edge that ends at the vertex, m/s^2
  gl::Buffer velocities_;  ///< xyz, m/s; w: StrandModel::rest_distance, m
  gl::Buffer frames_;      ///< material frame of the edge that starts at the vertex, x y z w
  gl::Buffer offsets_;     ///< see shaders/step_input.glsl
  gl::Buffer guides_;      ///< see shaders/step_input.glsl
  gl::Buffer shapes_;      ///< ShapeData::words of the newest step
  uint64_t shapes_revision_ = 0;
  bool groomed_;              ///< strands have tethers or grooming factors
  bool accelerated_ = false;  ///< guides_ has the next step's accelerations
  // Empty until prepare() for a step that needs them.
  gl::Buffer contacts_;    ///< StrandState::contacts; with bodies see shaders/contact_cache.glsl
  bool pressed_ = false;   ///< some contact forces may differ from 0
  gl::Buffer rest_local_;  ///< see bonePoint() in shaders/step_input.glsl
  gl::Buffer grooming_;    ///< see shaders/step_input.glsl
  std::optional<GaussSeidelStrands> gauss_seidel_;
  std::optional<RodStrands> rod_;
  std::array<bool, 8> expected_{};  ///< prepared, by solver, goal and bodies
  PreviousBodies previous_bodies_;
  std::optional<UploadRing> uploads_;  ///< never empty
  Readback readback_;                  ///< positions, m, 3 floats per vertex
  bool guides_read_ = false;           ///< readback_ holds all positions of the newest step
  std::optional<DivergenceTest> divergence_;
  std::optional<GuidePacker> packer_;  ///< of the newest grid
  bool packing_started_ = false;       ///< packer_ has been started for the newest positions
  bool packs_steps_ = false;           ///< packGuides() was called since the last mayHaveDiverged()
  Vec3 origin_ = Vec3::Zero();         ///< m, world: of coordinates, in the last packGuides()
  Pose head_;                          ///< at the end of the newest step
  gl::StepTimer timer_;
  std::vector<std::array<float, 4>> velocities_packed_;
  std::vector<Vec3> velocities_read_;
  std::vector<Vec3> uploaded_;  ///< result of guidesOf() unless empty
};

/// Interface of the gpu backend to systems that work in its GPU memory between steps, such as the air system.
class GpuDevice {
 public:
  virtual ~GpuDevice() = default;
  /// The context that owns all GPU objects of the backend; must be current for calls to them.
  virtual gl::HeadlessContext& context() = 0;
  virtual ProgramCache& programs() = 0;
  /// Precondition: Backend::load() was called.
  virtual GpuStrands& strands() = 0;
};

}  // namespace strandcast::gpu
