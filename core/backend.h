// What computes a step: backends, external forces such as air, and the choice of a backend.
#pragma once
#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/broad_phase.h"
#include "core/contact_primitive.h"
#include "core/guide_packing.h"
#include "core/parameters.h"
#include "core/strand_model.h"

namespace strandcast {

/// Input of one step. All spans must live until step() returns. Positions are relative to an origin that the
/// caller chooses; it must be the same as that of the state (see Simulation::origin()).
struct StepInput {
  const Parameters* parameters = nullptr;
  /// Poses of StrandModel::bones at the start and the end of the step; empty = all at identity, as in the
  /// groom's frame. Roots and pinned vertices move linearly between the two; root frames turn as
  /// interpolateRotation() of kernels/rotation.h does.
  std::span<const Pose> bones_begin{}, bones_end{};
  std::span<const MovingPrimitive> primitives{};  ///< any number
  /// m/s^2 per vertex, natural order, added to gravity and constant over the step; empty = none. See
  /// ExternalForces. Only for backends with takesAccelerations().
  std::span<const Vec3> accelerations{};
  const ShapeData* shapes = nullptr;  ///< words of the primitives; may be null if none is convex or a field
  const NearBodyLists* near =
      nullptr;  ///< result of the broad phase; null = any strand may touch any primitive

  Pose boneAtBegin(size_t bone) const { return bones_begin.empty() ? Pose{} : bones_begin[bone]; }
  Pose boneAtEnd(size_t bone) const { return bones_end.empty() ? Pose{} : bones_end[bone]; }
};

/// Simulates the strands of one model. Every backend keeps the same state and computes the same step to
/// rounding. Not thread-safe: one caller at a time.
class Backend {
 public:
  virtual ~Backend() = default;

  virtual std::string name() const = 0;    ///< "reference", "simd" or "gpu"
  virtual std::string device() const = 0;  ///< e.g. "AVX3, 2 threads" or the GL renderer string

  /// Copies from `model` what every step needs and sets the state. Other arrays are copied on demand: `model`
  /// must stay alive, unchanged and at its address until the next load() or the backend's end. Throws Error
  /// if it does not fit the device.
  virtual void load(const StrandModel& model, const StrandState& state) = 0;
  /// Allocates what steps with these parameters need beyond load(), and contact memory if `bodies`. Call it
  /// before the first such step, otherwise that step allocates. Throws Error as load() does.
  virtual void prepare(const Parameters&, [[maybe_unused]] bool bodies) {}
  /// Replaces the state: reset, teleport, origin rebasing, tests.
  virtual void upload(const StrandState& state) = 0;
  /// Copies the whole state out. Waits for pending steps.
  virtual void download(StrandState& state) = 0;

  /// Advances by parameters.time_step. May return before the work is done. Neither throws nor allocates after
  /// prepare() for these parameters.
  virtual void step(const StepInput& input) = 0;
  /// Positions after the newest step, m, natural order; valid until the next step(). Waits for pending steps.
  virtual std::span<const Vec3> guides() = 0;
  /// The array of guides(), in which only vertices `first` to `first` + `count` - 1 need hold positions of
  /// the newest step: a backend that computes elsewhere copies no others. Valid until the next call.
  virtual std::span<const Vec3> guidesOf([[maybe_unused]] size_t first, [[maybe_unused]] size_t count) {
    return guides();
  }
  /// Whether a strand may have diverged. False if every vertex is finite and within kDivergedReach times its
  /// strand's rest length of the root; true also where a test would need guides(). Waits for pending steps.
  virtual bool mayHaveDiverged() { return true; }
  /// Packs the guides where this backend keeps them, if not on the CPU: one entry per run of `grid`, valid
  /// until the next call. Empty where it does not. Waits for pending steps. The first call with a grid
  /// allocates, and throws Error if its device cannot.
  virtual std::span<const PackedRun> packGuides(const GuideGrid&, const PackingFrame&) { return {}; }

  /// Whether step() applies StepInput::accelerations and velocities() is available.
  virtual bool takesAccelerations() const { return false; }
  /// Allocates memory for accelerations. Call it before the first step that has some.
  virtual void prepareAccelerations() {}
  /// Velocities after the newest step, m/s, natural order; valid until the next step(). Empty if the backend
  /// takes no accelerations.
  virtual std::span<const Vec3> velocities() { return {}; }

  /// GPU time of the newest step whose measurement has arrived, s, without transfers. None on a CPU or if the
  /// driver does not measure. Never waits.
  virtual std::optional<double> gpuSeconds() { return std::nullopt; }
  /// The same of the newest packGuides().
  virtual std::optional<double> packSeconds() { return std::nullopt; }
};

/// A backend that this program has been built with.
struct BackendInfo {
  std::string name;
  bool available = false;
  std::string reason;  ///< the device if available, otherwise why not and the remedy
  int score = 0;       ///< `auto` takes the highest available one
  std::function<std::unique_ptr<Backend>(int threads)> create;  ///< threads: 0 = all; may throw Error
  std::vector<SolverKind> solvers{SolverKind::kRod};            ///< that it implements
};

/// The reference backend: float, scalar, one thread. Simple enough to read; tests compare the others with it.
std::unique_ptr<Backend> makeReferenceBackend();
/// The same source in double precision: the oracle of tests.
std::unique_ptr<Backend> makeOracleBackend();
/// Description of the reference backend for createBackend().
BackendInfo referenceBackendInfo();

/// Effect of air drag of `rate` (1/s) in a substep of `h` seconds, exact for forces that are constant in it
/// (exponential integrator; Hochbruck and Ostermann 2010; docs/solver.md (3)). The wind w and an acceleration
/// a change the velocity v to keep v + (1 - keep) w + a time2 / h. So terminal velocities, and wind that
/// balances weight and stiffness, are right in substeps of any length.
struct DragStep {
  DragStep(double rate, double h)
      : keep(std::exp(-rate * h)), time2(rate * h > 0 ? -std::expm1(-rate * h) * h / rate : h * h) {}
  double keep;   ///< exp(-rate h)
  double time2;  ///< s^2, h^2 without drag: displacement in the substep by an acceleration of 1 m/s^2
};

/// Creates the backend `name` ("auto" or a backend's name) from `known`. `auto` takes the available one of
/// highest score that has the solver; if creation fails it tries the next. Throws Error if none can run. A
/// named backend that cannot run is an Error, too: there is no silent fallback.
std::unique_ptr<Backend> createBackend(const std::vector<BackendInfo>& known, const std::string& name,
                                       int threads, SolverKind solver = SolverKind::kRod);

class AirSystem;  // air/air_system.h

/// Interface of accelerations besides gravity and contact: moving air, forces between hairs. Once per step,
/// before the substeps, it gives every vertex an acceleration, which the backend adds to gravity.
/// Implementations are in air/ and gpu_compute/.
class ExternalForces {
 public:
  virtual ~ExternalForces() = default;

  /// Whether these parameters need external forces. If not, no other member is called: they cost neither time
  /// nor memory.
  virtual bool isNeeded(const Parameters& parameters) const = 0;
  /// Configures for new parameters, which are valid; called before the first step that needs external forces.
  /// The model is the same in every call, and `backend` has loaded it. Calls backend.prepareAccelerations()
  /// if step() will fill input.accelerations. May allocate. Throws Error, with the strong exception
  /// guarantee, if the parameters do not fit.
  virtual void configure(const StrandModel& model, const Parameters& parameters, Backend& backend) = 0;
  /// Resets the air to its initial state: after a reset or a teleport, and when it is needed again. The
  /// backend and StepInput use `origin` (m, world) from now on; initially it is the world origin. May
  /// allocate; throws Error.
  virtual void reset(const Vec3& origin) = 0;
  /// Changes `origin` (m, world) only, while external forces are needed: the air keeps its state and its
  /// position in the world. May allocate; throws Error.
  virtual void moveOrigin(const Vec3& origin) = 0;

  /// Advances by the step that `backend` is about to do. Computes accelerations from the backend's positions
  /// and velocities. Writes them to input.accelerations, valid until the next call, or directly to the
  /// backend's memory. Neither throws nor allocates.
  virtual void step(StepInput& input, Backend& backend) = 0;
  /// Accelerations of the newest step(), m/s^2 per vertex, natural order. Call it before the backend's own
  /// step. Waits if they are elsewhere than in input.accelerations.
  virtual std::span<const Vec3> accelerations() = 0;

  /// These forces as an air system; null for forces of another kind.
  virtual AirSystem* airSystem() { return nullptr; }
};

/// Whether the parameters alone need external forces.
bool needsExternalForces(const Parameters& parameters);

}  // namespace strandcast
