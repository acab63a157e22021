#include "scenes/head_motion.h"

#include <gtest/gtest.h>

#include <numbers>

#include "core/error.h"
#include "tests/io/sample_clip.h"
#include "tests/real_data.h"

namespace strandcast {
namespace {

const Vec3 kPivot(0, -0.115f, -0.025f);

double degrees(const Pose& pose) {
  return Eigen::AngleAxisf(Eigen::Quaternionf(pose.rotation)).angle() * 180 / std::numbers::pi;
}
double degreesBetween(const Pose& a, const Pose& b) {
  return a.rotation.angularDistance(b.rotation) * 180 / std::numbers::pi;
}

TEST(HeadMotion, AClipIsKnownByItsExtensionInAnyCase) {
  for (const char* name : {"walk.bvh", "Walk.BVH", "walk.Bvh"}) {
    const ScratchFile clip(name, kSampleClip);
    EXPECT_NO_THROW(headMotion(clip.path.string(), kPivot)) << name;
  }
}

TEST(HeadMotion, StillStaysStill) {
  const HeadMotion motion = headMotion("still", kPivot);
  EXPECT_EQ(motion(3.7).position, Vec3(0, 0, 0));
  EXPECT_NEAR(degrees(motion(3.7)), 0, 1e-6);
}

TEST(HeadMotion, SwingsReachTheirAnglesAboutThePivot) {
  const struct {
    const char* name;
    double degrees;
    Vec3 axis;
  } kCases[] = {{"nod", 15, Vec3::UnitX()}, {"shake", 35, Vec3::UnitY()}, {"turn", 45, Vec3::UnitY()}};
  for (const auto& given : kCases) {
    const HeadMotion motion = headMotion(given.name, kPivot);
    double widest = 0;
    for (double t = 1; t < 12; t += 0.005) {
      const Pose pose = motion(t);
      widest = std::max(widest, degrees(pose));
      ASSERT_NEAR((pose.apply(kPivot) - kPivot).norm(), 0, 1e-6);
      ASSERT_NEAR((pose.rotate(given.axis) - given.axis).norm(), 0, 1e-5);
    }
    EXPECT_NEAR(widest, given.degrees, 0.01) << given.name;
  }
}

TEST(HeadMotion, MotionsCombine) {
  const Pose both = headMotion("nod+turn", kPivot)(1.3);
  const Pose expected = headMotion("nod", kPivot)(1.3) * headMotion("turn", kPivot)(1.3);
  EXPECT_LT(degreesBetween(both, expected), 0.05);
  EXPECT_NEAR((both.apply(kPivot) - kPivot).norm(), 0, 1e-6);
}

TEST(HeadMotion, StartsFromRestWithSmallAccelerations) {
  const ScratchFile clip("start.bvh", kSampleClip);
  for (const std::string& name :
       {std::string("nod"), std::string("shake"), std::string("turn"), clip.path.string()}) {
    const HeadMotion motion = headMotion(name, kPivot);
    EXPECT_NEAR(degrees(motion(0)), 0, 1e-4) << name;
    EXPECT_NEAR(motion(0).position.norm(), 0, 1e-6);
    EXPECT_LT(degreesBetween(motion(0), motion(0.01)) / 0.01, 2.0) << name;  // degrees/s after 10 ms
  }
}

TEST(HeadMotion, HasNoJumpsInSpeed) {
  const ScratchFile clip("jump.bvh", kSampleClip);
  for (const std::string& name : {std::string("shake+nod"), clip.path.string()}) {
    const HeadMotion motion = headMotion(name, kPivot);
    constexpr double h = 1e-3;
    for (double t = 0; t < 3; t += h) {
      const Vec3 p(0, 0.1f, 0.1f);
      const Vec3 bend = motion(t).apply(p) - 2 * motion(t + h).apply(p) + motion(t + 2 * h).apply(p);
      ASSERT_LT(bend.norm() / (h * h), 400) << name << " at " << t;  // a jump of 1 m/s would be 1000 m/s^2
    }
  }
}

TEST(HeadMotion, AClipLoopsInPlace) {
  const ScratchFile file("loop.bvh", kSampleClip);
  const HeadMotion motion = bvhMotion(file.path, kPivot, {0.1f, ""});
  constexpr double kPeriod = 0.4;
  for (double t = 0.6; t < 1; t += 0.013) {
    EXPECT_LT(degreesBetween(motion(t), motion(t + kPeriod)), 0.2) << t;
    EXPECT_NEAR((motion(t).position - motion(t + kPeriod).position).norm(), 0, 1e-4);
    EXPECT_LT(motion(t).apply(kPivot).z() - kPivot.z(), 0.05f);  // the walk of 0.4 m is removed
  }
}

TEST(HeadMotion, AClipIsScaledByItsUnit) {
  const ScratchFile file("unit.bvh", kSampleClip);
  // Frame 2 of the sample is 0.5 units to the side. After the smooth start, clip time lags by 0.25 s.
  const Pose small = bvhMotion(file.path, kPivot, {0.01f, ""})(0.45 + 0.4),
             large = bvhMotion(file.path, kPivot, {0.1f, ""})(0.45 + 0.4);
  const float side = small.apply(kPivot).x();
  EXPECT_NEAR(side, 0.005f, 1e-4);
  EXPECT_NEAR(large.apply(kPivot).x(), 10 * side, 1e-4);
}

TEST(HeadMotion, TheUnitOfAClipIsReportedAndFoundByTheBodyWhereItMatches) {
  const ScratchFile file("told.bvh", kSampleClip);
  std::vector<std::string> notes, warnings;
  const auto sideWith = [&](const ClipMotionOptions& options) {
    notes.clear();
    warnings.clear();
    return bvhMotion(file.path, kPivot, options, &notes, &warnings)(0.45 + 0.4).apply(kPivot).x();
  };
  const float metres = sideWith({1, ""});
  EXPECT_TRUE(warnings.empty());
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_EQ(notes[0], file.path.string() +
                          ": 'MyHead' travels 4 m from the first frame to the last, which is "
                          "taken out to play it in place");
  EXPECT_NEAR(sideWith({}), metres, 1e-6f);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find("its unit is guessed: 1 m, which makes its skeleton 2.5 m large (2.5 units)"),
            std::string::npos)
      << warnings[0];
  EXPECT_NE(warnings[0].find("--clip-unit-meters"), std::string::npos);
  Skeleton body;
  body.joints = {
      {"Hips", -1, {Vec3(0, 1, 0)}}, {"spine", 0, {Vec3(0, 0.3f, 0)}}, {"MyHead", 1, {Vec3(0, 0.2f, 0)}}};
  EXPECT_NEAR(sideWith({0, "", &body}), 0.25f * metres, 1e-4f) << "half a metre from hips to head is 2 units";
  EXPECT_TRUE(warnings.empty());
  ASSERT_EQ(notes.size(), 2u);
  EXPECT_NE(notes[1].find("'MyHead' travels 1 m"), std::string::npos) << notes[1];
  EXPECT_NE(notes[0].find("its unit is guessed: 0.25 m, the ratio of 1 bone"), std::string::npos) << notes[0];
  sideWith({1, "", &body});
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find("4 times as long as the body's"), std::string::npos) << warnings[0];
}

TEST(HeadMotion, TravelIsReportedWhereThereIsSome) {
  std::vector<std::string> notes;
  std::string back = kSampleClip, turned = kSampleClip;
  back.replace(back.rfind("0 1 4"), 5, "0 1 0");
  const ScratchFile loop("back.bvh", back);
  bvhMotion(loop.path, kPivot, {1, ""}, &notes);
  EXPECT_TRUE(notes.empty());
  turned.replace(turned.rfind("0 1 4 0 0 0"), 11, "0 1 0 90 0 0");
  const ScratchFile fallen("turned.bvh", turned);
  bvhMotion(fallen.path, kPivot, {0.5f, ""}, &notes);
  ASSERT_EQ(notes.size(), 1u) << "the root turns, and its head goes two units to the side and two down";
  EXPECT_NE(notes[0].find("'MyHead' travels 1.41 m"), std::string::npos) << notes[0];
  notes.clear();
  const ScratchFile walk("walk.bvh", kSampleClip);
  bvhMotion(walk.path, kPivot, {0.1f, "Hips"}, &notes);
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_NE(notes[0].find("'Hips' travels 0.4 m"), std::string::npos) << notes[0];
}

TEST(HeadMotion, AnEndingReturnsSmoothlyAndStays) {
  const HeadMotion whole = headMotion("nod+shake", kPivot), ended = endingAt(whole, 3, kPivot);
  for (const double t : {0.0, 0.8, 2.4}) EXPECT_NEAR(degreesBetween(ended(t), whole(t)), 0, 1e-3) << t;
  for (const double t : {3.0, 3.5, 100.0}) {
    EXPECT_EQ(ended(t).position, Vec3(0, 0, 0)) << t;
    EXPECT_NEAR(degrees(ended(t)), 0, 1e-6) << t;
  }
  constexpr double kStep = 1e-3;  // s; 35 degrees at 1 Hz are at most 220 degrees/s
  for (double t = 0; t < 3.2; t += kStep) {
    EXPECT_LT(degreesBetween(ended(t), ended(t + kStep)), 0.35) << t;
    EXPECT_LT((ended(t).apply(kPivot) - kPivot).norm(), 1e-6f) << t;
  }
  EXPECT_LT(degreesBetween(ended(3 - 10 * kStep), ended(3)), 0.05) << "it slows down to its end";
}

TEST(HeadMotion, UnknownNamesListTheChoices) {
  for (const char* name : {"", "wink", "nod+", "nod+wink", "+"}) {
    try {
      headMotion(name, kPivot);
      FAIL() << name;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find("still, nod, shake, turn"), std::string::npos) << error.what();
    }
  }
}

TEST(HeadMotion, AnUnknownJointIsAnError) {
  const ScratchFile file("joint.bvh", kSampleClip);
  EXPECT_THROW(bvhMotion(file.path, kPivot, {0.1f, "Tail"}), Error);
  EXPECT_THROW(bvhMotion(file.path, kPivot, {-1, ""}), Error);
}

TEST(HeadMotion, RealClipsStayNearTheRestPose) {
  for (const char* name : {"mh_walk1.bvh", "mh_zombieWalk1.bvh"}) {
    const auto file = dataFolder() / "motion" / name;
    if (!std::filesystem::exists(file)) GTEST_SKIP() << "no " << file << " (set STRANDCAST_DATA)";
    const HeadMotion motion = headMotion(file.string(), kPivot);
    float farthest = 0;
    for (double t = 0; t < 5; t += 0.01) {
      const Pose pose = motion(t);
      ASSERT_TRUE(pose.position.allFinite() && pose.rotation.coeffs().allFinite());
      farthest = std::max(farthest, (pose.apply(kPivot) - kPivot).norm());
    }
    EXPECT_LT(farthest, 0.5f);
    EXPECT_GT(farthest, 0.005f);
  }
}

}  // namespace
}  // namespace strandcast
