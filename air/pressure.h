#pragma once
#include <memory>
#include <vector>

#include "air/grid_passes.h"
#include "air/wind.h"
#include "air/workers.h"

namespace strandcast {

/// The pressure that takes the divergence from a wind grid: conjugate gradients, preconditioned by a
/// multigrid V-cycle (McAdams, Sifakis, Teran 2010, "A parallel multigrid Poisson solver for fluids
/// simulation on large grids"). Two Jacobi sweeps before and after, with Chebyshev's weights; cells join by
/// eights.
template <class Scalar>
class PressureSolver {
 public:
  PressureSolver(const GridPasses<Scalar>& passes, const Workers& workers, int cells);

  /// 1 or 0 per face of `axis`, from place (0, 0, 0), to be set before build(). Places 0 and `cells` are the
  /// grid's border; beyond it the pressure is 0.
  Scalar* open(int axis) { return levels_[0].open[axis].data() + levels_[0].origin; }
  void build();
  const PressureView<Scalar>& finest() const { return levels_[0].view; }

  /// From `pressure` as it is, until no cell's residual is above `tolerance` (m/s). Arrays of the grid's
  /// shape, from place (0, 0, 0).
  PressureReport solve(const Scalar* right, Scalar* pressure, Scalar tolerance, int most_iterations);

 private:
  struct Level {
    size_t origin;  ///< of place (0, 0, 0)
    GridArray<Scalar> open[3], diagonal, inverse_diagonal, even, x, smoothed, right, left;
    PressureView<Scalar> view;
  };
  void findDiagonal(Level& level);
  void findEvenRows(Level& level);
  void coarsen(const Level& fine, Level& coarse);
  template <class Work>
  void eachLayer(const Level& level, const Work& work) const;
  /// Stages that each need layers k - 1 to k + 1 of the one before it for their layer k.
  template <class... Stages>
  void inTurn(const Level& level, const Stages&... stages) const;
  /// Approximate solution in level.smoothed.
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
