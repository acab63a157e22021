#pragma once
#include <array>
#include <vector>

#include "air/wind.h"
#include "gpu_compute/air_layout.h"
#include "gpu_compute/strand_groups.h"

namespace strandcast::gpu {

/// air/pressure.h as compute shaders: the same conjugate gradients and the same V-cycle. A leg of the cycle
/// on a level is one dispatch, by blocks of 8^3 cells that also do what they need of their neighbours; levels
/// of 16^3 and below are one workgroup's.
class PressurePasses {
 public:
  PressurePasses(int cells, ProgramCache& programs);

  /// Before the right-hand side is found: nothing is solved yet.
  void begin();
  /// One dispatch after the other, to be called once all of these are written.
  void coarsen();
  /// From `pressure` as it is: up to `iterations`, fewer where the residual is small enough before. May be
  /// called again for more.
  void solve(int iterations, const gl::Buffer& pressure);
  const gl::Buffer& masks() const { return masks_; }
  const gl::Buffer& rights() const { return rights_; }
  const gl::Buffer& state() const { return state_; }

  /// shaders/pressure_level.glsl
  struct State {
    uint32_t fastest, residual_now;
    int32_t done, iterations;
    float residual, products[2];
    int32_t padding;
  };
  /// Waits.
  State download() const;
  static PressureReport reportOf(const State& state);

 private:
  struct Level {
    int cells, first_weight;
    gl::Buffer rights, smoothed, results;
  };
  void down(size_t level) const;
  void up(size_t level) const;
  void bottom() const;

  int cells_;
  size_t tiled_;  ///< levels that are done by blocks
  std::vector<Level> levels_;
  gl::Buffer state_, masks_, rights_, weights_, products_, image_products_, images_;
  std::array<gl::Buffer, 2> residuals_, steps_;
  int done_iterations_ = 0;  ///< commands given since begin()
  const gl::Program *first_down_, *next_down_, *coarse_down_, *fine_up_, *coarse_up_, *apply_, *bottom_,
      *fine_coarsen_, *coarse_coarsen_;
};

}  // namespace strandcast::gpu
