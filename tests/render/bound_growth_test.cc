// Bound hairs as shaders grow them, against double precision (groom/bound_growth.h), and pictures of them.
#include "groom/bound_growth.h"

#include <algorithm>
#include <limits>
#include <random>

#include "core/error.h"
#include "groom/groom.h"
#include "groom/groom_operations.h"
#include "groom/hair_binding.h"
#include "render/bound_hairs.h"
#include "render/hair_pass.h"
#include "render/shader_validation.h"
#include "tests/groom/curled_hairs.h"
#include "tests/real_data.h"
#include "tests/render/offscreen.h"

namespace strandcast {
namespace {

constexpr int kNodeSegments = 32;

/// Hairs bound to guides, grown by the shader.
struct Bound {
  Bound(StrandSet guide_set, StrandSet hairs) : guides(std::move(guide_set)), nodes(kNodeSegments) {
    description.hairs = std::move(hairs);
    description.bindings = bindHairs(description.hairs, guides);
  }
  /// The vertices of every hair; a hair that is not drawn has none.
  std::vector<std::vector<GrownVertex>> grow(std::span<const Vec3> positions, const Pose& head = {},
                                             int stride = 1, const std::vector<PlacedCollider>& moved = {}) {
    nodes.setGroom(guides, true);
    nodes.update(positions, head);
    HairPass pass(GrowthPath::kCompute, HairGeometry::kLines);
    pass.setHairs(boundHairs(description, guides, {}, 1e-4f), {},
                  std::make_unique<BoundHairs>(description.hairs));
    pass.setClearance(clearance);
    pass.bodies().setObstacles(obstacles);
    pass.bodies().place(head, moved);
    HairDetail detail = pass.all();
    detail.vertex_stride = stride;
    pass.grow(nodes, detail);
    std::vector<std::vector<GrownVertex>> hairs(description.hairs.strands());
    for (const GrownVertex& vertex : readBound(pass, stride))
      hairs[pass.hairs()[vertex.hair].bound - 1].push_back(vertex);
    return hairs;
  }
  /// m, largest distance of the shader's vertices from those in double precision.
  double worst(std::span<const Vec3> positions, const Pose& head) {
    const BoundHairReference reference(guides, positions, std::vector<Pose>(guides.strands(), head),
                                       kNodeSegments);
    const auto grown = grow(positions, head);
    double worst = 0;
    for (size_t s = 0; s < grown.size(); ++s) {
      const auto exact = reference.grow(description.hairs.strand(s), description.bindings[s]);
      EXPECT_GE(grown[s].size(), exact.size());
      for (size_t j = 0; j < std::min(exact.size(), grown[s].size()); ++j) {
        worst = std::max(worst, (grown[s][j].position.cast<double>() - exact[j].position).norm());
        EXPECT_LT((grown[s][j].tangent.cast<double>() - exact[j].tangent).norm(), 1e-3);
      }
    }
    return worst;
  }
  double worstAtRest() {
    const auto grown = grow(guides.positions);
    double worst = 0;
    for (size_t s = 0; s < grown.size(); ++s)
      for (size_t j = 0; j < description.hairs.verticesOf(s); ++j)
        worst = std::max<double>(worst, (grown[s][j].position - description.hairs.strand(s)[j]).norm());
    return worst;
  }

  StrandSet guides;
  HairDescription description;
  GuideNodes nodes;
  std::vector<HairObstacle> obstacles;
  float clearance = 2e-4f;  // m
};

HairObstacle solidBall(const Vec3& middle, float radius) {
  HairObstacle ball;
  ball.shape.a = middle;
  ball.shape.radius = radius;
  return ball;
}

/// Each guide bends by up to a radian, its own way, and the head moves.
std::vector<Vec3> bent(const StrandSet& guides, const Pose& head) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> unit(-1, 1);
  std::vector<Vec3> positions;
  for (size_t g = 0; g < guides.strands(); ++g) {
    const Eigen::Vector3f axis(unit(random), 0.3f * unit(random), unit(random));
    const auto points = guides.strand(g);
    Vec3 at = points[0];
    for (size_t i = 0; i < points.size(); ++i) {
      const float angle = static_cast<float>(i) / static_cast<float>(points.size());
      if (i > 0) at += Quat(Eigen::AngleAxisf(angle, axis.normalized())) * (points[i] - points[i - 1]);
      positions.push_back(head.apply(at));
    }
  }
  return positions;
}

using BoundHairGrowth = OffscreenTest;

TEST_F(BoundHairGrowth, EqualsDoublePrecisionWhereGuidesBendAndTheHeadMoves) {
  Bound bound(curledHairs(29, 1, 1.6f), curledHairs(120, 2, 1.6f));
  const Pose head{Vec3(0.1f, 0.2f, -0.3f),
                  Quat(Eigen::AngleAxisf(0.8f, Eigen::Vector3f(1, 2, 3).normalized()))};
  EXPECT_LT(bound.worst(bent(bound.guides, {}), {}), 2e-6);
  EXPECT_LT(bound.worst(bent(bound.guides, head), head), 2e-6);
}

TEST_F(BoundHairGrowth, IsTheArtistsHairAtRest) {
  EXPECT_LT(Bound(curledHairs(29, 1, 1.6f), curledHairs(120, 2, 1.6f)).worstAtRest(), 5e-7);
}

TEST_F(BoundHairGrowth, IsTheArtistsHairAtRestThroughTheErrorOfACodecWhereverTheHeadIs) {
  Bound bound(curledHairs(29, 1, 1.6f), curledHairs(120, 2, 1.6f));
  const Pose turned{Vec3(0.1f, 0.2f, -0.3f),
                    Quat(Eigen::AngleAxisf(0.8f, Eigen::Vector3f(1, 2, 3).normalized()))};
  std::mt19937 random(5);
  std::uniform_real_distribution<float> unit(-1, 1);
  for (const Pose& head : {Pose{}, turned}) {
    std::vector<Vec3> now;
    for (const Vec3& p : bound.guides.positions)
      now.push_back(head.apply(p) + 1.5e-5f * Vec3(unit(random), unit(random), unit(random)).normalized());
    const auto grown = bound.grow(now, head);
    double worst = 0;
    for (size_t s = 0; s < grown.size(); ++s)
      for (size_t j = 0; j < bound.description.hairs.verticesOf(s); ++j)
        worst = std::max<double>(
            worst, (grown[s][j].position - head.apply(bound.description.hairs.strand(s)[j])).norm());
    EXPECT_LT(worst, 2e-6);
    EXPECT_LT(bound.worst(now, head), 2e-6) << "as in double precision";
  }
}

TEST_F(BoundHairGrowth, EqualsDoublePrecisionWhereGuidesLeaveRest) {
  // Displacements of 0 to 0.15 mm, by guide, cover the blend.
  Bound bound(curledHairs(29, 1, 1.6f), curledHairs(120, 2, 1.6f));
  std::vector<Vec3> now = bound.guides.positions;
  for (size_t g = 0; g < bound.guides.strands(); ++g)
    for (size_t v = bound.guides.offsets[g]; v < bound.guides.offsets[g + 1]; ++v)
      now[v] +=
          1.5e-4f * static_cast<float>(g) / 28 * Vec3(0.6f, static_cast<float>(v % 2), 0.8f).normalized();
  EXPECT_LT(bound.worst(now, {}), 3e-6);
}

TEST_F(BoundHairGrowth, MovesRigidlyWithTheHead) {
  Bound bound(curledHairs(29, 1, 1.6f), curledHairs(120, 2, 1.6f));
  const Pose head{Vec3(0.3f, 0.2f, -0.4f),
                  Quat(Eigen::AngleAxisf(2.4f, Eigen::Vector3f(1, 2, -1).normalized()))};
  std::vector<Vec3> now;
  for (const Vec3& p : bound.guides.positions) now.push_back(head.apply(p));
  const auto grown = bound.grow(now, head);
  double worst = 0;
  for (size_t s = 0; s < grown.size(); ++s)
    for (size_t j = 0; j < bound.description.hairs.verticesOf(s); ++j) {
      const Eigen::Vector3d rest = bound.description.hairs.strand(s)[j].cast<double>();
      const Eigen::Vector3d exact = head.rotation.cast<double>() * rest + head.position.cast<double>();
      worst = std::max(worst, (grown[s][j].position.cast<double>() - exact).norm());
    }
  EXPECT_LT(worst, 1.5e-6);
}

TEST_F(BoundHairGrowth, IsTheArtistsHairAtRestInAHeadThatHoldsPartOfIt) {
  Bound bound(curledHairs(29, 1, 1.6f), curledHairs(120, 2, 1.6f));
  const Vec3 middle = bound.description.hairs.strand(0)[3];
  bound.obstacles = {solidBall(middle, 0.03f)};
  int held = 0;
  for (const Vec3& p : bound.description.hairs.positions) held += (p - middle).norm() < 0.03f;
  EXPECT_GT(held, 30);
  EXPECT_LT(bound.worstAtRest(), 1e-6);
  const Pose head{Vec3(0.3f, 0.2f, -0.4f),
                  Quat(Eigen::AngleAxisf(2.4f, Eigen::Vector3f(1, 2, -1).normalized()))};
  std::vector<Vec3> now;
  for (const Vec3& p : bound.guides.positions) now.push_back(head.apply(p));
  const auto grown = bound.grow(now, head);
  for (size_t s = 0; s < grown.size(); ++s)
    for (size_t j = 0; j < bound.description.hairs.verticesOf(s); ++j)
      EXPECT_LT((grown[s][j].position - head.apply(bound.description.hairs.strand(s)[j])).norm(), 3e-6f);
}

TEST_F(BoundHairGrowth, IsTheArtistsHairAtRestInShouldersThatStandThere) {
  Bound bound(curledHairs(29, 1, 1.6f), curledHairs(120, 2, 1.6f));
  HairObstacle shoulder = solidBall(bound.description.hairs.strand(0).back(), 0.03f);
  shoulder.follows_head = false;
  shoulder.collider = 3;
  bound.obstacles = {shoulder};
  EXPECT_LT(bound.worstAtRest(), 1e-6);
}

TEST_F(BoundHairGrowth, ObstaclesThatComeLaterKeepHairOutAsFarAsItWasAtRest) {
  // The head holds the roots; a ball comes into the lengths.
  Bound bound(curledHairs(29, 1, 1.6f), curledHairs(120, 2, 1.6f));
  const StrandSet& hairs = bound.description.hairs;
  const Vec3 head = hairs.strand(0)[0], ball = hairs.strand(40)[hairs.verticesOf(40) / 2];
  constexpr float kHead = 0.02f, kBall = 0.025f;
  HairObstacle moving = solidBall(Vec3::Zero(), kBall);
  moving.follows_head = false;
  moving.collider = 7;
  bound.obstacles = {solidBall(head, kHead), moving};
  const std::vector<PlacedCollider> placed{{7, Pose{ball, Quat::Identity()}, {}}};
  const auto free = bound.grow(bound.guides.positions);
  const auto kept = bound.grow(bound.guides.positions, {}, 1, placed);
  int moved = 0, untouched = 0;
  for (size_t s = 0; s < kept.size(); ++s) {
    float closest = 1;
    for (size_t j = 0; j < hairs.verticesOf(s); ++j) {
      const Vec3& rest = hairs.strand(s)[j];
      const float allowed = std::min(bound.clearance, (rest - head).norm() - kHead);
      EXPECT_GE((kept[s][j].position - ball).norm() - kBall, allowed - 2e-6f);
      EXPECT_GE((kept[s][j].position - head).norm() - kHead, allowed - 2e-6f);
      moved += (kept[s][j].position - free[s][j].position).norm() > 1e-3f;
      closest = std::min(closest, (rest - ball).norm() - kBall);
    }
    if (closest < bound.clearance) continue;
    ++untouched;
    for (size_t j = 0; j < hairs.verticesOf(s); ++j)
      EXPECT_LT((kept[s][j].position - free[s][j].position).norm(), 1e-6f);
  }
  EXPECT_GT(moved, 50);
  EXPECT_GT(untouched, 20);
}

TEST_F(BoundHairGrowth, FollowsOneGuideAroundABodyBetweenItsGuides) {
  // A hair half way between two straight guides that a ball parts: it passes the ball beside its first guide,
  // from before the ball on, without a kink as deep as the ball.
  const auto straight = [](float x, size_t vertices) {
    std::vector<Vec3> points;
    for (size_t i = 0; i < vertices; ++i)
      points.push_back(Vec3(x, 1.6f - 0.2f * static_cast<float>(i) / static_cast<float>(vertices - 1), 0));
    return points;
  };
  StrandSet guides, hairs;
  guides.append(straight(-0.01f, 20));
  guides.append(straight(0.01f, 20));
  hairs.append(straight(0, 41));
  Bound bound(guides, hairs);
  bound.description.bindings = {{{0, 1, 1}, {127, 0}}};
  HairObstacle ball = solidBall(Vec3(0.0005f, 1.45f, 0), 0.012f);
  ball.follows_head = false;
  ball.collider = 7;
  const Vec3 middle = ball.shape.a;
  ball.shape.a = Vec3::Zero();
  std::vector<Vec3> now;
  for (size_t v = 0; v < guides.vertices(); ++v) {  // as the simulation would keep them off
    Vec3 p = guides.positions[v];
    p.x() += (v < 20 ? -0.02f : 0.02f) * std::clamp((1.6f - p.y()) / 0.1f, 0.0f, 1.0f);
    now.push_back(p);
  }
  const auto free = bound.grow(now);
  bound.obstacles = {ball};
  const auto kept = bound.grow(now, {}, 1, {{7, Pose{middle, Quat::Identity()}, {}}});
  EXPECT_LT(kept[0].back().position.x(), -0.01f) << "of the first guide's side, below the ball too";
  EXPECT_LT(std::abs(free[0].back().position.x()), 0.002f);
  EXPECT_LT((kept[0][0].position - free[0][0].position).norm(), 1e-7f) << "the root stays";
  for (size_t j = 1; j < kept[0].size(); ++j) {
    EXPECT_GE((kept[0][j].position - middle).norm(), 0.012f + bound.clearance - 2e-6f);
    EXPECT_LT((kept[0][j].position - kept[0][j - 1].position).norm(), 0.009f) << j;
  }
}

TEST_F(BoundHairGrowth, LeavesVerticesOutByTheStrideButNotTips) {
  Bound bound(curledHairs(29, 1, 1.6f), curledHairs(120, 2, 1.6f));
  const auto all = bound.grow(bound.guides.positions), few = bound.grow(bound.guides.positions, {}, 4);
  for (size_t s = 0; s < all.size(); ++s) {
    const size_t vertices = bound.description.hairs.verticesOf(s);
    ASSERT_EQ(few[s].size(), 9u);  // 30 vertices, the most, are 29 segments
    for (size_t i = 0; i < few[s].size(); ++i)
      EXPECT_EQ(few[s][i].position, all[s][std::min(4 * i, vertices - 1)].position);
    EXPECT_EQ(few[s].back().position, all[s][vertices - 1].position);
  }
}

TEST_F(BoundHairGrowth, HidesTheHairsOfAGuideThatIsNotFinite) {
  StrandSet hairs = curledHairs(40, 3, 1.6f);
  hairs.append(std::vector<Vec3>{Vec3(0, 1.6f, 0)});  // one vertex
  Bound bound(curledHairs(5, 1, 1.6f), hairs);
  std::vector<Vec3> now = bound.guides.positions;
  now[bound.guides.offsets[2] + 1].y() = std::numeric_limits<float>::quiet_NaN();
  bound.nodes.setGroom(bound.guides, true);
  EXPECT_EQ(bound.nodes.update(now, {}), 1u);
  HairPass pass(GrowthPath::kCompute, HairGeometry::kLines);
  pass.setHairs(boundHairs(bound.description, bound.guides, {}, 1e-4f), {},
                std::make_unique<BoundHairs>(bound.description.hairs));
  pass.grow(bound.nodes, pass.all());
  const HairVertices& grown = pass.boundVertices();
  std::vector<float> numbers(grown.hairs() * static_cast<size_t>(grown.nodesPerHair()) * 8);
  glGetNamedBufferSubData(grown.chunks()[0].vertices.id(), 0,
                          static_cast<GLsizeiptr>(numbers.size() * sizeof(float)), numbers.data());
  size_t hidden = 0;
  for (size_t i = 0; i < grown.hairs(); ++i) {
    const Hair& hair = pass.hairs()[i];
    const float* root = &numbers[i * static_cast<size_t>(grown.nodesPerHair()) * 8];
    const bool follows = std::ranges::count(hair.guides, 2u) > 0;
    EXPECT_EQ(root[7] < 0, follows);
    hidden += follows;
    if (!follows) {
      EXPECT_LT((Vec3(root[0], root[1], root[2]) - hairs.strand(hair.bound - 1)[0]).norm(), 1e-6f);
    }
  }
  EXPECT_GT(hidden, 5u);
  EXPECT_LT(hidden, 41u);
}

TEST_F(BoundHairGrowth, TakesWidthsColoursAndDifferencesFromTheArtist) {
  Bound bound(curledHairs(9, 1, 1.6f), curledHairs(3, 2, 1.6f));
  HairDescription& d = bound.description;
  const std::vector<Hair> plain = boundHairs(d, bound.guides, {}, 2e-4f);
  for (const Hair& hair : plain) {
    EXPECT_EQ(hair.width, 1);
    EXPECT_EQ(hair.color, 0u);
    EXPECT_GT(hair.reach, 0);
  }
  EXPECT_NE(plain[0].shade, plain[1].shade);
  d.ids = {7, 7, 9};
  d.colours = {{255, 0, 0}, {1, 2, 3}, {0, 0, 0}};
  d.hairs.radii.assign(d.hairs.vertices(), 5e-5f);
  d.hairs.radii[0] = 2e-4f;
  std::fill(d.hairs.radii.begin() + d.hairs.offsets[2], d.hairs.radii.end(), 0.0f);
  const std::vector<Hair> given = boundHairs(d, bound.guides, {}, 2e-4f);
  ASSERT_EQ(given.size(), 2u) << "a hair without a width is not drawn";
  EXPECT_FLOAT_EQ(given[0].width, 2);
  EXPECT_FLOAT_EQ(given[1].width, 0.5f);
  EXPECT_EQ(given[0].color, 0x010000ffu);
  EXPECT_EQ(given[1].color, 0x01030201u);
  EXPECT_EQ(given[0].first_sample, given[1].first_sample) << "the same id";
  EXPECT_EQ(given[0].shade, 0);
}

TEST_F(BoundHairGrowth, IsTheArtistsHairAtRestOnRealGrooms) {
  const std::filesystem::path data = dataFolder();
  if (!std::filesystem::is_directory(data)) GTEST_SKIP() << "no real data at " << data;
  std::vector<std::filesystem::path> tail;
  for (const char* part : {"tail", "side", "front_top", "back"})
    tail.push_back(data / "ponytail" / (std::string(part) + ".tfx"));
  for (const auto& files : {tail, {data / "sintel" / "sintel_hair_16pts.tfx"}}) {
    const Groom groom = loadGroom(files, {files.size() > 1 ? 0.0025f : 1.0f, UpAxis::kAuto});
    const StrandSet guides = subset(groom.strands, chooseGuides(groom.strands, groom.strands.strands() / 20));
    Bound bound(guides, groom.strands);
    EXPECT_LT(bound.worstAtRest(), 1e-6) << files[0];
    EXPECT_LT(bound.worst(bent(guides, {}), {}), 4e-6) << files[0];
  }
}

TEST(HairGrowthOfSeeds, LeavesOutGuidesThatOnlyCarryBoundHairs) {
  const GroomDescription groom = verticalBundle(6, 6, 0.01f, 0.1f, 0.2f, 4);
  std::vector<uint8_t> seeded(36, 1);
  std::fill(seeded.begin(), seeded.begin() + 18, 0);
  const std::vector<Hair> hairs = growHairs(groom.guides, {.hairs = 500}, seeded);
  EXPECT_EQ(hairs.size(), 500u);
  for (const Hair& hair : hairs)
    for (const uint32_t guide : hair.guides) EXPECT_GE(guide, 18u);
  std::fill(seeded.begin(), seeded.end(), 0);
  EXPECT_TRUE(growHairs(groom.guides, {.hairs = 500}, seeded).empty());
}

/// Every guide of a bundle as a bound hair, red, without hair from the seed.
class BoundPicture : public OffscreenTest {
 protected:
  BoundPicture() {
    settings_ = smallPicture();
    settings_.growth.hairs = 0;
    settings_.hair_color = Vec3(0.02f, 0.02f, 0.02f);
    settings_.hair_width = 1e-3f;
    hairs_.hairs = groom_.guides;
    hairs_.bindings = bindHairs(hairs_.hairs, groom_.guides);
    hairs_.colours.assign(groom_.guides.strands(), {200, 20, 10});
    camera_ = orbit(box(), 0.4f, 0.1f, 1);
  }
  Box box() const {
    Box box;
    for (const Vec3& p : groom_.guides.positions) box.extend(Eigen::Vector3f(p));
    return box;
  }
  /// Mean excess of red over blue, linear.
  double red(Renderer& renderer) {
    renderer.draw(restFrame(groom_), camera_);
    const Image image = renderer.read();
    double sum = 0;
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x)
        sum += std::max(linearValue(image, x, y, 0) - linearValue(image, x, y, 2), 0.0);
    return sum / (image.width * image.height);
  }

  GroomDescription groom_ = verticalBundle(8, 8, 0.01f, 0.1f, 0.2f, 6);
  HairDescription hairs_;
  RenderSettings settings_;
  Camera camera_;
};

TEST_F(BoundPicture, HasTheArtistsColoursOnEveryPath) {
  for (const GrowthPath path : {GrowthPath::kCompute, GrowthPath::kTessellator})
    for (const HairShading shading : {HairShading::kVertex, HairShading::kFragment}) {
      settings_.growth_path = path;
      settings_.shading = shading;
      Renderer renderer(settings_);
      renderer.setGroom(groom_);
      EXPECT_LT(red(renderer), 0.001);
      renderer.setHairs(hairs_);
      EXPECT_GT(red(renderer), 0.01);
      EXPECT_EQ(renderer.statistics().hairs_bound, 64u);
      EXPECT_EQ(renderer.statistics().hairs_drawn, 64u);
      renderer.setHairs({});
      EXPECT_LT(red(renderer), 0.001);
    }
}

TEST_F(BoundPicture, HasBothKindsOfHairAndForgetsBoundHairsWithTheGroom) {
  settings_.growth.hairs = 300;
  Renderer renderer(settings_);
  renderer.setGroom(groom_);
  const double without = red(renderer);
  renderer.setHairs(hairs_);
  EXPECT_GT(red(renderer), without + 0.005);
  EXPECT_EQ(renderer.statistics().hairs_grown, 364u);
  renderer.setGroom(groom_);
  EXPECT_EQ(red(renderer), without);
  EXPECT_EQ(renderer.statistics().hairs_bound, 0u);
  groom_.growth = GroomDescription::kHairs;
  renderer.setGroom(groom_);
  renderer.setHairs(hairs_);
  EXPECT_EQ(renderer.statistics().hairs_grown, 64u) << "none from the seed";
}

TEST_F(BoundPicture, RadiiCountInsteadOfTheWidthOfTheSettings) {
  Renderer renderer(settings_);
  renderer.setGroom(groom_);
  renderer.setHairs(hairs_);
  const double before = red(renderer);
  hairs_.hairs.radii.assign(hairs_.hairs.vertices(), 1e-3f);
  renderer.setHairs(hairs_);
  const double wide = red(renderer);
  EXPECT_GT(wide, 1.5 * before);
  settings_.hair_width = 1e-4f;
  renderer.setSettings(settings_);
  EXPECT_NEAR(red(renderer), wide, 0.02 * wide);
}

TEST_F(BoundPicture, RefusesHairsOfAnotherGroom) {
  Renderer renderer(settings_);
  renderer.setGroom(verticalBundle(2, 2, 0.01f, 0.1f, 0.2f, 6));
  EXPECT_THROW(renderer.setHairs(hairs_), Error);
}

}  // namespace
}  // namespace strandcast
