#pragma once
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/broad_phase.h"
#include "core/contact_primitive.h"
#include "core/parameters.h"
#include "core/strand_model.h"

namespace strandcast {

/// What one step is given. All spans live until step() returns. Places are world ones less an origin that is
/// the caller's business and the same as in the state: see Simulation::origin().
struct StepInput {
  const Parameters* parameters = nullptr;
  /// Poses of StrandModel::bones at the start and the end of the step; empty = all are at the origin, as in
  /// the groom's frame. Roots and pinned vertices ride on them and go straight from one place to the
  /// other, root frames turn as interpolateRotation() of kernels/rotation.h says.
  std::span<const Pose> bones_begin{}, bones_end{};
  std::span<const MovingPrimitive> primitives{};  ///< any number
  /// m/s^2 per vertex, natural order, on top of gravity and constant over the step; may be empty. See
  /// core/surroundings.h. Only for backends that take them.
  std::span<const Vec3> accelerations{};
  const ShapeData* shapes = nullptr;    ///< of the primitives; may be null where none is convex or a field
  const NearBodyLists* near = nullptr;  ///< of the primitives; null = any strand may touch any of them

  Pose boneAtBegin(size_t bone) const { return bones_begin.empty() ? Pose{} : bones_begin[bone]; }
  Pose boneAtEnd(size_t bone) const { return bones_end.empty() ? Pose{} : bones_end[bone]; }
};

/// Simulates the strands of one model. One implementation per way of computing; all keep the same state and
/// give the same step to rounding. Not thread-safe: one caller at a time.
class Backend {
 public:
  virtual ~Backend() = default;

  virtual std::string name() const = 0;    ///< "reference", "simd" or "gpu"
  virtual std::string device() const = 0;  ///< e.g. "AVX3, 2 threads" or the GL renderer string

  /// Takes a copy of what every step needs from `model` and sets the state. What only some need is copied
  /// when it is: `model` is to stay as and where it is until the next load(), or the end. Throws Error when
  /// it does not fit the device.
  virtual void load(const StrandModel& model, const StrandState& state) = 0;
  /// Makes room for what steps with such settings need beyond that, and with bodies where there are some; to
  /// be called before the first of them, or else that one makes it. Throws Error as load().
  virtual void expect(const Parameters&, [[maybe_unused]] bool bodies) {}
  /// Replaces the state: reset, teleport, tests.
  virtual void upload(const StrandState& state) = 0;
  /// Copies the whole state out. Waits for pending steps.
  virtual void download(StrandState& state) = 0;

  /// Advances by parameters.time_step. May return before the work is done. After expect() for these settings
  /// it neither throws nor allocates.
  virtual void step(const StepInput& input) = 0;
  /// Positions after the newest step, natural order, valid until the next step(). Waits for it.
  virtual std::span<const Vec3> guides() = 0;

  /// Whether step() heeds StepInput::accelerations and velocities() may be asked.
  virtual bool takesAccelerations() const { return false; }
  /// Makes room for them: to be called before the first step that has some.
  virtual void expectAccelerations() {}
  /// Velocities after the newest step, natural order, m/s; valid until the next step().
  virtual std::span<const Vec3> velocities() { return {}; }

  /// How long a GPU worked on the newest step whose time is known, s, transfers aside. None on a CPU or where
  /// the driver does not measure. Never waits.
  virtual std::optional<double> gpuSeconds() { return std::nullopt; }
};

/// A way of computing that this program knows of.
struct BackendInfo {
  std::string name;
  bool available = false;
  std::string reason;  ///< the device when available, else why not and what to do
  int score = 0;       ///< `auto` takes the highest available
  std::function<std::unique_ptr<Backend>(int threads)> create;  ///< threads: 0 = all; may throw Error
  std::vector<SolverKind> solvers{SolverKind::kRod};            ///< that it has
};

/// The reference backend: float, scalar, one thread. Simple enough to read; the others are held against it.
std::unique_ptr<Backend> makeReferenceBackend();
/// The same text in double precision: the oracle of tests.
std::unique_ptr<Backend> makeOracleBackend();
BackendInfo referenceBackendInfo();

}  // namespace strandcast
