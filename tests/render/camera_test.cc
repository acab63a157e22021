#include "render/camera.h"

#include <gtest/gtest.h>

namespace strandcast {
namespace {

TEST(Camera, OrbitLooksAtTheFaceAndFillsThePicture) {
  Box box(Eigen::Vector3f(-1, -2, -3), Eigen::Vector3f(1, 2, 5));
  const Camera camera = orbit(box, 0, 0, 1);
  EXPECT_NEAR((camera.target - Vec3(0, 0, 1)).norm(), 0, 1e-6);
  EXPECT_NEAR(camera.eye.x(), 0, 1e-5);
  EXPECT_GT(camera.eye.z(), 5);
  const float sine = 0.5f * box.diagonal().norm() / (camera.eye - camera.target).norm();
  EXPECT_NEAR(2 * std::asin(sine), camera.vertical_fov, 1e-4);
  EXPECT_GT(orbit(box, 1.5707963f, 0, 1).eye.x(), 5);
  EXPECT_TRUE(orbit(Box(), 1, 1, 0).eye.allFinite());
}

TEST(Camera, AtZoomOneTheSphereIsAsHighAsThePicture) {
  const Box box(Vec3(-0.1f, 0, 0.2f), Vec3(0.1f, 0.4f, 0.3f));
  EXPECT_NEAR(heightsInPicture(orbit(box, 0.3f, 0.2f, 1), box), 1, 1e-4f);
  EXPECT_LT(heightsInPicture(orbit(box, 0, 0, 0.1f), box), 0.11f);
  Camera inside;
  inside.eye = Vec3(box.center());
  EXPECT_GT(heightsInPicture(inside, box), 1e30f);
}

TEST(Camera, MatricesPutTheTargetInTheMiddleAndTheNearPlaneAtMinusOne) {
  const Vec3 eye(1, 2, 3), target(0, 0.5f, 0);
  const Eigen::Matrix4f clip = perspective(0.6f, 1.5f, 0.1f, 10) * viewMatrix(eye, target);
  const Vec3 forward = (target - eye).normalized();
  const auto project = [&](const Vec3& p) -> Eigen::Vector3f {
    return (clip * Eigen::Vector4f(p.x(), p.y(), p.z(), 1)).hnormalized();
  };
  EXPECT_NEAR(project(target).head<2>().norm(), 0, 1e-5);
  EXPECT_NEAR(project(Vec3(eye + 0.1f * forward)).z(), -1, 1e-4);
  EXPECT_NEAR(project(Vec3(eye + 10 * forward)).z(), 1, 1e-4);
  EXPECT_GT(project(Vec3(target + Vec3(0, 0.1f, 0))).y(), 0);
  EXPECT_TRUE(viewMatrix(Vec3(0, 1, 0), Vec3::Zero()).allFinite());
}

TEST(Camera, OrbitTurnsAboutStraightAboveWithoutTurningThePictureOver) {
  const Box box(Eigen::Vector3f(-1, -1, -1), Eigen::Vector3f(1, 1, 1));
  for (const float azimuth : {0.0f, 1.0f, 2.5f, -2.0f}) {
    for (const float degrees : {-89.0f, -60.0f, 0.0f, 86.0f, 88.0f, 89.0f}) {
      const Camera camera = orbit(box, azimuth, degrees * 0.0174533f, 1);
      const Eigen::Matrix4f view = viewMatrix(camera);
      const Vec3 right = view.block<1, 3>(0, 0).transpose(), up = view.block<1, 3>(1, 0).transpose();
      EXPECT_LT((right - Vec3(std::cos(azimuth), 0, -std::sin(azimuth))).norm(), 1e-3)
          << azimuth << " " << degrees;
      EXPECT_GT(up.y(), 0) << azimuth << " " << degrees;
    }
  }
}

}  // namespace
}  // namespace strandcast
