#pragma once
#include <cstdint>
#include <vector>

#include "core/backend.h"
#include "core/broad_phase.h"

namespace strandcast::gpu {

/// A body at the end of a substep, of shaders/bodies.glsl, std430: what core/body_surface.inl works out for
/// the CPU.
struct alignas(16) PlacedBody {
  float middle[3];
  float ball;  ///< m, of a ball about the middle that holds the body and what it presses; beyond everything
               ///< for planes
  float a[3];
  float radius;
  float b[3];
  float radius_b;
  float a_motion[3];  ///< m, over the substep
  float friction;
  float turn[3];  ///< radians, over the substep, about a
  uint32_t kind;
  float rotation[4];  ///< x y z w
  float extent[3];
  uint32_t data;
  uint32_t extra;
  uint32_t leader;   ///< of placeBodies(): see Leaders
  float time;        ///< the part of the step that has passed, 0 to 1
  float bend_shift;  ///< of placeBodies(): m, at most what its bend moves it by in the substep
};
static_assert(sizeof(PlacedBody) == 128);

/// `time`: the part of the step that has passed, 0 to 1. Motion and turn are those of `part` of the step,
/// which takes `seconds`.
PlacedBody placedBody(const MovingPrimitive& primitive, double time, double part, double seconds,
                      float hair_radius);

/// Bodies that move points within some metres alike in a step: each has the first of them as its leader.
class Leaders {
 public:
  /// Finding those of up to so many bodies will not allocate.
  void reserve(size_t bodies);
  void find(std::span<const MovingPrimitive> bodies);
  uint32_t of(size_t body) const { return leaders_[body]; }
  /// Writes `near` (offsets, then bodies), and then the same of the leaders of these bodies, each once in a
  /// list. So many words at most: twice those of `near`. After find().
  void writeLists(const NearBodyLists& near, uint32_t* out);

 private:
  std::vector<uint32_t> leaders_;
  std::vector<size_t> listed_;  // of leaders, the number of the last list that they are in, from 1 on
};

/// Writes every body of the step at the end of its first substep, then of the next, and so on.
void placeBodies(const StepInput& input, const Leaders& leaders, PlacedBody* out);

}  // namespace strandcast::gpu
