// Large bodies. The real one is used if available: in STRANDCAST_DATA, or in a folder shared/data beside the
// project.
#include <gtest/gtest.h>

#include <chrono>

#include "collision/field_bake.h"
#include "core/error.h"
#include "io/mesh_file.h"
#include "tests/collision/shapes.h"
#include "tests/real_data.h"

namespace strandcast {
namespace {

TEST(LargeFields, ThePonytailBodyAtTwoMillimetresIsSmallAndRight) {
  const std::filesystem::path file = dataFolder() / "ponytail" / "ponytail_body.obj";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no " << file << "; set STRANDCAST_DATA";
  FieldOptions options;
  options.cell = 0.002f;
  FieldBaker baker(loadMesh(file, {0.0025f, UpAxis::kAuto}).mesh, options);
  const DistanceField field = baker.bake();
  EXPECT_LE(field.bytes(), 64'000'000u);
  EXPECT_GT(field.storedBricks(), 1000u);
  const FieldAccuracy accuracy = baker.measure(field, 10000);
  EXPECT_EQ(accuracy.points, 10000u);
  EXPECT_EQ(accuracy.wrong_side, 0u);
  EXPECT_LT(accuracy.worst, options.cell);
  EXPECT_LT(accuracy.rms, 0.1f * options.cell);
  EXPECT_LT(accuracy.median_angle, 1);
  EXPECT_LT(field.at({0, 0.2f, 0}).distance, -field.grid.band) << "in the head";
  EXPECT_LT(field.at({0, -0.05f, 0}).distance, -field.grid.band) << "in the chest, over an open bottom";
  EXPECT_GT(field.at({0, -0.15f, 0}).distance, 0) << "under it";
}

TEST(LargeFields, TwoMillionTrianglesAreEstimatedOrRefusedAsTheLimitSays) {
  const TriangleMesh mesh = shapes::globe(0.3f, 1000, 1000);
  ASSERT_EQ(mesh.triangles.size(), 2000000u);
  FieldOptions options;
  options.cell = 0.002f;
  BakeLimits limits;
  limits.memory_bytes = size_t{256} << 20;
  const auto start = std::chrono::steady_clock::now();
  try {
    const FieldBaker refused(mesh, options, limits);
    FAIL() << "nothing was thrown";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("2000000 triangles"), std::string::npos) << error.what();
  }
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(5));
  const FieldBaker baker(mesh, options);
  EXPECT_LT(baker.estimate().field_bytes, size_t{64} << 20);
  EXPECT_LT(baker.estimate().working_bytes, size_t{2} << 30);
  EXPECT_GT(baker.estimate().seconds, 0);
}

}  // namespace
}  // namespace strandcast
