#include "air/hair_grid.h"

#include <gtest/gtest.h>

#include <cmath>

#include "validation/specimen.h"

namespace strandcast {
namespace {

// A tuft of hair with strands of several vertex counts, some with edges longer than cells.
StrandModel tuft() {
  std::vector<StrandPoints> strands;
  for (int s = 0; s < 160; ++s) {
    StrandPoints points = straightStrand(0.2, s % 5 == 0 ? 3 : 12 + s % 7, -Vec3::UnitY());
    const Vec3 root(0.004f * static_cast<float>(s % 13), 0.001f * static_cast<float>(s % 3),
                    0.004f * static_cast<float>(s / 13));
    for (Vec3& p : points) p += root;
    strands.push_back(points);
  }
  return modelOf(strands);
}

struct Hair {
  StrandModel model = tuft();
  StrandState state = restState(model, model.rest_roots);

  Hair() {
    for (size_t v = 0; v < model.vertices(); ++v) {
      const auto n = static_cast<float>(v);
      state.velocities[v] = Vec3(std::sin(1.3f * n), std::cos(2.9f * n), 1 + std::sin(n));
    }
  }
  Parameters parameters() const {
    Parameters parameters;
    parameters.volume_stiffness = 1;
    parameters.hair_friction = 20;
    return parameters;
  }
};

TEST(StrandSamples, HoldAllOfTheHair) {
  const StrandModel model = tuft();
  for (const float cell : {0.002f, 0.01f, 0.03f, 1.0f}) {
    const StrandSamples samples = strandSamples(model, cell);
    double mass = 0, truth = 0;
    for (const StrandSample& sample : samples.samples) mass += double{sample.mass};
    for (size_t s = 0; s < model.strands(); ++s)
      for (uint32_t v = model.offsets[s]; v < model.offsets[s + 1]; ++v)
        truth += double{model.mass[v]} * double{model.reference_mass[s]};
    EXPECT_NEAR(mass / truth, 1, 1e-5) << cell;
    std::vector<double> parts(model.vertices());
    for (const StrandSample& sample : samples.samples) {
      double shares = 0;
      for (uint32_t i = 0; i < sample.count; ++i) {
        shares += double{samples.shares[sample.share + i]};
        parts[sample.vertex + i] += double{samples.vertex_parts[sample.share + i]};
      }
      EXPECT_NEAR(shares, 1, 1e-5);
    }
    for (const double part : parts) EXPECT_NEAR(part, 1, 1e-5);
  }
}

TEST(StrandSamples, WeighWhatTheTaperLeaves) {
  StrandSet strands;
  std::vector<Vec3> points;
  for (int i = 0; i < 33; ++i) points.emplace_back(0, -0.01f * static_cast<float>(i), 0);
  strands.append(points);
  Material material;
  material.radius_scale.knots = {{0.0f, 1.0f}, {1.0f, 0.1f}};
  const StrandModel model = makeStrandModel(strands, {material});
  for (const float cell : {0.002f, 0.01f, 0.05f}) {
    const StrandSamples samples = strandSamples(model, cell);
    std::vector<double> masses(model.vertices());
    for (const StrandSample& sample : samples.samples)
      for (uint32_t i = 0; i < sample.count; ++i)
        masses[sample.vertex + i] += double{sample.mass} * double{samples.shares[sample.share + i]};
    for (size_t v = 0; v < masses.size(); ++v)
      EXPECT_NEAR(masses[v] / (double{model.mass[v]} * double{model.reference_mass[0]}), 1, 1e-5) << v;
    for (size_t e = 0; e < 32; ++e) {
      const double radius = 40e-6 * (1 - 0.9 * (static_cast<double>(e) + 0.5) / 32);
      const double mass = 1300 * 3.14159265 * radius * radius * 0.01;
      EXPECT_NEAR(double{samples.edge_masses[e][0] + samples.edge_masses[e][1]} / mass, 1, 0.03) << e;
    }
  }
}

TEST(HairGrid, AnyNumberOfThreadsGivesTheSameBits) {
  const Hair hair;
  uint64_t one = 0;
  std::vector<float> first;
  for (const int threads : {1, 2, 3, 5, 8, 16}) {
    const Workers workers(threads);
    HairGrid<float> grid(simdPasses(), workers, hair.model, 32, restBox(hair.model));
    grid.locate(hair.state.positions, hair.state.velocities, Pose{});
    grid.splat();
    grid.computeForces(hair.parameters(), 1.0 / 60);
    std::vector<float> changes(4 * grid.samples().samples.size());
    grid.changes(0, grid.samples().samples.size(), changes.data());
    if (threads == 1) {
      one = grid.splatHash();
      first = changes;
    }
    EXPECT_EQ(grid.splatHash(), one) << threads;
    EXPECT_EQ(changes, first) << threads;
  }
}

TEST(HairGrid, LanesAndDoublesAgree) {
  const Hair hair;
  const Workers workers(1);
  auto run = [&](auto&& grid) {
    using Scalar = std::remove_reference_t<decltype(*grid.nodes())>;
    grid.locate(hair.state.positions, hair.state.velocities, Pose{});
    grid.splat();
    grid.computeForces(hair.parameters(), 1.0 / 60);
    std::vector<std::remove_const_t<Scalar>> changes(4 * grid.samples().samples.size());
    grid.changes(0, grid.samples().samples.size(), changes.data());
    return std::vector<double>(changes.begin(), changes.end());
  };
  const Box box = restBox(hair.model);
  const std::vector<double> exact =
      run(HairGrid<double>(scalarPasses<double>(), workers, hair.model, 32, box));
  const std::vector<double> scalar =
      run(HairGrid<float>(scalarPasses<float>(), workers, hair.model, 32, box));
  const std::vector<double> lanes = run(HairGrid<float>(simdPasses(), workers, hair.model, 32, box));
  double largest = 0;
  for (size_t i = 0; i < exact.size(); ++i) {
    EXPECT_NEAR(scalar[i], exact[i], 1e-4);
    EXPECT_NEAR(lanes[i], exact[i], 1e-4);
    largest = std::max(largest, std::fabs(exact[i]));
  }
  EXPECT_GT(largest, 0.1);
}

TEST(HairGrid, HairAtRestFeelsNothingWhereverTheHeadIs) {
  const Hair hair;
  const Workers workers(1);
  HairGrid<float> grid(simdPasses(), workers, hair.model, 32, restBox(hair.model));
  Parameters parameters = hair.parameters();
  parameters.hair_friction = 0;
  const std::vector<Vec3> still(hair.model.vertices(), Vec3::Zero());
  const Pose head{Vec3(0.4f, -0.2f, 1), Quat(Eigen::AngleAxisf(0.7f, Eigen::Vector3f(1, 2, 2).normalized()))};
  for (const bool moved : {false, true}) {
    std::vector<Vec3> positions = hair.state.positions;
    if (moved)
      for (Vec3& p : positions) p = head.apply(p);
    grid.locate(positions, still, moved ? head : Pose{});
    grid.splat();
    grid.computeForces(parameters, 1.0 / 60);
    std::vector<float> changes(4 * grid.samples().samples.size());
    grid.changes(0, grid.samples().samples.size(), changes.data());
    for (const float change : changes) EXPECT_LE(std::fabs(change), moved ? 1e-4f : 0.0f);
  }
}

// Blurs and sums visit only nodes with hair, now or in the last step.
TEST(HairGrid, WhereHairWasBeforeLeavesNoTrace) {
  const Hair hair;
  const Workers workers(1);
  Parameters both = hair.parameters(), rubbing = both, pushing = both;
  both.volume_hold = rubbing.volume_hold = pushing.volume_hold = 0;
  rubbing.volume_stiffness = 0;
  pushing.hair_friction = 0;
  const Box box = restBox(hair.model);
  auto squeezed = [&](float part, float shift) {
    std::vector<Vec3> positions = hair.state.positions;
    for (Vec3& p : positions) p = Vec3(part * p.x() + shift, p.y() - shift, p.z() + shift);
    return positions;
  };
  auto changes = [&](HairGrid<float>& grid, const Parameters& parameters, float part, float shift) {
    grid.locate(squeezed(part, shift), hair.state.velocities, Pose{});
    grid.splat();
    grid.computeForces(parameters, 1.0 / 60);
    std::vector<float> out(4 * grid.samples().samples.size());
    grid.changes(0, grid.samples().samples.size(), out.data());
    return out;
  };
  HairGrid<float> used(simdPasses(), workers, hair.model, 32, box);
  changes(used, both, 0.5f, -0.03f);
  changes(used, rubbing, 0.7f, 0.02f);
  changes(used, pushing, 0.6f, 10);  // outside the grid
  for (const Parameters& parameters : {both, pushing, rubbing, both}) {
    HairGrid<float> fresh(simdPasses(), workers, hair.model, 32, box);
    const std::vector<float> expected = changes(fresh, parameters, 0.4f, 0.01f);
    EXPECT_GT(*std::max_element(expected.begin(), expected.end()), 0);
    EXPECT_EQ(changes(used, parameters, 0.4f, 0.01f), expected);
    changes(used, parameters, 0.8f, -0.02f);
  }
}

TEST(HairGrid, SqueezedHairIsPushedApartAndNoMomentumIsMade) {
  const Hair hair;
  const Workers workers(2);
  HairGrid<float> grid(simdPasses(), workers, hair.model, 32, restBox(hair.model));
  std::vector<Vec3> squeezed = hair.state.positions;
  const float middle = 0.024f;
  for (Vec3& p : squeezed) p.x() = middle + 0.5f * (p.x() - middle);
  for (const bool friction : {false, true}) {
    Parameters parameters = hair.parameters();
    (friction ? parameters.volume_stiffness : parameters.hair_friction) = 0;
    grid.locate(squeezed, hair.state.velocities, Pose{});
    grid.splat();
    grid.computeForces(parameters, 1.0 / 60);
    std::vector<float> changes(4 * grid.samples().samples.size());
    grid.changes(0, grid.samples().samples.size(), changes.data());
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double all = 0, outwards = 0;
    for (size_t n = 0; n < grid.samples().samples.size(); ++n) {
      const Eigen::Vector3d impulse =
          double{grid.samples().samples[n].mass} *
          Eigen::Vector3f(changes[4 * n], changes[4 * n + 1], changes[4 * n + 2]).cast<double>();
      sum += impulse;
      all += impulse.norm();
      outwards += impulse.x() * (double{grid.places(kWorldPlace)[n]} - double{middle});
    }
    EXPECT_GT(all, 0);
    EXPECT_LT(sum.norm(), 1e-4 * all);
    if (!friction) {
      EXPECT_GT(outwards, 0);
    }
  }
}

TEST(HairGrid, WhatStaysCrowdedIsPushedHarderUntilReset) {
  const Hair hair;
  const Workers workers(1);
  HairGrid<float> grid(simdPasses(), workers, hair.model, 32, restBox(hair.model));
  std::vector<Vec3> squeezed = hair.state.positions;
  for (Vec3& p : squeezed) p.x() *= 0.5f;
  Parameters parameters = hair.parameters();
  parameters.hair_friction = 0;
  auto push = [&] {
    grid.locate(squeezed, hair.state.velocities, Pose{});
    grid.splat();
    grid.computeForces(parameters, 1.0 / 60);
    std::vector<float> changes(4 * grid.samples().samples.size());
    grid.changes(0, grid.samples().samples.size(), changes.data());
    double sum = 0;
    for (const float change : changes) sum += std::fabs(double{change});
    return sum;
  };
  parameters.volume_hold = 0;
  const double alone = push();
  EXPECT_EQ(push(), alone);
  parameters.volume_hold = 1;
  const double first = push(), second = push();
  EXPECT_GT(first, alone);
  EXPECT_GT(second, first);
  grid.reset();
  EXPECT_EQ(push(), first);
}

TEST(HairGrid, StrandsThatWentWrongAreLeftOut) {
  const Hair hair;
  const Workers workers(1);
  HairGrid<float> grid(simdPasses(), workers, hair.model, 32, restBox(hair.model));
  std::vector<Vec3> positions = hair.state.positions;
  positions[3] = Vec3::Constant(std::nanf(""));
  positions[40] = Vec3(1e6f, 0, 0);
  std::vector<Vec3> velocities = hair.state.velocities;
  velocities[80] = Vec3::Constant(HUGE_VALF);
  velocities[120] = Vec3::Constant(std::nanf(""));
  grid.locate(positions, velocities, Pose{});
  grid.splat();
  grid.computeForces(hair.parameters(), 1.0 / 60);
  std::vector<float> changes(4 * grid.samples().samples.size());
  grid.changes(0, grid.samples().samples.size(), changes.data());
  size_t wrong = 0;
  for (const float change : changes) wrong += std::isfinite(change) ? 0 : 1;
  EXPECT_LE(wrong, 3u * 4 * 2) << "those alone whose own velocity is not finite";
  EXPECT_GT(grid.densityAt(16, 16, 16), 0);
}

TEST(HeadExtrapolation, GoesOnAsItWentAndForgetsWhatItWasNotToldOf) {
  auto at = [](float x, float angle) {
    return Pose{Vec3(x, 0, 0), Quat(Eigen::AngleAxisf(angle, Eigen::Vector3f::UnitY()))};
  };
  HeadExtrapolation head;
  EXPECT_EQ(head.ahead(at(0, 0), at(1, 0.2f)).position.x(), 0) << "it may have stood still";
  const Pose ahead = head.ahead(at(1, 0.2f), at(3, 0.2f));
  EXPECT_FLOAT_EQ(ahead.position.x(), 1.5f);
  EXPECT_NEAR(ahead.rotation.angularDistance(at(0, 0.3f).rotation), 0, 1e-6);
  EXPECT_EQ(head.ahead(at(7, 0.2f), at(8, 0.2f)).position.x(), 7) << "steps were left out";
  head.moveOrigin();
  EXPECT_EQ(head.ahead(at(0, 0.2f), at(1, 0.2f)).position.x(), 0.5f);
  head.forget();
  EXPECT_EQ(head.ahead(at(8, 0.2f), at(8, 0.2f)).position.x(), 8);
}

}  // namespace
}  // namespace strandcast
