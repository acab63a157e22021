// Input of a step in the layout of shaders/step_input.glsl: bodies and settings; and whether its bodies
// continue those of the step before.
#pragma once
#include <cstdint>
#include <vector>

#include "core/backend.h"
#include "core/broad_phase.h"

namespace strandcast::gpu {

/// A body at the end of a substep, as PlacedBody of shaders/step_input.glsl, std430. Its members are those of
/// SubstepBody of core/body_surface.inl.
struct alignas(16) PlacedBody {
  float middle[3];    ///< m, centre of the bounding ball
  float ball;         ///< m, radius of the bounding ball, with the hair's radius; 1e18 for planes
  float a[3];         ///< m
  float radius;       ///< m
  float b[3];         ///< m; of a plane, its unit normal
  float radius_b;     ///< m
  float a_motion[3];  ///< m, displacement of a in the substep
  float friction;     ///< coefficient
  float turn[3];      ///< radians, rotation vector of the substep, about a
  uint32_t kind;      ///< PrimitiveKind
  float rotation[4];  ///< x y z w; of ellipsoids, boxes, convex bodies and fields only
  float extent[3];    ///< m, half axes or half edges
  uint32_t data;      ///< as MovingPrimitive::data
  uint32_t extra;     ///< as MovingPrimitive::extra
  uint32_t leader;    ///< set by placeBodies(): see Leaders
  float time;         ///< fraction of the step that has passed, 0 to 1
  float bend_shift;   ///< set by placeBodies(): m, bound on the motion by bending in the substep
};
static_assert(sizeof(PlacedBody) == 128);

/// The body at `time`, the fraction of the step that has passed, 0 to 1. a_motion and turn are those of the
/// fraction `part` of the step, which lasts `seconds` s. `hair_radius` in m. `leader` and `bend_shift` are 0.
PlacedBody placedBody(const MovingPrimitive& primitive, double time, double part, double seconds,
                      float hair_radius);

/// Groups bodies whose motion in the step agrees for all points within some metres (to kMotionTolerance of
/// shaders/step_input.glsl). The first body of a group is the leader of all: bounds on relative travel are
/// computed for leaders only.
class Leaders {
 public:
  /// Reserves memory: groupByMotion() of up to `bodies` bodies does not allocate.
  void reserve(size_t bodies);
  /// Finds the leaders of `bodies`.
  void groupByMotion(std::span<const MovingPrimitive> bodies);
  uint32_t of(size_t body) const { return leaders_[body]; }
  /// Writes `near` (offsets, then bodies), then lists of the same form with the leaders of these bodies, each
  /// leader once per list. Writes at most twice as many words as `near` has. After groupByMotion().
  void writeLists(const NearBodyLists& near, uint32_t* out);

 private:
  std::vector<uint32_t> leaders_;
  std::vector<size_t> listed_;  // per leader, the last list that has it, counted from 1
};

/// Writes all bodies of the step as at the end of its first substep, then of the second, and so on: bodies x
/// substeps entries.
void placeBodies(const StepInput& input, const Leaders& leaders, PlacedBody* out);

/// The uniform block of shaders/step_input.glsl, std140. Vectors use three of their four numbers.
struct Settings {
  float gravity[4];     ///< m/s^2
  float wind[4];        ///< m/s
  float keep;           ///< exp(-drag substep)
  float time2;          ///< s^2, displacement per acceleration in a substep: DragStep::time2
  float substep;        ///< s
  float per_substep;    ///< 1/s
  float strength_root;  ///< of the angular constraint, per iteration, 0 to 1
  float strength_tip;
  float damping_time;  ///< s, of the rod
  float hair_radius;   ///< m
  float air_drag;      ///< 1/s, before grooming factors
  float goal_rate;     ///< 1/s
  uint32_t substeps;
  uint32_t iterations;
  uint32_t body_count;
  uint32_t strand_count;
  uint32_t bone_count;
  uint32_t neighbourhoods;  ///< near-body lists; 0: every strand may touch every body
};
static_assert(sizeof(Settings) == 96);
static_assert(sizeof(Pose) == 28);  // shaders read poses as 7 floats: position, rotation x y z w

/// The settings of a step of `model`.
Settings settingsOf(const StepInput& input, const StrandModel& model);

/// Remembers the bodies of the newest step, to decide whether the contact cache remains valid in the next.
class PreviousBodies {
 public:
  /// Call it once per step, in order. True if the step has the bodies of the step before, each starts where
  /// it ended, and the near-body lists and the hair's radius are the same.
  bool matchesNext(const StepInput& input);

 private:
  bool isContinuation(const StepInput& input) const;

  std::vector<MovingPrimitive> bodies_;
  bool listed_ = false;
  NearBodyLists near_;
  uint64_t shapes_revision_ = 0;
  float hair_radius_ = 0;
};

}  // namespace strandcast::gpu
