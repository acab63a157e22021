#include "core/origin.h"

#include <gtest/gtest.h>

namespace strandcast {
namespace {

Pose headAt(float x, float y, float z) { return {Vec3(x, y, z), Quat::Identity()}; }

TEST(Origin, IsThatOfTheWorldForAHeadNearIt) {
  EXPECT_TRUE(Origin().isWorld());
  for (const Pose& head :
       {headAt(0, 0, 0), headAt(kNearOrigin, -kNearOrigin, kNearOrigin), headAt(0, -3.9f, 1)})
    EXPECT_TRUE(Origin::forHead(head).isWorld()) << head.position.transpose();
}

TEST(Origin, IsWholeMetresNearAHeadThatIsFar) {
  EXPECT_EQ(Origin::forHead(headAt(0, 4.1f, 0)).position, Vec3(0, 4, 0));
  EXPECT_EQ(Origin::forHead(headAt(-1000.4f, 1.6f, 999.7f)).position, Vec3(-1000, 2, 1000));
  for (const Pose& head : {headAt(4.1f, 0, 0), headAt(-1000.4f, 1.6f, 999.7f), headAt(0, 0, -1e4f)}) {
    const Origin origin = Origin::forHead(head);
    EXPECT_FALSE(origin.isWorld());
    EXPECT_FALSE(origin.isFar(head));
    EXPECT_LE(origin.toLocal(head).position.cwiseAbs().maxCoeff(), 0.5f);
  }
}

TEST(Origin, IsKeptUntilTheHeadIsFarOnOneAxis) {
  const Origin world;
  EXPECT_FALSE(world.isFar(headAt(kFarFromOrigin, kFarFromOrigin, -kFarFromOrigin)));
  EXPECT_TRUE(world.isFar(headAt(0, 0, -8.01f)));
  const Origin far{Vec3(100, 0, 0)};
  EXPECT_FALSE(far.isFar(headAt(92, 0, 0)));
  EXPECT_TRUE(far.isFar(headAt(91.9f, 0, 0)));
  // A head between kNearOrigin and kFarFromOrigin keeps either origin: walking to and fro there does not
  // rebase.
  EXPECT_FALSE(world.isFar(headAt(6, 0, 0)));
  EXPECT_FALSE(Origin{Vec3(9, 0, 0)}.isFar(headAt(6, 0, 0)));
}

TEST(Origin, ConvertsWithoutRounding) {
  const Origin origin{Vec3(1000, -3, 2)};
  const Pose world{Vec3(1000.25f, -2.5f, 1.75f), Quat(Eigen::AngleAxisf(0.3f, Eigen::Vector3f::UnitX()))};
  const Pose local = origin.toLocal(world);
  EXPECT_EQ(local.position, Vec3(0.25f, 0.5f, -0.25f));
  EXPECT_EQ(local.position, origin.toLocal(world.position));
  EXPECT_EQ(local.rotation.coeffs(), world.rotation.coeffs());
  EXPECT_EQ(origin.toWorld(local).position, world.position);
  EXPECT_EQ(origin.toWorld(local.position), world.position);
  EXPECT_EQ(origin.toWorld(local).rotation.coeffs(), world.rotation.coeffs());
  const Origin other{Vec3(990, 0, 0)};
  EXPECT_EQ(Vec3(local.position + other.toLocal(origin.position)), other.toLocal(world.position))
      << "rebasing translates local positions by the old origin in the new one";
}

}  // namespace
}  // namespace strandcast
