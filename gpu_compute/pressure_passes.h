#pragma once
#include "air/wind.h"
#include "gpu_compute/air_layout.h"
#include "gpu_compute/strand_groups.h"

namespace strandcast::gpu {

/// The pressure that takes the divergence from a wind grid: conjugate gradients, as in air/pressure.h, but
/// preconditioned by the exact solution of the same box without bodies, in its sine modes (between walls:
/// cosine modes; Buzbee, Golub, Nielson 1970, "On Direct Methods for Solving Poisson's Equations"). Bodies
/// change the system only where they are: around a ball the two differ by less than a factor of two, whatever
/// the size of a cell, for less of a harmonic's energy is inside than outside. An iteration is three
/// dispatches. A transform is a product with a matrix: its work is small beside what a dispatch waits.
class PressurePasses {
 public:
  PressurePasses(int cells, Wind::Border border, ProgramCache& programs);

  /// Before the right-hand side is found: nothing is solved yet.
  void begin();
  /// From `pressure` as it is: up to `iterations`, fewer where the residual is small enough before. May be
  /// called again for more.
  void solve(int iterations, const gl::Buffer& pressure);
  const gl::Buffer& masks() const { return masks_; }
  const gl::Buffer& rights() const { return rights_; }
  const gl::Buffer& state() const { return state_; }

  /// shaders/pressure_solve.glsl
  struct State {
    uint32_t fastest, residual_now;
    int32_t done, iterations;
    float residual, products[2], lengths[2];
  };
  /// Waits.
  State download() const;
  static PressureReport reportOf(const State& state);

 private:
  void step(const gl::Program& program) const;

  int cells_;
  gl::Buffer state_, masks_, rights_, residuals_, steps_, images_, corrections_, correction_images_,
      products_, modes_, planes_, matrices_, eigenvalues_;
  int done_iterations_ = 0;  ///< commands given since begin()
  const gl::Program *first_step_, *next_step_, *of_modes_, *correct_;
};

}  // namespace strandcast::gpu
