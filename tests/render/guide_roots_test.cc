// The rotation of grown hair's frames: that of the skin that the guides' roots are on.
#include "render/guide_nodes.h"

#include <gtest/gtest.h>

#include <memory>

#include "collision/field_bake.h"
#include "render/hair_growth.h"
#include "render/scene_block.h"
#include "tests/collision/shapes.h"
#include "tests/render/offscreen.h"

namespace strandcast {
namespace {

constexpr uint32_t kBall = 5;

/// A ball of 3 cm at the origin, as a part of a skinned body.
HairObstacle ball() {
  HairObstacle ball;
  ball.shape.kind = PrimitiveKind::kField;
  FieldOptions options;
  options.cell = 2e-3f;
  ball.shape.field = std::make_shared<DistanceField>(FieldBaker(shapes::sphere(0.03f, 3), options).bake());
  ball.follows_head = false;
  ball.collider = kBall;
  return ball;
}

/// A guide on top of the ball, and one far from it.
class GuidesOnABall : public ::testing::Test {
 protected:
  GuidesOnABall() {
    guides_.append(std::vector<Vec3>{Vec3(0, 0.03f, 0), Vec3(0, 0.05f, 0), Vec3(0, 0.07f, 0)});
    guides_.append(std::vector<Vec3>{Vec3(1, 0, 0), Vec3(1, 0.1f, 0)});
    roots_.setGroom(guides_);
    roots_.setObstacles(std::vector<HairObstacle>{ball()});
    rest_ = rootFrame(guides_.strand(0)).normal;
  }
  void placeBall(const Pose& pose) {
    roots_.setColliderPoses(std::vector<PlacedCollider>{{kBall, pose, {}}});
  }
  static Pose turnedBy(float angle, const Eigen::Vector3f& axis) {
    return {Vec3(0.1f, 0, 0), Quat(Eigen::AngleAxisf(angle, axis))};
  }

  StrandSet guides_;
  GuideRoots roots_;
  Vec3 rest_;
};

TEST_F(GuidesOnABall, TurnWithItAndNotWithTheHead) {
  ASSERT_TRUE(roots_.carries(0));
  EXPECT_FALSE(roots_.carries(1)) << "far from it: with the head";
  EXPECT_EQ(roots_.restNormal(0), rest_);
  const Pose head = turnedBy(1.5f, Eigen::Vector3f::UnitY());
  placeBall({});
  // The head rotates about the guide's axis, so the guide's direction does not show it; but the root is not
  // where the head would carry it.
  EXPECT_LT((roots_.normal(0, Vec3(0, 0.03f, 0), head).normalized() - rest_).norm(), 1e-4f);
  const Pose ball = turnedBy(0.8f, Eigen::Vector3f(1, 2, 3).normalized());
  placeBall(ball);
  EXPECT_LT((roots_.normal(0, ball.apply(Vec3(0, 0.03f, 0)), {}).normalized() - ball.rotate(rest_)).norm(),
            1e-4f);
}

TEST_F(GuidesOnABall, ThatTheHeadCarriesTurnWithTheHead) {
  const Pose head = turnedBy(1.5f, Eigen::Vector3f::UnitY());
  placeBall({});
  EXPECT_LT((roots_.normal(0, head.apply(Vec3(0, 0.03f, 0)), head).normalized() - head.rotate(rest_)).norm(),
            1e-4f);
}

TEST_F(GuidesOnABall, WhereBothHaveThemTurnAsBothDo) {
  const Pose same = turnedBy(0.7f, Eigen::Vector3f::UnitX());
  placeBall(same);
  for (const Vec3& off : {Vec3(0, 0, 0), Vec3(1e-4f, 0, 0), Vec3(0, -0.02f, 0.01f)})
    EXPECT_LT((roots_.normal(0, same.apply(Vec3(0, 0.03f, 0)) + off, same) - same.rotate(rest_)).norm(),
              1e-5f);
}

TEST_F(GuidesOnABall, RotateFromRestAsWhatCarriesTheRoot) {
  const Vec3 root(0, 0.03f, 0);
  const Pose ball = turnedBy(2.1f, Eigen::Vector3f(1, 2, 3).normalized()),
             head = turnedBy(1.5f, Eigen::Vector3f::UnitY());
  placeBall(ball);
  EXPECT_LT(roots_.motion(0, ball.apply(root), head).rotation.angularDistance(ball.rotation), 1e-3f);
  placeBall({});
  EXPECT_LT(roots_.motion(0, head.apply(root), head).rotation.angularDistance(head.rotation), 1e-3f);
  placeBall(head);
  EXPECT_LT(roots_.motion(0, head.apply(root), head).rotation.angularDistance(head.rotation), 1e-5f);
  const Vec3 off(1.5e-5f, 0, 0);  // of a codec: the place is that of the parts
  EXPECT_LT((roots_.motion(0, head.apply(root) + off, head).apply(root) - head.apply(root)).norm(), 1e-6f);
}

TEST_F(GuidesOnABall, WithoutItTurnWithTheHead) {
  roots_.setObstacles({});
  EXPECT_FALSE(roots_.carries(0));
}

class NodesOfGuidesOnABall : public OffscreenTest {};

TEST_F(NodesOfGuidesOnABall, AreTheGuidesCarriedByIt) {
  constexpr int kSegments = 4;
  const Pose carry{Vec3(0.1f, 0.3f, 0), Quat(Eigen::AngleAxisf(1.2f, Eigen::Vector3f(1, 2, 3).normalized()))},
      head{Vec3::Zero(), Quat(Eigen::AngleAxisf(2, Eigen::Vector3f::UnitY()))};
  StrandSet guides;
  for (const Vec3& root : {Vec3(0, 0.03f, 0), Vec3(0.03f, 0, 0), Vec3(0, 0, -0.03f)})
    guides.append(std::vector<Vec3>{root, 1.5f * root, 2 * root + Vec3(0.01f, 0.01f, 0)});
  GuideNodes nodes(kSegments);
  nodes.setGroom(guides);
  const auto normals = [&](std::span<const Vec3> positions, const Pose& at) {
    EXPECT_EQ(nodes.update(positions, head, std::vector<PlacedCollider>{{kBall, at, {}}}), 0u);
    nodes.bind();
    GLint buffer = 0;
    glGetIntegeri_v(GL_SHADER_STORAGE_BUFFER_BINDING, binding::kNodes, &buffer);
    std::vector<Eigen::Vector4f> read(guides.strands() * (kSegments + 1) * 3);
    glGetNamedBufferSubData(static_cast<GLuint>(buffer), 0,
                            static_cast<GLsizeiptr>(read.size() * sizeof read[0]), read.data());
    std::vector<Vec3> out;
    for (size_t i = 2; i < read.size(); i += 3) out.emplace_back(read[i].head<3>());
    return out;
  };
  std::vector<Vec3> moved;
  for (const Vec3& p : guides.positions) moved.push_back(carry.apply(p));
  const auto farthest = [&](const std::vector<Vec3>& rest) {
    const std::vector<Vec3> now = normals(moved, carry);
    float most = 0;
    for (size_t i = 0; i < now.size(); ++i) most = std::max(most, (now[i] - carry.rotate(rest[i])).norm());
    return most;
  };
  nodes.setObstacles(std::vector<HairObstacle>{ball()});
  const std::vector<Vec3> rest = normals(guides.positions, {});
  EXPECT_LT(farthest(rest), 1e-3f);
  nodes.setObstacles({});
  EXPECT_GT(farthest(rest), 0.5f) << "without it they turn with the head again";
}

}  // namespace
}  // namespace strandcast
