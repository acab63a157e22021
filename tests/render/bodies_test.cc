// Grown hair and bodies, checked by distances on the CPU.
#include "collision/field_bake.h"
#include "offscreen.h"
#include "render/shader_validation.h"

namespace strandcast {
namespace {

constexpr int kBodySegments = 40;

ContactPrimitive shapeOf(PrimitiveKind kind) {
  const Vec3 middle(0.01f, -0.1f, 0.01f);  // between four guides
  ContactPrimitive shape;
  shape.kind = kind;
  shape.a = middle;
  shape.b = Vec3(middle + Vec3(0, -0.02f, 0));
  shape.radius = 0.007f;
  shape.radius_b = 0.004f;
  shape.extent = Vec3(0.008f, 0.02f, 0.006f);
  shape.rotation = Quat(Eigen::AngleAxisf(0.5f, Eigen::Vector3f::UnitY()));
  if (kind == PrimitiveKind::kBox) shape.extent *= 0.7f;
  TriangleMesh diamond;
  for (int axis = 0; axis < 3; ++axis)
    for (const float side : {-1.0f, 1.0f}) {
      Vec3 corner = Vec3::Zero();
      corner[axis] = side * (axis == 1 ? 0.03f : 0.008f);
      diamond.positions.push_back(corner);
    }
  diamond.triangles = {{1, 3, 5}, {3, 0, 5}, {0, 2, 5}, {2, 1, 5},
                       {3, 1, 4}, {0, 3, 4}, {2, 0, 4}, {1, 2, 4}};
  if (kind == PrimitiveKind::kConvex) shape.convex = std::make_shared<ConvexBody>(convexBody(diamond));
  if (kind == PrimitiveKind::kField) {
    FieldOptions options;
    options.cell = 5e-4f;
    shape.field = std::make_shared<DistanceField>(FieldBaker(diamond, options).bake());
  }
  if (kind == PrimitiveKind::kPlane) {
    shape.a = Vec3(0, -0.19f, 0);
    shape.b = Vec3::UnitY();
  }
  return shape;
}

class HairAndBodies : public OffscreenTest {
 protected:
  void SetUp() override {
    OffscreenTest::SetUp();
    if (IsSkipped()) return;
    guides_ = verticalBundle(4, 4, 0.02f, 0, 0.2f, 12).guides;
    nodes_ = std::make_unique<GuideNodes>(kBodySegments);
    nodes_->setGroom(guides_);
    nodes_->update(guides_.positions, Pose{});
    growth_.hairs = 600;
    growth_.interpolation = Interpolation::kMultiStrand;
    growth_.tip_deviation = growth_.whole_deviation = 0;
    const SceneBlock block = makeSceneBlock(RenderSettings{}, Camera{});
    scene_ = gl::Buffer(std::span<const SceneBlock>(&block, 1));
    glBindBufferBase(GL_UNIFORM_BUFFER, binding::kScene, scene_.id());
  }
  std::vector<GrownVertex> grow(GrowthPath path, std::vector<HairObstacle> obstacles) const {
    HairPass pass(path, HairGeometry::kLines);
    pass.setHairs(growHairs(guides_, growth_), growth_);
    pass.setClearance(1e-4f);
    pass.bodies().setObstacles(std::move(obstacles));
    const HairDetail detail = pass.all();
    pass.grow(*nodes_, detail);
    return path == GrowthPath::kCompute ? readComputed(pass, *nodes_, 1)
                                        : readTessellated(pass, *nodes_, detail);
  }
  static int inside(const std::vector<GrownVertex>& grown, const ContactPrimitive& shape,
                    const SurfaceBend& bend = {}) {
    ShapeData data;
    const uint32_t words = data.add(shape);
    MovingPrimitive placed = moved(shape, Pose{}, Pose{}, 1, words);
    if (!bend.isNone()) {
      const MovingBend moving = bendOf(shape, bend, bend);
      const uint32_t at = data.addBend();
      data.setBend(at, moving);
      applyBend(placed, moving, at);
    }
    int count = 0;
    for (const GrownVertex& v : grown) count += signedDistance(placed, v.position, data.words) < -1e-5f;
    return count;
  }

  StrandSet guides_;
  HairGrowth growth_;
  std::unique_ptr<GuideNodes> nodes_;
  gl::Buffer scene_;
};

TEST_F(HairAndBodies, NoVertexIsInAnyKindOfBody) {
  const std::vector<GrownVertex> free = grow(GrowthPath::kCompute, {});
  for (const PrimitiveKind kind : {PrimitiveKind::kSphere, PrimitiveKind::kCapsule, PrimitiveKind::kPlane,
                                   PrimitiveKind::kTaperedCapsule, PrimitiveKind::kEllipsoid,
                                   PrimitiveKind::kBox, PrimitiveKind::kConvex, PrimitiveKind::kField}) {
    const ContactPrimitive shape = shapeOf(kind);
    EXPECT_GT(inside(free, shape), 20) << static_cast<int>(kind);
    EXPECT_EQ(inside(grow(GrowthPath::kCompute, {{shape, false}}), shape), 0) << static_cast<int>(kind);
  }
}

TEST_F(HairAndBodies, NoVertexIsInABodyThatIsBent) {
  const ContactPrimitive shape = shapeOf(PrimitiveKind::kField);
  SurfaceBend bend;  // up to 8 mm sideways at the tips
  bend.middle = shape.a;
  bend.terms[5] = Vec3(9, 0, 0);
  EXPECT_GT(inside(grow(GrowthPath::kCompute, {{shape, false, 1}}), shape, bend), 20);
  const std::vector<GrownVertex> kept = grow(GrowthPath::kCompute, {{shape, false, 1, Pose{}, bend}});
  EXPECT_EQ(inside(kept, shape, bend), 0);
  EXPECT_GT(inside(kept, shape), 20);
}

TEST_F(HairAndBodies, TheTessellatorGrowsTheSameHair) {
  const std::vector<HairObstacle> obstacles{{shapeOf(PrimitiveKind::kSphere), false},
                                            {shapeOf(PrimitiveKind::kPlane), false}};
  const std::vector<GrownVertex> computed = grow(GrowthPath::kCompute, obstacles);
  double worst = 0;
  for (const GrownVertex& v : grow(GrowthPath::kTessellator, obstacles))
    worst = std::max(
        worst,
        static_cast<double>((v.position - computed[v.hair * (kBodySegments + 1) + v.node].position).norm()));
  EXPECT_LT(worst, 0.2 * 1e-5);
}

TEST_F(HairAndBodies, HairFollowsOneGuideBelowTheBodyAndIsAsItWasElsewhere) {
  const std::vector<GrownVertex> free = grow(GrowthPath::kCompute, {});
  const ContactPrimitive ball = shapeOf(PrimitiveKind::kSphere);
  const std::vector<GrownVertex> kept = grow(GrowthPath::kCompute, {{ball, false}});
  const std::vector<Hair> hairs = growHairs(guides_, growth_);
  int switched = 0, untouched = 0;
  for (size_t h = 0; h < hairs.size(); ++h) {
    float deepest = 0, change = 0;
    const size_t first = h * (kBodySegments + 1);
    for (size_t i = first; i <= first + kBodySegments; ++i) {
      deepest = std::max(deepest, ball.radius - (free[i].position - ball.a).norm());
      change = std::max(change, (kept[i].position - free[i].position).norm());
      // Hair is unchanged until 15 % of the length before the body.
      if (i - first < 10) {
        EXPECT_NEAR((kept[i].position - free[i].position).norm(), 0, 1e-6);
      }
    }
    if (deepest == 0 && change < 1e-7f) ++untouched;
    if (deepest < 0.002f) continue;
    ++switched;
    // From a depth of 2 mm on, the closing is complete: the tip is at the guide's, except for its offset in
    // the lock.
    const size_t node = static_cast<size_t>(hairs[h].extent * kBodySegments);
    const Vec3 guide = guides_.strand(hairs[h].guides[0]).back();
    const Vec3 across = Vec3(kept[first + node].position - guide);
    EXPECT_LT(std::hypot(across.x(), across.z()), 0.25f * growth_.clump_radius + 1e-5f);
  }
  EXPECT_GT(switched, 10);
  EXPECT_GT(untouched, 300);
}

}  // namespace
}  // namespace strandcast
