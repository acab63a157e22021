#pragma once
#include <span>

#include "air/grid_passes.h"
#include "air/pressure.h"
#include "air/wind.h"
#include "air/wind_source.h"

namespace strandcast {

/// Drag of hair on the air, as splatted on the hair grid.
template <class Scalar>
struct HairDrag {
  const GridShape* shape = nullptr;  ///< shape of the hair grid
  const Scalar* nodes =
      nullptr;  ///< from index (0, 0, 0): momentum per volume (kg/(m^2 s)), density (kg/m^3)
  const Scalar* frame = nullptr;  ///< positions (m) to its cells, as SplatView::frame
  NodeBox box;                    ///< nodes outside are empty
  Scalar rate = 0;  ///< m^3/(kg s): rate at which air approaches the hair's velocity, per density of hair
  /// HairGrid::slipNodes(); null: drag is isotropic.
  const Scalar* slip[2] = {};
  Scalar less = 0;  ///< 1 - (drag along a strand / drag across it)
};

/// The wind of the CPU backends. `passes` and `workers` must outlive it.
template <class Scalar>
class WindGrid : public Wind {
 public:
  WindGrid(const GridPasses<Scalar>& passes, const Workers& workers, int cells, float cell, Border border);

  int cells() const override { return shape_.cells; }
  float cell() const override { return cell_; }
  Vec3 origin() const override { return box_.corner(); }
  Ambient& ambient() override { return ambient_; }
  void centreAt(const Vec3& middle) override;
  /// As WindBox::moveOrigin(): the air keeps its place in the world. The caller rebases ambient() too.
  void moveOrigin(const Vec3& way) {
    box_.moveOrigin(way);
    target_divergence_valid_ = false;
  }
  void reset() override;
  void setComponents(const Component& value) override;
  void clearSolids() override;
  void addSolids(std::span<const MovingPrimitive> bodies, std::span<const uint32_t> words,
                 double seconds) override;
  /// Makes cells in `box` solid whose centre has a negative distance; their velocity is velocity(point), m/s.
  /// distances(points, out): signed distances of a std::span<const Vec3>, m; absolute values must not exceed
  /// the true ones.
  template <class Distances, class Velocity>
  void addSolid(const Box& box, const Distances& distances, const Velocity& velocity);

  void setSources(std::span<const WindSource> sources) override;
  void advect(double seconds, bool mac_cormack) override;
  void diffuse(double seconds, double viscosity) override;
  void exchange(double seconds) override { exchange(seconds, {}); }
  void exchange(double seconds, const HairDrag<Scalar>& hair);
  /// Allocates memory for HairDrag::slip. Precondition of exchange() with it, which does not allocate.
  void reserveSlip();
  PressureReport project() override;

  Vec3 velocityAt(const Vec3& point) const override;
  double largestOutflow() override;
  double fastest() const override;
  double component(int axis, int i, int j, int k) const override {
    return static_cast<double>(velocity_[axis][shape_.at(i, j, k)]);
  }
  double pressureAt(int i, int j, int k) const { return static_cast<double>(pressure_[shape_.at(i, j, k)]); }
  bool isSolid(int i, int j, int k) const { return solid_[shape_.at(i, j, k)] != 0; }

  const GridShape& shape() const { return shape_; }
  /// Velocities of cell centres, m/s, 4 numbers each, from index (0, 0, 0).
  const Scalar* centres() const { return centre_.data() + 4 * shape_.at(0, 0, 0); }

 private:
  WindView<Scalar> view();
  int layersOf(int axis) const { return axis == 2 ? shape_.cells + 1 : shape_.cells; }
  void closeFaces();
  /// Range [first, last) of cells of a row that may contain hair. `at`: position of cell 0 in the hair grid,
  /// in its cells; `step`: increment from cell to cell.
  std::pair<int, int> cellsInHair(const HairDrag<Scalar>& hair, const Scalar* at, const Scalar* step) const;
  /// Exchange with hair of cells `from` .. `from` + count - 1, at `places` of the hair grid. `sampled`:
  /// scratch.
  void computeExchangeWithHair(double seconds, const HairDrag<Scalar>& hair, size_t from, size_t count,
                               const Scalar* places, Scalar* sampled);
  /// Exchange of a row with hair and sources. `places`, `sampled`: scratch memory for a row.
  void computeExchange(double seconds, const HairDrag<Scalar>& hair, const Scalar* target_divergence, int j,
                       int k, Scalar* places, Scalar* sampled);
  /// Target divergence x cell of spheres, m/s, solids ignored; null where there are no spheres.
  const Scalar* targetDivergence();
  /// The same, 0 in cells that are enclosed by solids: for WindView::target_divergence.
  const Scalar* targetDivergenceAmongSolids();
  /// Largest absolute value in a layer, of cells that are not solid.
  Scalar maxTargetDivergence(const Scalar* target_divergence, int k) const;
  void computeCentres();
  /// Calls work(axis, layer) for all layers of faces of all axes, concurrently.
  template <class Work>
  void eachFace(const Work& work) const;
  static Scalar ambientVelocity(const void* grid, int axis, const Scalar* place);

  const GridPasses<Scalar>& passes_;
  const Workers& workers_;
  GridShape shape_;
  float cell_;
  WindBox box_;
  Border border_;
  Ambient ambient_;
  GridArray<Scalar> velocity_[3], next_[3], displacement_[3], onward_[3], centre_, exchange_[4], pressure_,
      right_, places_, sampled_;
  std::vector<Scalar> fastest_;        ///< per layer
  std::vector<uint8_t> exchanges_;     ///< per row: 0 where exchange_ is 0
  std::vector<uint8_t> solid_;         ///< per cell, in the layout of shape_
  std::vector<uint8_t> closed_;        ///< solid_ that the solver was built for
  std::vector<uint32_t> solid_cells_;  ///< indices where solid_ is 1
  std::vector<Vec3> solid_velocity_;   ///< m/s, per cell, in the layout of shape_
  bool built_ = false;                 ///< solver_ was built
  std::vector<WindSource> drivers_, spheres_;
  GridArray<Scalar> slip_[6];                                             ///< empty until reserveSlip()
  GridArray<Scalar> target_divergence_, target_divergence_among_solids_;  ///< empty until there is a sphere
  bool target_divergence_valid_ = false;  ///< target_divergence_ is up to date with spheres_ and box_
  PressureSolver<Scalar> solver_;
};

template <class Scalar>
template <class Distances, class Velocity>
void WindGrid<Scalar>::addSolid(const Box& box, const Distances& distances, const Velocity& velocity) {
  const Vec3 corner = origin();
  int low[3], high[3];
  for (int axis = 0; axis < 3; ++axis) {
    low[axis] = std::max(0, static_cast<int>(std::floor((box.min()[axis] - corner[axis]) / cell_)) - 1);
    high[axis] =
        std::min(shape_.cells, static_cast<int>(std::ceil((box.max()[axis] - corner[axis]) / cell_)) + 1);
  }
  auto middleOf = [&](int i, int j, int k, float side) {
    return Vec3(corner + (Vec3(static_cast<float>(i), static_cast<float>(j), static_cast<float>(k)) +
                          Vec3::Constant(0.5f * side)) *
                             cell_);
  };
  // A block is on one side of the surface where the distance of its centre exceeds that to its cells'
  // centres.
  constexpr int kBlock = 4, kCells = kBlock * kBlock * kBlock, kMaxBlocks = 128 / kBlock;
  const float farthest = 1.01f * std::sqrt(3.0f) * 0.5f * static_cast<float>(kBlock - 1) * cell_;
  auto addBlock = [&](int bi, int bj, int bk, float away) {
    if (away > farthest) return;
    Vec3 points[kCells];
    size_t cells[kCells], count = 0;
    for (int k = bk; k < std::min(bk + kBlock, high[2]); ++k)
      for (int j = bj; j < std::min(bj + kBlock, high[1]); ++j)
        for (int i = bi; i < std::min(bi + kBlock, high[0]); ++i, ++count) {
          points[count] = middleOf(i, j, k, 1);
          cells[count] = shape_.at(i, j, k);
        }
    float distance[kCells];
    if (away < -farthest)
      std::fill_n(distance, count, away);
    else
      distances(std::span<const Vec3>(points, count), distance);
    for (size_t n = 0; n < count; ++n) {
      if (!(distance[n] < 0)) continue;
      const size_t c = cells[n];
      if (solid_[c] == 0) solid_cells_.push_back(static_cast<uint32_t>(c));
      solid_[c] = 1;
      solid_velocity_[c] = velocity(points[n]);
    }
  };
  for (int k = low[2]; k < high[2]; k += kBlock)
    for (int j = low[1]; j < high[1]; j += kBlock) {
      Vec3 middles[kMaxBlocks];
      float away[kMaxBlocks];
      size_t blocks = 0;
      for (int i = low[0]; i < high[0]; i += kBlock)
        middles[blocks++] = middleOf(i, j, k, static_cast<float>(kBlock));
      distances(std::span<const Vec3>(middles, blocks), away);
      for (size_t n = 0; n < blocks; ++n) addBlock(low[0] + kBlock * static_cast<int>(n), j, k, away[n]);
    }
}

extern template class WindGrid<float>;
extern template class WindGrid<double>;

}  // namespace strandcast
