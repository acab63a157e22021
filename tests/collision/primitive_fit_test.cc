#include "collision/primitive_fit.h"

#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>

#include "core/error.h"
#include "io/mesh_file.h"
#include "tests/collision/shapes.h"
#include "tests/real_data.h"

namespace strandcast {
namespace {

struct Coverage {
  double deepest_poke = 0;      // m, how far a sphere protrudes from the mesh
  double within_5_percent = 0;  // share of the vertices nearer than 5 % of the mesh's diagonal to a sphere
  double median = 0;            // m, from a vertex to the nearest sphere
};

Coverage coverage(const TriangleMesh& mesh, const std::vector<ContactPrimitive>& spheres, size_t stride) {
  const MeshQuery query(mesh);
  Coverage out;
  // Depth of the points on the spheres that lie outside the mesh. Internal parts of a mesh do not count.
  for (const ContactPrimitive& sphere : spheres)
    for (int i = 0; i < 300; ++i) {
      const float y = 1 - (2 * static_cast<float>(i) + 1) / 300, ring = std::sqrt(1 - y * y);
      const Vec3 p = sphere.a + sphere.radius * Vec3(ring * std::cos(2.39996f * static_cast<float>(i)), y,
                                                     ring * std::sin(2.39996f * static_cast<float>(i)));
      if (std::fabs(query.windingNumber(p)) < 0.5f)
        out.deepest_poke = std::max<double>(out.deepest_poke, query.closest(p).distance);
    }
  std::vector<float> gaps;
  for (size_t i = 0; i < mesh.positions.size(); i += stride) {
    float gap = std::numeric_limits<float>::infinity();
    for (const ContactPrimitive& s : spheres)
      gap = std::min(gap, std::fabs((mesh.positions[i] - s.a).norm() - s.radius));
    gaps.push_back(gap);
  }
  std::sort(gaps.begin(), gaps.end());
  out.median = gaps[gaps.size() / 2];
  const auto near =
      std::upper_bound(gaps.begin(), gaps.end(), 0.05f * mesh.bounds().diagonal().norm()) - gaps.begin();
  out.within_5_percent = static_cast<double>(near) / static_cast<double>(gaps.size());
  return out;
}

TEST(FitSpheres, ASphereIsFittedByItself) {
  PrimitiveFitOptions options;
  options.max_primitives = 1;
  const auto fitted = fitSpheres(shapes::sphere(0.1f, 3, {0.3f, 0.2f, -0.1f}), options);
  ASSERT_EQ(fitted.size(), 1u);
  EXPECT_EQ(fitted[0].kind, PrimitiveKind::kSphere);
  EXPECT_NEAR(fitted[0].radius, 0.1f, 1e-3);  // facets
  EXPECT_NEAR((fitted[0].a - Vec3(0.3f, 0.2f, -0.1f)).norm(), 0, 1e-3);
}

TEST(FitSpheres, StaysInsideAndCoversAPotato) {
  const TriangleMesh mesh = shapes::potato(0.1f, 4);
  const auto fitted = fitSpheres(mesh, {});
  ASSERT_LE(fitted.size(), 24u);
  const Coverage result = coverage(mesh, fitted, 1);
  EXPECT_LT(result.deepest_poke, 1e-4);
  EXPECT_LT(result.median, 0.004);
  EXPECT_GT(result.within_5_percent, 0.97);
}

TEST(FitSpheres, KeepsTheSkin) {
  PrimitiveFitOptions options;
  options.skin = 0.004f;
  const TriangleMesh mesh = shapes::potato(0.1f, 3);
  const MeshQuery query(mesh);
  for (const ContactPrimitive& sphere : fitSpheres(mesh, options))
    EXPECT_LT(sphere.radius + query.signedDistance(sphere.a), -0.0039f);
}

TEST(FitSpheres, MoreSpheresCoverMore) {
  const TriangleMesh mesh = shapes::potato(0.1f, 3);
  PrimitiveFitOptions few;
  few.max_primitives = 4;
  EXPECT_GT(coverage(mesh, fitSpheres(mesh, few), 1).median, coverage(mesh, fitSpheres(mesh, {}), 1).median);
}

TEST(FitSpheres, SameMeshGivesTheSameSpheres) {
  const TriangleMesh mesh = shapes::potato(0.1f, 3);
  const auto once = fitSpheres(mesh, {}), again = fitSpheres(mesh, {});
  ASSERT_EQ(once.size(), again.size());
  for (size_t i = 0; i < once.size(); ++i) {
    EXPECT_EQ(once[i].a, again[i].a);
    EXPECT_EQ(once[i].radius, again[i].radius);
  }
}

TEST(FitSpheres, AMeshTurnedInsideOutIsFittedToo) {
  TriangleMesh mesh = shapes::sphere(0.1f, 3);
  for (auto& t : mesh.triangles) std::swap(t[0], t[1]);
  EXPECT_NEAR(fitSpheres(mesh, {}).at(0).radius, 0.1f, 2e-3);
}

TEST(FitSpheres, NothingThatFitsIsAnErrorThatNamesTheRadius) {
  TriangleMesh flat;
  flat.name = "flat";
  flat.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  flat.triangles = {{0, 1, 2}};
  try {
    fitSpheres(flat, {});
    FAIL() << "an open triangle holds no sphere";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("mesh flat"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("0.015"), std::string::npos);
  }
}

struct RealMesh {
  const char* file;
  float unit_meters;
  double share_within_5_percent;
  double median;
};

class FitRealMesh : public testing::TestWithParam<RealMesh> {};

TEST_P(FitRealMesh, StaysInsideAndCovers) {
  const RealMesh& given = GetParam();
  const auto file = dataFolder() / given.file;
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no " << file << " (set STRANDCAST_DATA)";
  GroomReadOptions read;
  read.unit_meters = given.unit_meters;
  const TriangleMesh mesh = loadMesh(file, read).mesh;
  const auto start = std::chrono::steady_clock::now();
  const auto fitted = fitSpheres(mesh, {});
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const Coverage result = coverage(mesh, fitted, 3);
  std::printf(
      "%s: %.2f m, %zu spheres, %.0f ms, poke %.3f mm, median gap %.2f mm, within 5 %% of the diagonal %.1f "
      "%%\n",
      given.file, static_cast<double>(mesh.bounds().diagonal().norm()), fitted.size(), 1e3 * seconds,
      1e3 * result.deepest_poke, 1e3 * result.median, 100 * result.within_5_percent);
  EXPECT_LE(fitted.size(), 24u);
  EXPECT_LT(result.deepest_poke, 5e-4);
  EXPECT_GT(result.within_5_percent, given.share_within_5_percent);
  EXPECT_LT(result.median, given.median);
}

INSTANTIATE_TEST_SUITE_P(Data, FitRealMesh,
                         testing::Values(RealMesh{"ponytail/ponytail_body.obj", 0.0025f, 0.9, 0.02},
                                         RealMesh{"sintel/sintel-collider.obj", 1.0f, 0.99, 0.005},
                                         RealMesh{"bear/bear_body.obj", 0.01f, 0.75, 0.1}));

}  // namespace
}  // namespace strandcast
