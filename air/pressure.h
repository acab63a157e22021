#pragma once
#include <memory>
#include <vector>

#include "air/grid_passes.h"
#include "air/wind.h"

namespace strandcast {

/// Solves for the pressure that removes the divergence of a wind grid: conjugate gradients with a multigrid
/// V-cycle as preconditioner (McAdams, Sifakis, Teran 2010, "A parallel multigrid Poisson solver for fluids
/// simulation on large grids"). Two Jacobi sweeps with Chebyshev weights before and after the coarse
/// correction; a coarse cell consists of eight fine cells.
template <class Scalar>
class PressureSolver {
 public:
  PressureSolver(const GridPasses<Scalar>& passes, const Workers& workers, int cells);

  /// Per face of `axis`: 1 open, 0 closed. From index (0, 0, 0), to be set before build(). Faces 0 and
  /// `cells` are the border of the grid; outside it the pressure is 0.
  Scalar* open(int axis) { return levels_[0].open[axis].data() + levels_[0].origin; }
  /// Builds the levels from open(). Does not allocate.
  void build();
  const PressureView<Scalar>& finest() const { return levels_[0].view; }

  /// Iterates from the given `pressure` (warm start) until the residual of every cell is at most `tolerance`
  /// (m/s). Arrays of the grid's shape, from index (0, 0, 0).
  PressureReport solve(const Scalar* right, Scalar* pressure, Scalar tolerance, int max_iterations);

 private:
  struct Level {
    size_t origin;  ///< offset of index (0, 0, 0)
    GridArray<Scalar> open[3], diagonal, inverse_diagonal, even, x, smoothed, right, left;
    PressureView<Scalar> view;
  };
  void computeDiagonal(Level& level);
  void markUniformRows(Level& level);
  void coarsen(const Level& fine, Level& coarse);
  template <class Work>
  void eachLayer(const Level& level, const Work& work) const;
  /// Runs stages over all layers. Layer k of a stage needs layers k - 1 to k + 1 of the stage before it.
  template <class... Stages>
  void pipelineLayers(const Level& level, const Stages&... stages) const;
  /// One V-cycle from level `at` down; the approximate solution is in level.smoothed.
  void cycle(size_t at, const Scalar* right);

  const GridPasses<Scalar>& passes_;
  const Workers& workers_;
  std::vector<Level> levels_;
  GridArray<Scalar> step_, image_, residual_;
  std::vector<double> sums_;     ///< per layer
  std::vector<Scalar> largest_;  ///< per layer
};

extern template class PressureSolver<float>;
extern template class PressureSolver<double>;

}  // namespace strandcast
