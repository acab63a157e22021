#include "groom/bound_growth.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "groom/hair_binding.h"
#include "tests/groom/curled_hairs.h"

namespace strandcast {
namespace {

struct Fixture {
  StrandSet guides = curledHairs(29, 1, 0.1f), hairs = curledHairs(120, 2, 0.1f);
  std::vector<HairBinding> bindings = bindHairs(hairs, guides);
  std::vector<Pose> unmoved = std::vector<Pose>(29);

  /// Greatest distance of all hairs from expected(rest vertex), m.
  template <class Expected>
  double worst(const BoundHairReference& reference, Expected expected) const {
    double worst = 0;
    for (size_t s = 0; s < hairs.strands(); ++s) {
      const auto grown = reference.grow(hairs.strand(s), bindings[s]);
      EXPECT_EQ(grown.size(), hairs.verticesOf(s));
      for (size_t j = 0; j < grown.size(); ++j)
        worst = std::max(worst, (grown[j].position - expected(hairs.strand(s)[j].cast<double>())).norm());
    }
    return worst;
  }
};

TEST(BoundGrowth, IsTheArtistsHairWhereGuidesAreAtRest) {
  const Fixture f;
  for (const int segments : {1, 2, 7, 32, 100}) {
    const BoundHairReference reference(f.guides, f.guides.positions, f.unmoved, segments);
    EXPECT_LT(f.worst(reference, [](const Eigen::Vector3d& x) { return x; }), 1e-12) << segments;
  }
}

TEST(BoundGrowth, MovesRigidlyWithGuidesThatDo) {
  const Fixture f;
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(2.4, Eigen::Vector3d(1, 2, -1).normalized()));
  const Eigen::Vector3d moved(0.3, 1.2, -0.4);
  StrandSet now = f.guides;
  for (Vec3& p : now.positions) p = (turn * p.cast<double>() + moved).cast<float>();
  const BoundHairReference reference(
      f.guides, now.positions, std::vector<Pose>(29, Pose{moved.cast<float>(), Quat(turn.cast<float>())}),
      32);
  EXPECT_LT(f.worst(reference, [&](const Eigen::Vector3d& x) -> Eigen::Vector3d { return turn * x + moved; }),
            1e-6);
  for (size_t s = 0; s < f.hairs.strands(); ++s) {
    const auto points = f.hairs.strand(s);
    const Eigen::Vector3d first = (points[1] - points[0]).cast<double>().normalized();
    EXPECT_LT((reference.grow(points, f.bindings[s])[0].tangent - turn * first).norm(), 1e-5);
  }
}

TEST(BoundGrowth, TheErrorOfACodecMovesNothingAtRest) {
  // 0.016 mm at vertices are at most 0.02 mm at nodes between them.
  const Fixture f;
  const Pose head{Vec3(0.3f, 1.2f, -0.4f),
                  Quat(Eigen::AngleAxisf(2.4f, Eigen::Vector3f(1, 2, -1).normalized()))};
  std::mt19937 random(5);
  std::uniform_real_distribution<float> unit(-1, 1);
  for (const Pose& pose : {Pose{}, head}) {
    StrandSet now = f.guides;
    for (Vec3& p : now.positions)
      p = pose.apply(p) + 1.6e-5f * Vec3(unit(random), unit(random), unit(random)).normalized();
    const BoundHairReference reference(f.guides, now.positions, std::vector<Pose>(29, pose), 32);
    EXPECT_LT(
        f.worst(reference,
                [&](const Eigen::Vector3d& x) {
                  return Eigen::Vector3d(pose.rotation.cast<double>() * x + pose.position.cast<double>());
                }),
        1e-6);
  }
}

TEST(BoundGrowth, OfAGuideThatMovesAnywhereIsNotHeldAtRestElsewhere) {
  const Fixture f;
  StrandSet now = f.guides;  // tips by a millimetre, next vertices by 0.01 mm
  for (size_t g = 0; g < now.strands(); ++g) {
    now.strand(g).back().x() += 1e-3f;
    now.strand(g)[now.verticesOf(g) - 2].x() += 1e-5f;
  }
  const auto grownWith = [&](const Pose& root) {
    return BoundHairReference(f.guides, now.positions, std::vector<Pose>(29, root), 32)
        .grow(f.hairs.strand(7), f.bindings[7]);
  };
  const auto held = grownWith({}), free = grownWith({Vec3(1, 0, 0), Quat::Identity()});
  for (size_t j = 0; j < held.size(); ++j) EXPECT_EQ(held[j].position, free[j].position);
}

TEST(BoundGrowth, LeavesRestWithoutAJumpAndIsTheGuidesMotionFromATenthOfAMillimetreOn) {
  const Fixture f;
  double before = 0;
  for (int step = 0; step <= 300; ++step) {
    const double away = 5e-7 * step;
    StrandSet now = f.guides;
    for (Vec3& p : now.positions) p.x() += static_cast<float>(away);
    const BoundHairReference reference(f.guides, now.positions, f.unmoved, 32);
    const Eigen::Vector3d rest = f.hairs.strand(7)[3].cast<double>();
    const double moved = reference.grow(f.hairs.strand(7), f.bindings[7])[3].position.x() - rest.x();
    EXPECT_GE(moved, before - 2e-8) << away;
    EXPECT_LT(moved - before, 1.1e-6) << "at most about twice the guide's step: " << away;
    EXPECT_NEAR(moved, away, away < 1.001e-4 ? 3.5e-5 : 2e-8);
    if (away < 1.99e-5) {
      EXPECT_NEAR(moved, 0, 2e-8) << away;
    }
    before = moved;
  }
}

TEST(BoundGrowth, TheRootStaysOnItsFrameWhereTheFirstEdgesBend) {
  // Guides swing by 60 degrees at their second vertex, and roots stand still.
  const Fixture f;
  StrandSet now = f.guides;
  const Eigen::Quaternionf swing(Eigen::AngleAxisf(1.05f, Eigen::Vector3f::UnitX()));
  for (size_t g = 0; g < now.strands(); ++g)
    for (Vec3& p : now.strand(g)) p = now.strand(g)[0] + swing * (p - now.strand(g)[0]);
  const BoundHairReference reference(f.guides, now.positions, f.unmoved, 32);
  for (size_t s = 0; s < f.hairs.strands(); ++s) {
    const auto points = f.hairs.strand(s);
    const auto grown = reference.grow(points, f.bindings[s]);
    EXPECT_LT((grown[0].position - points[0].cast<double>()).norm(), 1e-9) << "hair " << s;
    EXPECT_GT((grown.back().position - points.back().cast<double>()).norm(), 0.05);
  }
}

TEST(BoundGrowth, OffsetsTurnWithTheGuide) {
  // A guide bends to a quarter circle; a hair beside it, in the plane and out of it, keeps its distance.
  constexpr size_t kVertices = 65;
  constexpr double kLength = 0.2, kRadius = kLength / (EIGEN_PI / 2);
  StrandSet rest;
  std::vector<Vec3> straight, bent, beside, behind;
  for (size_t i = 0; i < kVertices; ++i) {
    const double s = kLength * static_cast<double>(i) / (kVertices - 1), angle = s / kRadius;
    straight.push_back(Vec3(0, -static_cast<float>(s), 0));
    bent.push_back(
        Eigen::Vector3d(kRadius * (1 - std::cos(angle)), -kRadius * std::sin(angle), 0).cast<float>());
    beside.push_back(straight.back() + Vec3(-0.01f, 0, 0));
    behind.push_back(straight.back() + Vec3(0, 0, 0.01f));
  }
  rest.append(straight);
  const BoundHairReference reference(rest, bent, std::vector<Pose>(1), 64);
  const auto out = reference.grow(beside, {}), back = reference.grow(behind, {});
  for (size_t i = 0; i < kVertices; ++i) {
    // Secants lag at the tip by half their reach: 4 of 64 nodes, 5.6 degrees.
    EXPECT_NEAR((out[i].position - bent[i].cast<double>()).norm(), 0.01, 1e-5);
    EXPECT_NEAR((out[i].position - Eigen::Vector3d(kRadius, 0, 0)).norm(), kRadius + 0.01, 3e-4);
    EXPECT_LT((back[i].position - bent[i].cast<double>() - Eigen::Vector3d(0, 0, 0.01)).norm(), 1e-6);
  }
  EXPECT_GT(out.back().tangent.x(), 0.99);
}

TEST(BoundGrowth, GuidesThatAreNotUsableHideOnlyHairThatFollowsThem) {
  StrandSet guides;
  guides.append(std::vector<Vec3>{Vec3(0, 0, 0), Vec3(0, -0.1f, 0), Vec3(0, -0.2f, 0)});
  guides.append(std::vector<Vec3>{Vec3(0.01f, 0, 0), Vec3(0.01f, -0.1f, 0)});
  guides.append(std::vector<Vec3>{Vec3(0.02f, 0, 0)});
  guides.append(std::vector<Vec3>{Vec3(0.03f, 0, 0), Vec3(0.03f, 0, 0)});  // without a length
  const std::vector<Vec3> hair{Vec3(0.005f, 0, 0), Vec3(0.005f, -0.3f, 0)};
  StrandSet now = guides;
  now.positions[1].y() = std::numeric_limits<float>::quiet_NaN();
  const BoundHairReference reference(guides, now.positions, std::vector<Pose>(4), 16);
  EXPECT_TRUE(reference.grow(hair, {{1, 0, 1}, {10, 0}}).empty());
  EXPECT_TRUE(reference.grow(hair, {{2, 2, 2}, {0, 0}}).empty());
  for (const HairBinding& binding : {HairBinding{{1, 0, 0}, {0, 0}}, HairBinding{{3, 1, 3}, {100, 0}}}) {
    const auto grown = reference.grow(hair, binding);
    ASSERT_EQ(grown.size(), 2u);
    EXPECT_LT((grown[1].position - hair[1].cast<double>()).norm(), 1e-12);
  }
  EXPECT_LT((reference.grow(std::vector<Vec3>{Vec3(1, 0, 0)}, {{1, 1, 1}, {}})[0].position -
             Eigen::Vector3d(1, 0, 0))
                .norm(),
            1e-12);
}

}  // namespace
}  // namespace strandcast
