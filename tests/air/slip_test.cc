// Anisotropic drag: the momentum that the air loses equals the momentum that hair gains.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "air/air_system.h"
#include "air/hair_grid.h"
#include "air/wind_grid.h"
#include "core/simulation.h"
#include "kernels/scalar_grid.h"
#include "validation/specimen.h"

namespace strandcast {
namespace {

using Matrix = Eigen::Matrix3d;
using Vector = Eigen::Vector3d;

constexpr double kSlipStep = 1.0 / 60;

// Velocity after the exchange of air at `velocity` with hair that moves at `hair`, all strands along
// `direction`. exchange: rate x time step.
Vector dragged(const Vector& velocity, const Vector& hair, const Vector& direction, double exchange,
               double less) {
  const Matrix held = exchange * (Matrix::Identity() - less * direction * direction.transpose());
  return (Matrix::Identity() + held).inverse() * (velocity + held * hair);
}

TEST(Slip, IsAsTheMatrixSays) {
  using kernels::f64::real3;
  const Vector velocity(3, -1, 2), hair(0.5, 0.25, -1);
  for (const double exchange : {1e-4, 0.3, 20.0, 1e4})
    for (const double less : {0.0, 0.5, 1.0})
      for (const Vector& direction : {Vector::UnitX().eval(), Vector::UnitY().eval(), Vector::UnitZ().eval(),
                                      Vector(1, 2, -3).normalized().eval()}) {
        const Matrix slip = less * exchange * direction * direction.transpose();
        const Vector momentum = (exchange * Matrix::Identity() - slip) * hair;
        const real3 got = kernels::f64::draggedAmong(
            {velocity.x(), velocity.y(), velocity.z()}, {momentum.x(), momentum.y(), momentum.z()}, exchange,
            {slip(0, 0), slip(1, 1), slip(2, 2)}, {slip(1, 2), slip(0, 2), slip(0, 1)});
        const Vector truth = dragged(velocity, hair, direction, exchange, less);
        EXPECT_LT((Vector(got.x, got.y, got.z) - truth).norm(), 1e-10 * (1 + exchange))
            << exchange << " " << less;
        if (less == 0) {
          EXPECT_NEAR(got.x, kernels::f64::draggedTo(velocity.x(), hair.x(), exchange), 1e-12);
        }
      }
}

// Uniform air in a block of moving parallel hair.
template <class Scalar>
void expectExactInABlock(const GridPasses<Scalar>& passes, double tolerance) {
  const Workers workers(2);
  WindGrid<Scalar> grid(passes, workers, 32, 0.02f, Wind::Border::kOpen);
  grid.reserveSlip();
  const Vector hair(0.4, -0.2, 0.3), wind(3, 1, -2), direction = Vector(2, -1, 1).normalized();
  constexpr double kDensity = 0.8, kRate = 40, kLess = 0.7;
  const GridShape shape{32};
  GridArray<Scalar> nodes(4 * shape.size(), Scalar(0)), slip[2] = {nodes, nodes};
  const Matrix tensor = kDensity * direction * direction.transpose();
  const Vector along = tensor * hair;
  const double of_slip[2][4] = {{along.x(), along.y(), along.z(), tensor(0, 0)},
                                {tensor(1, 1), tensor(1, 2), tensor(0, 2), tensor(0, 1)}};
  for (int k = 4; k < 28; ++k)
    for (int j = 4; j < 28; ++j)
      for (int i = 4; i < 28; ++i)
        for (size_t c = 0; c < 4; ++c) {
          const size_t at = 4 * shape.at(i, j, k) + c;
          nodes[at] = static_cast<Scalar>(c < 3 ? kDensity * hair[static_cast<int>(c)] : kDensity);
          for (size_t part = 0; part < 2; ++part) slip[part][at] = static_cast<Scalar>(of_slip[part][c]);
        }
  const size_t origin = 4 * shape.at(0, 0, 0);
  const Vec3 corner = grid.origin();
  const Scalar per_cell = 1 / static_cast<Scalar>(grid.cell());
  const Scalar frame[12] = {per_cell,
                            0,
                            0,
                            0,
                            per_cell,
                            0,
                            0,
                            0,
                            per_cell,
                            -static_cast<Scalar>(corner.x()) * per_cell,
                            -static_cast<Scalar>(corner.y()) * per_cell,
                            -static_cast<Scalar>(corner.z()) * per_cell};
  HairDrag<Scalar> drag;
  drag.shape = &shape;
  drag.nodes = nodes.data() + origin;
  drag.frame = frame;
  drag.box = NodeBox(Eigen::Vector3i::Constant(4), Eigen::Vector3i::Constant(27));
  drag.rate = static_cast<Scalar>(kRate);
  drag.less = static_cast<Scalar>(kLess);
  for (size_t part = 0; part < 2; ++part) drag.slip[part] = slip[part].data() + origin;
  grid.setVelocity([&](const Vec3&) { return wind.cast<float>(); });
  grid.exchange(kSlipStep, drag);
  const Vector within = dragged(wind, hair, direction, kSlipStep * kRate * kDensity, kLess);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(grid.component(axis, 16, 15, 17), within[axis], tolerance) << axis;
    EXPECT_NEAR(grid.component(axis, 2, 15, 17), wind[axis], tolerance) << axis;
  }
  // The slip terms of this step do not affect the next one.
  grid.setVelocity([&](const Vec3&) { return wind.cast<float>(); });
  drag.slip[0] = drag.slip[1] = nullptr;
  grid.exchange(kSlipStep, drag);
  const Vector alike = dragged(wind, hair, direction, kSlipStep * kRate * kDensity, 0);
  for (int axis = 0; axis < 3; ++axis)
    EXPECT_NEAR(grid.component(axis, 16, 15, 17), alike[axis], tolerance) << axis;
}

TEST(Slip, EvenAirInABlockOfHairIsExact) {
  expectExactInABlock(scalarPasses<double>(), 1e-6);
  expectExactInABlock(scalarPasses<float>(), 2e-6);
  expectExactInABlock(simdPasses(), 2e-6);
}

// Strands that stand out of a ball in all directions, with random velocities.
struct Urchin {
  StrandModel model;
  StrandState state;

  Urchin() {
    std::vector<StrandPoints> strands;
    for (int s = 0; s < 200; ++s) {
      const auto n = static_cast<float>(s);
      strands.push_back(straightStrand(
          0.1, 5 + s % 9, Vec3(std::sin(n), std::cos(1.7f * n), std::sin(2.3f * n + 1)).normalized()));
    }
    model = modelOf(strands);
    state = restState(model, model.rest_roots);
    for (size_t v = 0; v < model.vertices(); ++v) {
      const auto n = static_cast<float>(v);
      state.velocities[v] = Vec3(std::sin(1.3f * n), std::cos(2.9f * n), 1 + std::sin(n));
    }
  }
};

template <class Scalar>
std::vector<double> slipOf(const GridPasses<Scalar>& passes, int threads, const Urchin& urchin) {
  const Workers workers(threads);
  HairGrid<Scalar> grid(passes, workers, urchin.model, 32, restBox(urchin.model));
  grid.reserveSlip();
  std::vector<double> out;
  for (int step = 0; step < 2; ++step) {
    grid.locate(urchin.state.positions, urchin.state.velocities, Pose{});
    grid.splat();
    grid.splatSlip(urchin.state.positions);
  }
  const GridShape& shape = grid.shape();
  for (int part = 0; part < 3; ++part) {
    const Scalar* nodes = part < 2 ? grid.slipNodes(static_cast<size_t>(part)) : grid.dragNodes();
    const size_t origin = shape.at(0, 0, 0);
    for (int k = 0; k < shape.cells; ++k)
      for (int j = 0; j < shape.cells; ++j)
        for (int i = 0; i < shape.cells; ++i)
          for (size_t c = 0; c < 4; ++c)
            out.push_back(static_cast<double>(nodes[4 * (shape.at(i, j, k) - origin) + c]));
  }
  return out;
}

TEST(Slip, HairHasTheDirectionsAndMotionsOfItsPieces) {
  const Urchin urchin;
  const StrandModel& model = urchin.model;
  const std::vector<double> exact = slipOf(scalarPasses<double>(), 1, urchin),
                            lanes = slipOf(simdPasses(), 1, urchin),
                            threads = slipOf(simdPasses(), 5, urchin);
  EXPECT_EQ(lanes, threads);
  double largest = 0, off = 0;
  for (size_t n = 0; n < exact.size(); ++n) {
    largest = std::max(largest, std::fabs(exact[n]));
    off = std::max(off, std::fabs(lanes[n] - exact[n]));
  }
  EXPECT_LT(off, 1e-5 * largest);
  // Sums over all strands. They are straight, so every piece has the direction of its strand.
  Matrix tensor = Matrix::Zero();
  Vector along = Vector::Zero();
  for (size_t s = 0; s < model.strands(); ++s) {
    const uint32_t first = model.offsets[s], last = model.offsets[s + 1] - 1;
    const Vector t =
        (urchin.state.positions[last] - urchin.state.positions[first]).cast<double>().normalized();
    for (uint32_t v = first; v <= last; ++v) {
      const double mass = static_cast<double>(model.mass[v]) * static_cast<double>(model.reference_mass[s]);
      tensor += mass * t * t.transpose();
      along += mass * t * t.dot(urchin.state.velocities[v].cast<double>());
    }
  }
  double sums[2][4] = {};
  const size_t nodes = exact.size() / 12;
  for (size_t part = 0; part < 2; ++part)
    for (size_t n = 0; n < nodes; ++n)
      for (size_t c = 0; c < 4; ++c) sums[part][c] += exact[4 * (part * nodes + n) + c];
  const float cell = HairGrid<float>(scalarPasses<float>(), Workers(1), model, 32, restBox(model)).cell();
  const double volume = std::pow(static_cast<double>(cell), 3), mass = tensor.trace();
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(sums[0][c] * volume, along[c], 1e-4 * mass) << c;
  const double truth[] = {tensor(0, 0), tensor(1, 1), tensor(1, 2), tensor(0, 2), tensor(0, 1)};
  const double got[] = {sums[0][3], sums[1][0], sums[1][1], sums[1][2], sums[1][3]};
  for (int c = 0; c < 5; ++c) EXPECT_NEAR(got[c] * volume, truth[c], 1e-4 * mass) << c;
}

// A mat of strands along X in wind along or across them: the loss of wind in its middle in a step, m/s.
double heldBack(const Vec3& wind, float along) {
  std::vector<StrandPoints> strands;
  for (int s = 0; s < 400; ++s) {
    StrandPoints points = straightStrand(0.2, 16, Vec3::UnitX());
    for (Vec3& p : points)
      p += Vec3(0, 0.01f * static_cast<float>(s % 20), 0.01f * static_cast<float>(s / 20));
    strands.push_back(points);
  }
  auto after = [&](float hairs) {
    Parameters parameters;
    parameters.solver = SolverKind::kRod;
    parameters.wind = wind;
    parameters.wind_grid = 1;
    parameters.air_drag = 5;
    parameters.air_drag_along = along;
    parameters.hairs_per_strand = hairs;
    Simulation simulation(modelOf(strands), {}, parameters, makeReferenceBackend(),
                          cpuAir("reference").make({}));
    simulation.step();
    return airSystem(simulation.externalForces())->at(Vec3(0.1f, 0.1f, 0.1f)).wind;
  };
  return static_cast<double>((after(0) - after(20)).dot(wind.normalized()));
}

TEST(Slip, AirGoesThroughHairAlongItAsFarAsTheDragSays) {
  const Vec3 along_it(3, 0, 0), across(0, 3, 0);
  EXPECT_GT(heldBack(across, 1), 0.05);
  EXPECT_NEAR(heldBack(across, 0) / heldBack(across, 1), 1, 0.02);
  EXPECT_NEAR(heldBack(along_it, 0.5f) / heldBack(along_it, 1), 0.5, 0.1);
  EXPECT_NEAR(heldBack(along_it, 0) / heldBack(along_it, 1), 0, 0.02);
}

}  // namespace
}  // namespace strandcast
