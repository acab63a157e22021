// Marks of vertices in bodies, checked by distances and projection on the CPU.
#include <algorithm>

#include "core/srgb.h"
#include "offscreen.h"
#include "render/shader_validation.h"

namespace strandcast {
namespace {

class Marked : public OffscreenTest {
 protected:
  Marked() : groom_(verticalBundle(4, 4, 0.02f, 0.1f, 0.2f, 12)) {
    settings_ = smallPicture();
    settings_.width = settings_.height = kSize;
    settings_.samples = 1;
    settings_.growth.hairs = 400;
    settings_.growth.tip_deviation = 0.01f;
    settings_.detail = {1, 0, 0, 0};
    settings_.shadows = false;
    settings_.passes = {RenderPass::kGuides, RenderPass::kGrowth, RenderPass::kMarks, RenderPass::kResolve};
    groom_.hair_radius = 5e-5f;
    ball_.a = Vec3(0.012f, 0, 0.008f);
    ball_.radius = 0.014f;
    camera_.eye = Vec3(0.3f, 0.1f, 0.8f);
    camera_.target = Vec3::Zero();
    camera_.vertical_fov = 0.3f;
  }
  Image draw() const {
    Renderer renderer(settings_);
    renderer.setGroom(groom_);
    renderer.setObstacles({{ball_, false}});
    renderer.draw(restFrame(groom_), camera_);
    return renderer.read();
  }
  double depthIn(const Eigen::Vector3d& point) const {
    return static_cast<double>(ball_.radius) - (point - ball_.a.cast<double>()).norm();
  }
  /// Pixel coordinates, from the top left.
  Eigen::Vector2d pixelOf(const Eigen::Vector3d& point) const {
    const Eigen::Vector4f clip = perspective(camera_.vertical_fov, 1, 0.02f, 50) *
                                 viewMatrix(camera_.eye, camera_.target) *
                                 Eigen::Vector4f(point.cast<float>().homogeneous());
    return {(0.5 + 0.5 * static_cast<double>(clip.x() / clip.w())) * kSize,
            (0.5 - 0.5 * static_cast<double>(clip.y() / clip.w())) * kSize};
  }
  /// Checks that every pixel of this colour is within `reach` pixels of a place, and that every place has
  /// one.
  void expectMarks(const Image& image, const std::vector<Eigen::Vector2d>& places, double reach,
                   const Vec3& color) const {
    int lost = 0, stray = 0, marked = 0;
    const auto shows = [&](int x, int y) {
      for (int c = 0; c < 3; ++c) {
        const double stored =
            image
                .rgb[3 * (static_cast<size_t>(y) * kSize + static_cast<size_t>(x)) + static_cast<size_t>(c)] /
            255.0;
        const double wanted = static_cast<double>(color[c]);
        if (std::abs(stored - srgbOf(wanted)) > 0.02) return false;
      }
      return true;
    };
    for (const Eigen::Vector2d& place : places)
      lost += !shows(static_cast<int>(place.x()), static_cast<int>(place.y()));
    for (int y = 0; y < kSize; ++y)
      for (int x = 0; x < kSize; ++x) {
        if (!shows(x, y)) continue;
        ++marked;
        stray += std::none_of(places.begin(), places.end(), [&](const Eigen::Vector2d& place) {
          return (place - Eigen::Vector2d(x + 0.5, y + 0.5)).cwiseAbs().maxCoeff() <= reach;
        });
      }
    EXPECT_EQ(lost, 0) << "of " << places.size() << " vertices that should be marked";
    EXPECT_EQ(stray, 0) << "of " << marked << " pixels that are marked";
  }

  static constexpr int kSize = 300;
  GroomDescription groom_;
  RenderSettings settings_;
  ContactPrimitive ball_;
  Camera camera_;
};

TEST_F(Marked, VerticesOfGrownHairInABodyAreAndNoOthers) {
  settings_.marks.inside = true;
  const HairReference reference(groom_.guides, groom_.guides.positions, settings_.segments);
  std::vector<Eigen::Vector2d> places;
  for (const Hair& hair : growHairs(groom_.guides, settings_.growth))
    for (int node = 0; node <= settings_.segments; ++node) {
      const Eigen::Vector3d at = reference.at(hair, settings_.growth, node).position;
      if (depthIn(at) > 1e-5) places.push_back(pixelOf(at));
    }
  EXPECT_GT(places.size(), 40u);
  expectMarks(draw(), places, 2, Vec3(1, 0.05f, 0.3f));
  settings_.keep_out = true;
  expectMarks(draw(), {}, 0, Vec3(1, 0.05f, 0.3f));
}

TEST_F(Marked, HairIsTheSameBeforeAndAfter) {
  settings_.marks.collided = true;
  settings_.growth.interpolation = Interpolation::kMultiStrand;
  settings_.hair_width = 5e-4f;
  ball_.a = Vec3::Zero();  // between guides, and touches none
  ball_.radius = 0.012f;
  for (const GrowthPath path : {GrowthPath::kCompute, GrowthPath::kTessellator}) {
    settings_.growth_path = path;
    const auto with = [&](std::vector<RenderPass> passes) {
      settings_.passes = {RenderPass::kGuides, RenderPass::kGrowth};
      settings_.passes.insert(settings_.passes.end(), passes.begin(), passes.end());
      settings_.passes.push_back(RenderPass::kResolve);
      return draw();
    };
    const Image before = with({RenderPass::kHair, RenderPass::kMarks});
    EXPECT_NE(before.rgb, with({RenderPass::kMarks}).rgb);
    EXPECT_EQ(before.rgb, with({RenderPass::kMarks, RenderPass::kHair}).rgb) << static_cast<int>(path);
  }
}

TEST_F(Marked, VerticesOfGuidesThatTouchABodyAreYellowAndThoseInsideRed) {
  settings_.marks.collided = true;
  ball_.a = groom_.guides.strand(5)[6];  // centred on a vertex, with a vertex of another guide within a
                                         // hair's radius
  ball_.radius = (groom_.guides.strand(6)[6] - ball_.a).norm() - 7e-5f;
  std::vector<Eigen::Vector2d> inside, touching;
  for (const Vec3& p : groom_.guides.positions) {
    const double depth = depthIn(p.cast<double>());
    if (depth > 0)
      inside.push_back(pixelOf(p.cast<double>()));
    else if (depth > -1e-4)
      touching.push_back(pixelOf(p.cast<double>()));
  }
  ASSERT_GE(inside.size(), 1u);
  ASSERT_GE(touching.size(), 3u);
  const Image image = draw();
  expectMarks(image, inside, 3, Vec3(1, 0.1f, 0.1f));
  expectMarks(image, touching, 3, Vec3(1, 0.75f, 0.1f));
}

}  // namespace
}  // namespace strandcast
