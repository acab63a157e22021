#include "collision/mesh_query.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/collision/shapes.h"
#include "tests/expect_error.h"

namespace strandcast {
namespace {

using shapes::potato;
using shapes::randomPoint;
using shapes::sphere;
using Point = Eigen::Vector3d;

double edgeDistance(const Point& p, const Point& a, const Point& b) {
  const double squared = (b - a).squaredNorm();
  const double t = squared > 0 ? std::clamp((p - a).dot(b - a) / squared, 0.0, 1.0) : 0;
  return (p - a - t * (b - a)).norm();
}

// A method other than the product's: the distance to the plane if the foot point is inside all three edges,
// else the distance to the edges.
double triangleDistance(const Point& p, const Point& a, const Point& b, const Point& c) {
  double best = std::min({edgeDistance(p, a, b), edgeDistance(p, b, c), edgeDistance(p, c, a)});
  const Point normal = (b - a).cross(c - a);
  if (normal.norm() < 1e-15) return best;
  const Point n = normal.normalized();
  const bool above = (b - a).cross(p - a).dot(n) >= 0 && (c - b).cross(p - b).dot(n) >= 0 &&
                     (a - c).cross(p - c).dot(n) >= 0;
  return above ? std::min(best, std::fabs((p - a).dot(n))) : best;
}

double bruteDistance(const TriangleMesh& mesh, const Vec3& point) {
  double best = std::numeric_limits<double>::infinity();
  for (const auto& t : mesh.triangles)
    best = std::min(
        best, triangleDistance(point.cast<double>(), mesh.positions[t[0]].cast<double>(),
                               mesh.positions[t[1]].cast<double>(), mesh.positions[t[2]].cast<double>()));
  return best;
}

double bruteWinding(const TriangleMesh& mesh, const Vec3& point) {
  double sum = 0;
  for (const auto& t : mesh.triangles) {
    const Point a = (mesh.positions[t[0]] - point).cast<double>(),
                b = (mesh.positions[t[1]] - point).cast<double>(),
                c = (mesh.positions[t[2]] - point).cast<double>();
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    sum += 2 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return sum / (4 * std::numbers::pi);
}

void expectSamePlaces(const TriangleMesh& mesh, float reach, int queries) {
  const MeshQuery query(mesh);
  std::mt19937 random(11);
  for (int i = 0; i < queries; ++i) {
    const Vec3 p = randomPoint(random, reach);
    const MeshPoint found = query.closest(p);
    ASSERT_NEAR(found.distance, bruteDistance(mesh, p), 1e-5) << p.transpose();
    ASSERT_NEAR((found.position - p).norm(), found.distance, 1e-5);
    ASSERT_LT(found.triangle, mesh.triangles.size());
    ASSERT_NEAR(found.barycentric.sum(), 1, 1e-5);
    ASSERT_GE(found.barycentric.minCoeff(), -1e-5);
    Vec3 placed = Vec3::Zero();
    for (int c = 0; c < 3; ++c)
      placed += found.barycentric[c] * mesh.positions[mesh.triangles[found.triangle][c]];
    ASSERT_NEAR((placed - found.position).norm(), 0, 1e-5);
  }
}

TEST(MeshQuery, ClosestPointsEqualBruteForce) { expectSamePlaces(potato(0.1f, 4), 0.2f, 500); }

TEST(MeshQuery, ClosestPointsOnOneTriangle) {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {0.3f, 0, 0}, {0, 0.2f, 0.1f}};
  mesh.triangles = {{0, 1, 2}};
  expectSamePlaces(mesh, 0.5f, 500);
}

TEST(MeshQuery, OpenMeshesDuplicateVerticesAndDegenerateTrianglesAreTaken) {
  TriangleMesh mesh = potato(0.1f, 3);
  mesh.triangles.resize(mesh.triangles.size() / 2);
  TriangleMesh soup;
  for (const auto& t : mesh.triangles) {
    const uint32_t first = static_cast<uint32_t>(soup.positions.size());
    for (uint32_t v : t) soup.positions.push_back(mesh.positions[v]);
    soup.triangles.push_back({first, first + 1, first + 2});
    soup.triangles.push_back({first, first, first});
    soup.triangles.push_back({first, first + 1, first});
  }
  expectSamePlaces(soup, 0.2f, 300);
  const MeshQuery query(soup);
  std::mt19937 random(5);
  for (int i = 0; i < 300; ++i) {
    const Vec3 p = randomPoint(random, 0.2f);
    ASSERT_NEAR(query.windingNumber(p), bruteWinding(soup, p), 1e-3);
  }
  // Vertices themselves are valid query points.
  for (size_t i = 0; i < soup.positions.size(); i += 50) {
    EXPECT_NEAR(query.closest(soup.positions[i]).distance, 0, 1e-6);
    EXPECT_TRUE(std::isfinite(query.windingNumber(soup.positions[i])));
  }
}

TEST(MeshQuery, ManyTrianglesInOnePlaceAreTaken) {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {0.1f, 0, 0}, {0, 0.1f, 0}};
  mesh.triangles.assign(5000, {0, 1, 2});
  EXPECT_NEAR(MeshQuery(mesh).closest({0.01f, 0.01f, 0.5f}).distance, 0.5f, 1e-6);
}

TEST(MeshQuery, WindingNumberEqualsBruteForce) {
  const TriangleMesh mesh = potato(0.1f, 4);
  const MeshQuery query(mesh);
  std::mt19937 random(3);
  double worst = 0;
  for (int i = 0; i < 1000; ++i) {
    const Vec3 p = randomPoint(random, i % 2 ? 0.15f : 0.5f);
    worst = std::max(worst, std::fabs(query.windingNumber(p) - bruteWinding(mesh, p)));
  }
  EXPECT_LT(worst, 1e-3);
  RecordProperty("worst", std::to_string(worst));
}

TEST(MeshQuery, WindingNumberIsOneInsideAndZeroOutsideAClosedMesh) {
  const MeshQuery query(sphere(0.1f, 4));
  EXPECT_NEAR(query.windingNumber({0, 0, 0}), 1, 1e-3);
  EXPECT_NEAR(query.windingNumber({0.05f, 0.02f, -0.06f}), 1, 1e-3);
  EXPECT_NEAR(query.windingNumber({0.11f, 0, 0}), 0, 1e-3);
  EXPECT_NEAR(query.windingNumber({3, 2, 1}), 0, 1e-3);
}

TEST(MeshQuery, SignedDistanceOfASphere) {
  const MeshQuery query(sphere(0.1f, 5));
  std::mt19937 random(9);
  for (int i = 0; i < 500; ++i) {
    const Vec3 p = randomPoint(random, 0.2f);
    EXPECT_NEAR(query.signedDistance(p), p.norm() - 0.1f, 2e-4)
        << p.transpose();  // 2e-4: chords of the facets
  }
}

TEST(MeshQuery, RefusesBadMeshesAndSaysWhy) {
  TriangleMesh mesh;
  mesh.name = "ball";
  EXPECT_NE(errorOf([&] { MeshQuery query(mesh); }).find("no triangles: mesh ball"), std::string::npos);
  mesh = sphere(1, 0);
  mesh.triangles[3][1] = 12;
  EXPECT_NE(errorOf([&] { MeshQuery query(mesh); }).find("triangle 3, vertex 12 of 12"), std::string::npos);
  mesh = sphere(1, 0);
  mesh.positions[7].y() = std::numeric_limits<float>::quiet_NaN();
  EXPECT_NE(errorOf([&] { MeshQuery query(mesh); }).find("vertex 7"), std::string::npos);
}

}  // namespace
}  // namespace strandcast
