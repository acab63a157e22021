#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <map>

#include "collision/mesh_query.h"
#include "core/error.h"
#include "groom/procedural_body.h"
#include "groom/procedural_groom.h"

namespace strandcast {
namespace {

const ProceduralBody& body() {
  static const ProceduralBody made = makeProceduralBody();
  return made;
}

TEST(ProceduralBody, IsWatertightAtEveryCell) {
  for (float cell : {0.0025f, 0.004f, 0.0067f, 0.01f}) {
    const ProceduralBody made = makeProceduralBody(cell);
    std::map<std::pair<uint32_t, uint32_t>, int> directed;
    for (const auto& t : made.mesh.triangles)
      for (int k = 0; k < 3; ++k) ++directed[{t[k], t[(k + 1) % 3]}];
    size_t open = 0;
    for (const auto& [edge, count] : directed)
      if (count != 1 || directed.count({edge.second, edge.first}) == 0) ++open;
    EXPECT_EQ(open, 0u) << cell;
  }
}

TEST(ProceduralBody, IsTurnedOutwardAndOfHumanSize) {
  const TriangleMesh& mesh = body().mesh;
  double volume = 0;
  for (const auto& t : mesh.triangles)
    volume +=
        static_cast<double>(mesh.positions[t[0]].dot(mesh.positions[t[1]].cross(mesh.positions[t[2]]))) / 6;
  EXPECT_GT(volume, 0.01);  // m^3, a head alone is about 0.004
  EXPECT_LT(volume, 0.03);
  const Box box = mesh.bounds();
  EXPECT_NEAR(box.sizes().x(), 0.42f, 0.01f);
  EXPECT_NEAR(box.max().y(), 0.10f, 0.005f);
  float wide = 0, back = 0, front = 0, chin = 0;
  for (const Vec3& p : mesh.positions) {
    if (p.y() > 0.015f) wide = std::max(wide, p.x());
    if (p.y() > 0) back = std::min(back, p.z());
    if (p.y() > 0.015f) front = std::max(front, p.z());
    if (p.z() > 0.07f && p.y() > -0.16f) chin = std::min(chin, p.y());
  }
  EXPECT_NEAR(2 * wide, 0.155f, 0.006f);
  EXPECT_NEAR(front - back, 0.195f, 0.01f);
  EXPECT_NEAR(0.1f - chin, 0.23f, 0.006f);
}

TEST(ProceduralBody, LiesOnItsFieldWithItsNormals) {
  const TriangleMesh& mesh = body().mesh;
  ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
  TriangleMesh faceted = mesh;
  computeNormals(faceted);
  size_t averted = 0;
  for (size_t i = 0; i < mesh.positions.size(); ++i) {
    ASSERT_NEAR(bodyDistance(mesh.positions[i]), 0, 5e-5);
    ASSERT_NEAR(mesh.normals[i].norm(), 1, 1e-4);
    averted += mesh.normals[i].dot(faceted.normals[i]) < 0.5f;
  }
  EXPECT_LT(averted, mesh.positions.size() / 500);  // creases of the mouth and the eyelids
}

TEST(ProceduralBody, HeadTrianglesComeFirstAndWeightsFadeThroughTheNeck) {
  const ProceduralBody& made = body();
  ASSERT_EQ(made.head_weight.size(), made.mesh.positions.size());
  ASSERT_GT(made.first_static_triangle, 0u);
  ASSERT_LT(made.first_static_triangle, made.mesh.triangles.size());
  for (size_t t = 0; t < made.mesh.triangles.size(); ++t) {
    float most = 0;
    for (uint32_t v : made.mesh.triangles[t]) most = std::max(most, made.head_weight[v]);
    ASSERT_EQ(most == 0, t >= made.first_static_triangle);
  }
  for (size_t i = 0; i < made.mesh.positions.size(); ++i) {
    const Vec3& p = made.mesh.positions[i];
    if (p.y() > -0.04f || (p.z() > 0.07f && p.y() > -0.135f && p.y() < 0)) {
      ASSERT_GT(made.head_weight[i], 0.99f) << p.transpose();
    }
    if (p.y() < -0.24f && p.z() < 0) {
      ASSERT_EQ(made.head_weight[i], 0) << p.transpose();
    }
  }
  EXPECT_LT(bodyDistance(made.neck_pivot), -0.03f);
}

float gapTo(const ContactPrimitive& primitive, const Vec3& p) {
  const Vec3 axis = primitive.b - primitive.a;
  const float t = primitive.kind == PrimitiveKind::kCapsule
                      ? std::clamp((p - primitive.a).dot(axis) / axis.squaredNorm(), 0.0f, 1.0f)
                      : 0.0f;
  return (p - primitive.a - t * axis).norm() - primitive.radius;
}

TEST(ProceduralBody, PrimitivesStayInsideTheSkinAndHugIt) {
  const ProceduralBody& made = body();
  std::vector<ContactPrimitive> all = made.head;
  all.insert(all.end(), made.shoulders.begin(), made.shoulders.end());
  EXPECT_LE(all.size(), 24u);
  std::vector<float> scalp, elsewhere;
  float poke = 0;
  for (const Vec3& p : made.mesh.positions) {
    float gap = 1;
    for (const ContactPrimitive& primitive : all) gap = std::min(gap, gapTo(primitive, p));
    poke = std::max(poke, -gap);
    const bool ear = std::fabs(p.x()) > 0.066f && p.y() < 0.012f && p.y() > -0.058f;
    const bool nose = std::fabs(p.x()) < 0.022f && p.z() > 0.085f && p.y() < 0;
    if (scalpDensity(p) > 0.05f)
      scalp.push_back(gap);
    else if (p.y() > -0.31f && !ear && !nose)
      elsewhere.push_back(gap);
  }
  std::sort(scalp.begin(), scalp.end());
  std::sort(elsewhere.begin(), elsewhere.end());
  const auto share = [](const std::vector<float>& gaps, double part) {
    return gaps[static_cast<size_t>(part * static_cast<double>(gaps.size() - 1))];
  };
  std::printf("poke %.2f mm; scalp p50 %.2f p99 %.2f max %.2f mm; elsewhere p50 %.2f p90 %.2f p99 %.2f mm\n",
              1e3 * poke, 1e3 * share(scalp, 0.5), 1e3 * share(scalp, 0.99), 1e3 * scalp.back(),
              1e3 * share(elsewhere, 0.5), 1e3 * share(elsewhere, 0.9), 1e3 * share(elsewhere, 0.99));
  EXPECT_LT(poke, 5e-4f);
  EXPECT_LT(share(scalp, 0.99), 2e-3f);
  EXPECT_LT(share(scalp, 0.995), 3e-3f);
  EXPECT_LT(scalp.back(), 5e-3f);  // the crease behind the ear
  EXPECT_LT(share(elsewhere, 0.5), 4e-3f);
  EXPECT_LT(share(elsewhere, 0.9), 8e-3f);
  EXPECT_LT(share(elsewhere, 0.99), 15e-3f);
}

TEST(ProceduralBody, HairGrowsOnTheScalpOnly) {
  EXPECT_NEAR(scalpDensity({0, 0.1f, 0}), 1, 1e-3);
  EXPECT_NEAR(scalpDensity({0, 0, -0.1f}), 1, 1e-3);
  EXPECT_NEAR(scalpDensity({0, 0, 0.1f}), 0, 1e-3);
  EXPECT_NEAR(scalpDensity({0.08f, -0.02f, -0.012f}), 0, 1e-3);
  EXPECT_NEAR(scalpDensity({0.05f, -0.15f, 0}), 0, 1e-3);
}

TEST(ProceduralBody, RefusesACellOutOfRange) {
  EXPECT_THROW(makeProceduralBody(0.0001f), Error);
  EXPECT_THROW(makeProceduralBody(std::numeric_limits<float>::quiet_NaN()), Error);
}

uint64_t hashOf(const StrandSet& strands) {
  uint64_t hash = 1469598103934665603u;
  const auto add = [&](const void* data, size_t bytes) {
    const auto* p = static_cast<const unsigned char*>(data);
    for (size_t i = 0; i < bytes; ++i) hash = (hash ^ p[i]) * 1099511628211u;
  };
  add(strands.positions.data(), strands.positions.size() * sizeof(Vec3));
  add(strands.pinned.data(), strands.pinned.size());
  add(strands.uvs.data(), strands.uvs.size() * sizeof(Vec2));
  return hash;
}

class Styles : public testing::TestWithParam<HairStyle> {
 protected:
  ProceduralGroomOptions options() const {
    ProceduralGroomOptions out;
    out.style = GetParam();
    out.strands = 800;
    return out;
  }
};

TEST_P(Styles, StrandsHaveEqualEdgesAndStayOutOfTheSkin) {
  for (int vertices : {2, 16, 24, 100}) {
    ProceduralGroomOptions given = options();
    given.vertices = vertices;
    given.strands = vertices == 24 ? 2000 : 500;
    const StrandSet strands = makeProceduralGroom(given).strands;
    ASSERT_EQ(strands.strands(), static_cast<size_t>(given.strands));
    ASSERT_EQ(strands.uvs.size(), strands.strands());
    ASSERT_EQ(strands.pinned.size(), strands.vertices());
    for (size_t s = 0; s < strands.strands(); ++s) {
      const auto points = strands.strand(s);
      ASSERT_EQ(points.size(), static_cast<size_t>(vertices));
      ASSERT_NEAR(bodyDistance(points[0]), 0, 5e-5);
      const float edge = (points[1] - points[0]).norm();
      ASSERT_GT(edge, 0.001f);
      for (size_t i = 0; i < points.size(); ++i) {
        ASSERT_TRUE(points[i].allFinite());
        ASSERT_GT(bodyDistance(points[i]), -2e-4f) << "strand " << s << " vertex " << i << " of " << vertices;
        if (i > 0) {
          ASSERT_NEAR((points[i] - points[i - 1]).norm() / edge, 1, 1e-3);
        }
      }
      // Long first edges bend with the scalp; short ones show the root's own direction.
      if (vertices == 100) {
        ASSERT_GT((points[1] - points[0]).dot(bodyNormal(points[0])) / edge, 0.1f) << s;
      }
      const Vec2& uv = strands.uvs[s];
      ASSERT_TRUE(uv.x() >= 0 && uv.x() <= 1 && uv.y() >= 0 && uv.y() <= 1);
    }
  }
}

TEST_P(Styles, LengthIsKept) {
  ProceduralGroomOptions given = options();
  if (given.style == HairStyle::kPonytail) GTEST_SKIP() << "a ponytail's length counts from its tie";
  given.length = 0.2f;
  const StrandSet strands = makeProceduralGroom(given).strands;
  for (size_t s = 0; s < strands.strands(); ++s) {
    EXPECT_GT(arcLength(strands.strand(s)), 0.179f);
    EXPECT_LT(arcLength(strands.strand(s)), 0.201f);
  }
}

TEST_P(Styles, SameOptionsGiveTheSameBitsAndAnotherSeedOthers) {
  ProceduralGroomOptions given = options();
  const uint64_t once = hashOf(makeProceduralGroom(given).strands);
  EXPECT_EQ(once, hashOf(makeProceduralGroom(given).strands));
  given.seed = 2;
  EXPECT_NE(once, hashOf(makeProceduralGroom(given).strands));
}

TEST_P(Styles, NoHairCrossesTheFace) {
  const StrandSet strands = makeProceduralGroom(options()).strands;
  for (const Vec3& p : strands.positions)
    EXPECT_FALSE(p.z() > 0.05f && p.y() < 0.035f && p.y() > -0.15f && std::fabs(p.x()) < 0.055f)
        << p.transpose();
}

TEST_P(Styles, TheScalpIsCoveredEvenly) {
  const StrandSet strands = makeProceduralGroom(options()).strands;
  // 800 roots on about 0.06 m^2: no point of the full scalp is farther than 2 spacings from a root.
  for (size_t v = 0; v < body().mesh.positions.size(); v += 5) {
    const Vec3& p = body().mesh.positions[v];
    if (scalpDensity(p) < 0.99f) continue;
    float nearest = 1;
    for (size_t s = 0; s < strands.strands(); ++s)
      nearest = std::min(nearest, (strands.strand(s)[0] - p).norm());
    ASSERT_LT(nearest, 0.018f) << p.transpose();
  }
}

INSTANTIATE_TEST_SUITE_P(All, Styles,
                         testing::Values(HairStyle::kStraight, HairStyle::kWavy, HairStyle::kCurly,
                                         HairStyle::kPonytail));

TEST(ProceduralGroom, APonytailIsPinnedAtItsTieOnly) {
  ProceduralGroomOptions given;
  given.style = HairStyle::kPonytail;
  const StrandSet strands = makeProceduralGroom(given).strands;
  const Vec3 tie(0, 0.022f, -0.122f);
  for (size_t s = 0; s < strands.strands(); ++s) {
    const auto points = strands.strand(s);
    int pins = 0;
    for (size_t i = 1; i < points.size(); ++i) {
      if (!strands.isPinned(s, i)) continue;
      ++pins;
      EXPECT_LT((points[i] - tie).norm(), 0.05f) << s << " " << i;
    }
    EXPECT_GE(pins, 1) << s;
    EXPECT_LE(pins, 2) << s;
    EXPECT_FALSE(strands.isPinned(s, points.size() - 1)) << s;
  }
  given.style = HairStyle::kWavy;
  const StrandSet wavy = makeProceduralGroom(given).strands;
  EXPECT_EQ(std::count(wavy.pinned.begin(), wavy.pinned.end(), 1), 2000);
}

TEST(ProceduralGroom, RefusesOptionsOutOfRange) {
  ProceduralGroomOptions given;
  given.strands = 0;
  EXPECT_THROW(makeProceduralGroom(given), Error);
  given = {};
  given.vertices = 129;
  EXPECT_THROW(makeProceduralGroom(given), Error);
  given = {};
  given.length = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(makeProceduralGroom(given), Error);
}

}  // namespace
}  // namespace strandcast
