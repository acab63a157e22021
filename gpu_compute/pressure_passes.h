#pragma once
#include "air/wind.h"
#include "gpu_compute/air_layout.h"
#include "gpu_compute/strand_groups.h"

namespace strandcast::gpu {

/// Pressure solve of a wind grid, which removes the divergence: conjugate gradients as in air/pressure.h. The
/// preconditioner is the exact solution of the same box without bodies, in its sine modes (between walls:
/// cosine modes; Buzbee, Golub, Nielson 1970, "On Direct Methods for Solving Poisson's Equations"). Bodies
/// change the system only where they are: around a ball the two systems differ by less than a factor of two,
/// whatever the size of a cell, because less of a harmonic's energy is inside the ball than outside.
///
/// An iteration is three dispatches. Transforms are matrix products: their work is small beside the latency
/// of a dispatch. Precondition of every call: the context in which it was constructed is current.
class PressurePasses {
 public:
  /// `cells`: per axis, 16 to 128, a multiple of 16. Compiles its shaders; may throw Error.
  PressurePasses(int cells, Wind::Border border, ProgramCache& programs);

  /// Starts a solve. Call it before the pass that writes the right-hand sides.
  void begin();
  /// Improves `pressure` in place by up to `iterations`, fewer if the residual reaches the tolerance. May be
  /// called again for more iterations.
  void solve(int iterations, const gl::Buffer& pressure);
  const gl::Buffer& masks() const { return masks_; }    ///< per cell: open faces, see pressure_solve.glsl
  const gl::Buffer& rights() const { return rights_; }  ///< per cell: right-hand side, m/s
  const gl::Buffer& state() const { return state_; }    ///< one State

  /// Solve of shaders/pressure_solve.glsl, which has the units.
  struct State {
    uint32_t fastest, residual_now;
    int32_t done, iterations;
    float residual, products[2], lengths[2];
  };
  /// Waits for the GPU.
  State download() const;
  /// Iterations, and the residual after the last step, m/s.
  static PressureReport reportOf(const State& state);

 private:
  void step(const gl::Program& program) const;

  int cells_;
  gl::Buffer state_, masks_, rights_, residuals_, steps_, images_, corrections_, correction_images_,
      products_, modes_, planes_, matrices_, eigenvalues_;
  int done_iterations_ = 0;  ///< recorded since begin()
  const gl::Program *first_step_, *next_step_, *of_modes_, *correct_;
};

}  // namespace strandcast::gpu
