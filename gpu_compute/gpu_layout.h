#pragma once
#include <cstdint>

#include "core/backend.h"

namespace strandcast::gpu {

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

}  // namespace strandcast::gpu
