#include "air/pressure.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace strandcast {
namespace {

constexpr int kCellsOfOneThread =
    32;  ///< per axis; up to this size one thread does all layers, for waking others costs more

}  // namespace

template <class Scalar>
PressureSolver<Scalar>::PressureSolver(const GridPasses<Scalar>& passes, const Workers& workers, int cells)
    : passes_(passes), workers_(workers) {
  for (int n = cells;; n /= 2) {
    Level& level = levels_.emplace_back();
    level.view.shape.cells = n;
    if (n <= kCoarsest || n % 2 != 0) break;
  }
  for (Level& level : levels_) {
    const GridShape& s = level.view.shape;
    level.origin = s.at(0, 0, 0);
    for (GridArray<Scalar>* array :
         {&level.open[0], &level.open[1], &level.open[2], &level.diagonal, &level.inverse_diagonal, &level.x,
          &level.smoothed, &level.right, &level.left})
      array->assign(s.size(), Scalar(0));
    for (int axis = 0; axis < 3; ++axis) level.view.open[axis] = level.open[axis].data() + level.origin;
    level.view.diagonal = level.diagonal.data() + level.origin;
    level.view.inverse_diagonal = level.inverse_diagonal.data() + level.origin;
    level.even.assign(static_cast<size_t>(s.cells) * static_cast<size_t>(s.cells), Scalar(0));
    level.view.even = level.even.data();
  }
  for (GridArray<Scalar>* array : {&step_, &image_, &residual_})
    array->assign(levels_[0].view.shape.size(), Scalar(0));
  sums_.resize(cells);
  largest_.resize(cells);
}

template <class Scalar>
template <class Work>
void PressureSolver<Scalar>::eachLayer(const Level& level, const Work& work) const {
  const int n = level.view.shape.cells;
  if (n <= kCellsOfOneThread) {
    for (int k = 0; k < n; ++k) work(k);
  } else {
    workers_.forEach(n, work);
  }
}

// On one thread each stage follows the one before it at a distance of one layer, whose results are still in
// the L1 cache.
template <class Scalar>
template <class... Stages>
void PressureSolver<Scalar>::pipelineLayers(const Level& level, const Stages&... stages) const {
  const int n = level.view.shape.cells;
  if (n > kCellsOfOneThread && workers_.threads() > 1) {
    (eachLayer(level, stages), ...);
    return;
  }
  for (int step = 0; step < n + static_cast<int>(sizeof...(stages)) - 1; ++step) {
    int k = step;
    auto next = [&](const auto& stage) {
      if (k >= 0 && k < n) stage(k);
      --k;
    };
    (next(stages), ...);
  }
}

template <class Scalar>
void PressureSolver<Scalar>::computeDiagonal(Level& level) {
  const GridShape& s = level.view.shape;
  eachLayer(level, [&](int k) {
    for (int j = 0; j < s.cells; ++j)
      for (int i = 0; i < s.cells; ++i) {
        const size_t c = s.at(i, j, k);
        Scalar sum = 0;
        for (int axis = 0; axis < 3; ++axis) sum += level.open[axis][c] + level.open[axis][c + s.next(axis)];
        level.diagonal[c] = sum;
        level.inverse_diagonal[c] = sum > 0 ? 1 / sum : 0;
      }
  });
}

template <class Scalar>
void PressureSolver<Scalar>::markUniformRows(Level& level) {
  const GridShape& s = level.view.shape;
  eachLayer(level, [&](int k) {
    for (int j = 0; j < s.cells; ++j) {
      const size_t row = s.at(0, j, k);
      const Scalar weight = level.open[0][row];
      bool even = true;
      for (size_t c = row; c < row + static_cast<size_t>(s.cells); ++c)
        for (int axis = 0; axis < 3; ++axis)
          even = even && level.open[axis][c] == weight && level.open[axis][c + s.next(axis)] == weight;
      level.even[static_cast<size_t>(k * s.cells + j)] = even ? weight : Scalar(0);
    }
  });
}

// A coarse face has the sum of the weights of its four fine faces, halved: the distance of cell centres is
// twice as long.
template <class Scalar>
void PressureSolver<Scalar>::coarsen(const Level& fine, Level& coarse) {
  const GridShape &f = fine.view.shape, &c = coarse.view.shape;
  for (int axis = 0; axis < 3; ++axis) {
    const size_t across[2] = {f.next((axis + 1) % 3), f.next((axis + 2) % 3)};
    for (int k = 0; k < c.cells + (axis == 2); ++k)
      for (int j = 0; j < c.cells + (axis == 1); ++j)
        for (int i = 0; i < c.cells + (axis == 0); ++i) {
          const Scalar* open = fine.open[axis].data() + f.at(2 * i, 2 * j, 2 * k);
          coarse.open[axis][c.at(i, j, k)] =
              Scalar(0.5) * (open[0] + open[across[0]] + open[across[1]] + open[across[0] + across[1]]);
        }
  }
}

template <class Scalar>
void PressureSolver<Scalar>::build() {
  for (size_t l = 0; l < levels_.size(); ++l) {
    if (l > 0) coarsen(levels_[l - 1], levels_[l]);
    computeDiagonal(levels_[l]);
    markUniformRows(levels_[l]);
  }
}

template <class Scalar>
void PressureSolver<Scalar>::cycle(size_t at, const Scalar* right) {
  Level& level = levels_[at];
  const GridShape& s = level.view.shape;
  Scalar *x = level.x.data() + level.origin, *y = level.smoothed.data() + level.origin;
  const Scalar first = static_cast<Scalar>(kFirstWeight), second = static_cast<Scalar>(kSecondWeight);
  auto smooth = [&](const Scalar* from, Scalar* to, Scalar weight) {
    return [&, from, to, weight](int k) { passes_.smooth(level.view, from, right, weight, to, k); };
  };
  if (at + 1 == levels_.size()) {
    std::fill(level.smoothed.begin(), level.smoothed.end(), Scalar(0));
    for (int i = 0; i < kCoarsestSweeps; ++i)
      pipelineLayers(level, smooth(y, x, i % 2 == 0 ? first : second),
                     smooth(x, y, i % 2 == 0 ? second : first));
    return;
  }
  Scalar* left = level.left.data() + level.origin;
  Level& coarse = levels_[at + 1];
  const GridShape& c = coarse.view.shape;
  Scalar *coarse_right = coarse.right.data() + coarse.origin,
         *coarse_x = coarse.smoothed.data() + coarse.origin;
  pipelineLayers(
      level, smooth(nullptr, x, first), smooth(x, y, second),
      [&](int k) { passes_.residual(level.view, y, right, left, k); },
      [&](int k) {
        if (k % 2 != 0) passes_.restrict(s, left, c, coarse_right, k / 2);
      });
  cycle(at + 1, coarse_right);
  pipelineLayers(
      level, [&](int k) { passes_.prolong(level.view, c, coarse_x, y, k); }, smooth(y, x, second),
      smooth(x, y, first));
}

template <class Scalar>
PressureReport PressureSolver<Scalar>::solve(const Scalar* right, Scalar* pressure, Scalar tolerance,
                                             int max_iterations) {
  Level& top = levels_[0];
  const GridShape& s = top.view.shape;
  Scalar *step = step_.data() + top.origin, *image = image_.data() + top.origin,
         *r = residual_.data() + top.origin;
  const Scalar* z = top.smoothed.data() + top.origin;
  auto total = [&] { return std::accumulate(sums_.begin(), sums_.end(), 0.0); };
  auto most = [&] { return *std::max_element(largest_.begin(), largest_.end()); };
  eachLayer(top, [&](int k) {
    passes_.residual(top.view, pressure, right, r, k);
    largest_[k] = passes_.advance(s, 0, step, image, pressure, r, k);
  });
  PressureReport report;
  report.residual = static_cast<double>(most());
  double before = 0;
  while (report.residual > static_cast<double>(tolerance) && report.iterations < max_iterations) {
    cycle(0, r);
    eachLayer(top, [&](int k) { sums_[k] = passes_.dot(s, r, z, k); });
    const double now = total();
    const Scalar turn = report.iterations > 0 ? static_cast<Scalar>(now / before) : Scalar(0);
    before = now;
    pipelineLayers(
        top, [&](int k) { passes_.updateDirection(s, turn, z, step, k); },
        [&](int k) { sums_[k] = passes_.apply(top.view, step, image, k); });
    const double curvature = total();
    if (!(curvature > 0)) break;
    const Scalar length = static_cast<Scalar>(now / curvature);
    eachLayer(top, [&](int k) { largest_[k] = passes_.advance(s, length, step, image, pressure, r, k); });
    report.residual = static_cast<double>(most());
    ++report.iterations;
  }
  return report;
}

template class PressureSolver<float>;
template class PressureSolver<double>;

}  // namespace strandcast
