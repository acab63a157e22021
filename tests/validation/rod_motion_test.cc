// Error of the solver `rod` in motion; docs/solver.md has the table.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "core/backend.h"
#include "tests/validation/shaken_rod.h"
#include "validation/newton_rod.h"
#include "validation/specimen.h"

namespace strandcast {
namespace {

constexpr int kEdges = 32;
constexpr int kFrames = 540;      // 1.5 s, 360 a second
constexpr int kExactRate = 5760;  // step rate of the reference, 1/s

StrandModel strandOf(double length, double helix_radius) {
  return modelOf({hungCurl(length, kEdges, helix_radius)});
}

// Rms distance of the tips over 1.5 s, starting from rest, m.
double tipError(const StrandModel& model, double ramp) {
  const Pose root = model.rest_roots[0];
  const Parameters settle = rodParameters(360, 10), parameters = rodParameters(360, 2);
  NewtonRod exact(model, 0, settle, root);
  const auto backend = makeOracleBackend();
  backend->load(model, restState(model, model.rest_roots));
  for (int i = 0; i < 8 * 360; ++i) {
    exact.step(root, root);
    backend->step({&settle});
  }
  exact.setParameters(rodParameters(kExactRate, 2));
  const Shake shake{.ramp = ramp};
  constexpr int kFine = kExactRate / 360;
  std::vector<Pose> begin(1);
  double sum = 0;
  for (int frame = 1; frame <= kFrames; ++frame) {
    for (int i = (frame - 1) * kFine; i < frame * kFine; ++i)
      exact.step(shakenRoot(static_cast<double>(i) / kExactRate, shake) * root,
                 shakenRoot((i + 1.0) / kExactRate, shake) * root);
    const std::vector<Pose> end{shakenRoot(frame / 360.0, shake)};
    backend->step({&parameters, begin, end});
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
