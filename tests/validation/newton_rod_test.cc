#include "validation/newton_rod.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "core/backend.h"
#include "core/error.h"
#include "tests/validation/shaken_rod.h"
#include "validation/specimen.h"

namespace strandcast {
namespace {

StrandModel straight(double length, int edges, const Vec3& direction) {
  return modelOf({straightStrand(length, edges, direction)});
}

StrandModel curl(double length, int edges) { return modelOf({hungCurl(length, edges, 0.01)}); }

// Starts from rest without a jump of the acceleration.
Pose shaken(double time) { return shakenRoot(time, {.ramp = 0.25}); }

using Path = std::vector<Eigen::Vector3d>;  // positions of the tip, 60 per second
constexpr double kSeconds = 0.5, kDrag = 2;

Path pathOfNewton(const StrandModel& model, int rate) {
  const Pose rest = model.rest_roots[0];
  NewtonRod rod(model, 0, rodParameters(rate, kDrag), rest);
  Path path;
  for (int i = 1; i <= kSeconds * rate; ++i) {
    rod.step(shaken((i - 1.0) / rate) * rest, shaken(static_cast<double>(i) / rate) * rest);
    if (i % (rate / 60) == 0) path.push_back(rod.positions().back());
  }
  return path;
}

Path pathOfSolver(const StrandModel& model, int rate) {
  const Parameters parameters = rodParameters(rate, kDrag);
  std::vector<Pose> begin(1), end(1);
  const auto backend = makeOracleBackend();
  backend->load(model, restState(model, model.rest_roots));
  Path path;
  for (int i = 1; i <= kSeconds * rate; ++i) {
    end = {shaken(static_cast<double>(i) / rate)};
    backend->step({&parameters, begin, end});
    begin = end;
    if (i % (rate / 60) == 0) path.push_back(backend->guides().back().cast<double>());
  }
  return path;
}

double distance(const Path& a, const Path& b) {
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]).squaredNorm();
  return std::sqrt(sum / static_cast<double>(a.size()));
}

// Drop over reach of a heavy clamped elastica, theta'' = -gamma (1 - s) cos(theta), by shooting.
TEST(NewtonRod, ACantileverSagsAsTheElasticaDoes) {
  for (const auto& [gamma, exact, limit] :
       {std::tuple(1.0, 0.124562, 0.0015), std::tuple(10.0, 1.066802, 0.0015),
        std::tuple(100.0, 5.888105, 0.005)}) {
    const StrandModel model = straight(lengthOfGamma(gamma, Material{}), 32, Vec3::UnitX());
    NewtonRod rod(model, 0, rodParameters(120, 5), model.rest_roots[0]);
    for (int i = 0; i < 8 * 120; ++i) rod.step(model.rest_roots[0], model.rest_roots[0]);
    const Eigen::Vector3d tip = rod.positions().back();
    EXPECT_NEAR(-tip.y() / tip.x() / exact, 1, limit) << "gamma " << gamma;
  }
}

TEST(NewtonRod, KeepsItsLengths) {
  const StrandModel model = curl(0.2, 24);
  const Pose rest = model.rest_roots[0];
  NewtonRod rod(model, 0, rodParameters(720, kDrag), rest);
  for (int i = 1; i <= 360; ++i) {
    rod.step(shaken((i - 1) / 720.0) * rest, shaken(i / 720.0) * rest);
    for (int e = 0; e < 24; ++e) {
      const double length = (model.rest_local[e + 1] - model.rest_local[e]).cast<double>().norm();
      EXPECT_NEAR((rod.positions()[e + 1] - rod.positions()[e]).norm(), length, 1e-9 * length);
    }
  }
}

TEST(NewtonRod, ConvergesWithTheSecondOrder) {
  const StrandModel model = straight(0.2, 24, -Vec3::UnitY());
  const Path coarse = pathOfNewton(model, 720), middle = pathOfNewton(model, 1440),
             fine = pathOfNewton(model, 2880);
  EXPECT_LT(distance(middle, fine), 0.3 * distance(coarse, middle));
}

// A horizontal straight strand released without drag conserves its energy. A joint of strain 2 tan(theta / 2)
// and moment bend x strain has the energy -4 bend log(cos(theta / 2)).
TEST(NewtonRod, KeepsTheEnergyOfAFall) {
  const StrandModel model = straight(0.15, 16, Vec3::UnitX());
  NewtonRod rod(model, 0, rodParameters(5760, 0), model.rest_roots[0]);
  double deepest = 0, largest_error = 0;
  for (int i = 0; i < 5760 / 2; ++i) {
    rod.step(model.rest_roots[0], model.rest_roots[0]);
    double potential = 0, motion = 0, elastic = 0;
    Eigen::Vector3d before = Eigen::Vector3d::UnitX();
    for (int v = 1; v <= 16; ++v) {
      const Eigen::Vector3d tangent = (rod.positions()[v] - rod.positions()[v - 1]).normalized();
      elastic -= 2 * model.bend[v - 1] * std::log((1 + before.dot(tangent)) / 2);
      potential += 9.81 * model.mass[v] * rod.positions()[v].y();
      motion += 0.5 * model.mass[v] * rod.velocities()[v].squaredNorm();
      before = tangent;
    }
    deepest = std::min(deepest, potential);
    largest_error = std::max(largest_error, std::abs(motion + elastic + potential));
  }
  EXPECT_LT(largest_error, -0.001 * deepest);
}

TEST(NewtonRod, TheSolverRodConvergesToIt) {
  const StrandModel model = curl(0.2, 24);
  const Path exact = pathOfNewton(model, 5760);
  const double coarse = distance(pathOfSolver(model, 1440), exact);
  const double fine = distance(pathOfSolver(model, 5760), exact);
  EXPECT_LT(fine, 0.5 * coarse);
  EXPECT_LT(fine, 0.002);
}

TEST(NewtonRod, RefusesWhatItDoesNotHave) {
  const StrandModel model = straight(0.1, 8, Vec3::UnitX());
  Parameters damped = rodParameters(360, 1);
  damped.damping_time = 0.001f;
  EXPECT_THROW(NewtonRod(model, 0, damped, model.rest_roots[0]), Error);
  StrandModel pinned = model;
  pinned.pinned.resize(pinned.vertices(), 0);
  pinned.pinned[4] = 1;
  EXPECT_THROW(NewtonRod(pinned, 0, rodParameters(360, 1), model.rest_roots[0]), Error);
}

}  // namespace
}  // namespace strandcast
