// What programs pass to a renderer for a stream: obstacles for each scene; and what they tell its daemon.
#include "options/picture_scene.h"

#include <cmath>

#include "collision/field_bake.h"
#include "options/picture_settings.h"
#include "tests/collision/shapes.h"
#include "tests/render/offscreen.h"

namespace strandcast {
namespace {

constexpr uint32_t kPart = 7;

class Obstacles : public OffscreenTest {
 protected:
  Obstacles() {
    options_.settings = smallPicture();
    ball_.mesh = shapes::sphere(0.05f, 3, Vec3::Zero());
    box_.mesh = shapes::box(Vec3(0.03f, 0.03f, 0.03f));
    ContactPrimitive shape;
    shape.kind = PrimitiveKind::kField;
    FieldOptions field;
    field.cell = 4e-3f;
    shape.field = std::make_shared<DistanceField>(FieldBaker(ball_.mesh, field).bake());
    parts_.colliders = {{kPart, false, true, {shape}}};
    moved_.colliders = {{kPart, {Vec3(0, 0.08f, 0), Quat::Identity()}, {}}};
    camera_.eye = Vec3(0, 0, 0.6f);
    camera_.target = Vec3::Zero();
  }
  Image drawn(Renderer& renderer, const GuideFrame& frame) const {
    renderer.draw(frame, camera_);
    return renderer.read();
  }

  PictureOptions options_;
  BodyDescription ball_, box_;
  ColliderSet parts_;
  GuideFrame moved_;
  Camera camera_;
};

TEST_F(Obstacles, AreNeededToKeepHairOutForMarksAndToCarryASkinnedBody) {
  EXPECT_FALSE(needsObstacles(options_, nullptr));
  EXPECT_TRUE(needsObstacles(options_, &parts_));
  ColliderSet of_head = parts_;
  of_head.colliders[0].follows_head = true;
  EXPECT_FALSE(needsObstacles(options_, &of_head));
  options_.settings.marks.inside = true;
  EXPECT_TRUE(needsObstacles(options_, nullptr));
  options_.settings.marks = {};
  options_.settings.keep_out = true;
  EXPECT_TRUE(needsObstacles(options_, nullptr));
}

TEST_F(Obstacles, OfAnEarlierSceneCarryNothingOfTheNext) {
  Renderer fresh(options_.settings), renderer(options_.settings);
  setScene(fresh, {}, box_);
  const Image wanted = drawn(fresh, {});
  setScene(renderer, {}, ball_);
  const Image rest = drawn(renderer, {});
  setObstacles(renderer, options_, &parts_, ball_);
  EXPECT_NE(drawn(renderer, moved_).rgb, rest.rgb) << "they carry the body";
  setObstacles(renderer, options_, nullptr, ball_);
  EXPECT_EQ(drawn(renderer, moved_).rgb, rest.rgb) << "there are none any more";
  setObstacles(renderer, options_, &parts_, ball_);
  setScene(renderer, {}, box_);
  EXPECT_EQ(drawn(renderer, moved_).rgb, wanted.rgb);
}

TEST(PixelsOfHair, AreTheDiameterOfItsBoundingSphereInThePicture) {
  GuideFrame frame;
  Camera camera;
  EXPECT_EQ(pixelsOfHair(camera, frame, 720), 0) << "no hair";
  frame.positions = {Vec3(-0.1f, 0, 0), Vec3(0.1f, 0, 0), Vec3(NAN, 0, 0)};
  camera.target = Vec3::Zero();
  camera.eye = Vec3(0, 0, 2);
  const float expected = 720 * 0.1f / std::sqrt(4 - 0.01f) / std::tan(0.5f * camera.vertical_fov);
  EXPECT_NEAR(pixelsOfHair(camera, frame, 720), expected, 0.1f);
  camera.eye = Vec3(0, 0, 0.05f);
  EXPECT_EQ(pixelsOfHair(camera, frame, 720), 1e6f) << "the eye is in it";
}

}  // namespace
}  // namespace strandcast
