// How far the solver `rod` is from the truth in motion: docs/solver.md has the table.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "core/backend.h"
#include "validation/newton_rod.h"

namespace strandcast {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;
constexpr int kEdges = 32;
constexpr int kFrames = 540;      // 1.5 s, 360 a second
constexpr int kExactRate = 5760;  // of the truth, 1/s

StrandModel strandOf(double length, double helix_radius) {
  const double rise = 0.01 / kTurn;  // m per radian: a pitch of 1 cm
  std::vector<Vec3> points;
  for (int i = 0; i <= kEdges; ++i) {
    const double s = length * i / kEdges;
    const double a = s / std::hypot(helix_radius, rise);
    const Eigen::Vector3d curled(helix_radius * (std::cos(a) - 1), -rise * a, helix_radius * std::sin(a));
    points.push_back((helix_radius > 0 ? curled : Eigen::Vector3d(0, -s, 0)).cast<float>());
  }
  StrandSet set;
  set.append(points);
  return makeStrandModel(set);
}

// +-0.1 m and +-45 degrees at 1 Hz; `ramp`: s, over which it grows smoothly.
Pose shaken(double time, double ramp) {
  const double u = ramp > 0 ? std::clamp(time / ramp, 0.0, 1.0) : 1;
  const double swing = u * u * u * (10 - 15 * u + 6 * u * u) * std::sin(kTurn * time);
  return {
      Vec3(static_cast<float>(0.1 * swing), 0, 0),
      Quat(Eigen::AngleAxisf(static_cast<float>(std::numbers::pi / 4 * swing), Eigen::Vector3f::UnitZ()))};
}

Parameters rodParameters(int rate, float drag) {
  Parameters parameters;
  parameters.solver = SolverKind::kRod;
  parameters.time_step = 1.0f / static_cast<float>(rate);
  parameters.substeps = 1;
  parameters.air_drag = drag;
  return parameters;
}

// RMS distance of the tips over 1.5 s from rest, m.
double tipError(const StrandModel& model, double ramp) {
  const Pose root = model.rest_roots[0];
  const Parameters settle = rodParameters(360, 10), parameters = rodParameters(360, 2);
  NewtonRod exact(model, 0, settle, root);
  const auto backend = makeOracleBackend();
  backend->load(model, restState(model, model.rest_roots));
  for (int i = 0; i < 8 * 360; ++i) {
    exact.step(root, root);
    backend->step({&settle, model.rest_roots, model.rest_roots, {}});
  }
  exact.setParameters(rodParameters(kExactRate, 2));
  constexpr int kFine = kExactRate / 360;
  std::vector<Pose> begin = model.rest_roots;
  double sum = 0;
  for (int frame = 1; frame <= kFrames; ++frame) {
    for (int i = (frame - 1) * kFine; i < frame * kFine; ++i)
      exact.step(shaken(static_cast<double>(i) / kExactRate, ramp) * root,
                 shaken((i + 1.0) / kExactRate, ramp) * root);
    const std::vector<Pose> end{shaken(frame / 360.0, ramp) * root};
    backend->step({&parameters, begin, end, {}});
    begin = end;
    sum += (backend->guides().back().cast<double>() - exact.positions().back()).squaredNorm();
  }
  return std::sqrt(sum / kFrames);
}

void expectBelow(double limit, const StrandModel& model, const char* name) {
  for (const double ramp : {0.0, 0.5}) {
    const double error = tipError(model, ramp);
    std::printf("%s, %s: %.1f mm\n", name, ramp > 0 ? "ramped" : "sine", 1e3 * error);
    EXPECT_LT(error, limit) << name << " ramp " << ramp;
  }
}

TEST(RodMotion, StraightHairIsWithin5Millimetres) { expectBelow(0.005, strandOf(0.25, 0), "straight 25 cm"); }

TEST(RodMotion, CurlsAreWithin12Millimetres) {
  expectBelow(0.012, strandOf(0.25, 0.01), "helix 25 cm");
  expectBelow(0.012, strandOf(0.20, 0.01), "helix 20 cm");
}

}  // namespace
}  // namespace strandcast
