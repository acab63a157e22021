// Triangulation of polygons: the surface does not depend on the corner with which a file begins.
#include "io/polygon.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace strandcast {
namespace {

using Triangles = std::vector<PolygonCutter::Triangle>;
using Points = std::vector<Vec3>;

struct Shape {
  const char* name;
  Points points;  ///< in the plane z = 0, counter-clockwise
};

std::vector<uint32_t> ringFrom(size_t count, size_t first) {
  std::vector<uint32_t> ring(count);
  std::iota(ring.begin(), ring.end(), 0u);
  std::rotate(ring.begin(), ring.begin() + static_cast<std::ptrdiff_t>(first), ring.end());
  return ring;
}

Points star(int rays, float inner) {
  Points points;
  for (int i = 0; i < 2 * rays; ++i) {
    const float turn = std::numbers::pi_v<float> * static_cast<float>(i) / static_cast<float>(rays);
    const float radius = i % 2 == 0 ? 1.0f : inner;
    points.emplace_back(radius * std::cos(turn), radius * std::sin(turn), 0);
  }
  return points;
}

Points spiral(int corners) {
  Points out, in;
  for (int i = 0; i < corners; ++i) {
    const float turn = 0.4f * static_cast<float>(i), radius = 1 + 0.1f * turn;
    out.emplace_back(radius * std::cos(turn), radius * std::sin(turn), 0);
    in.emplace_back((radius - 0.2f) * std::cos(turn), (radius - 0.2f) * std::sin(turn), 0);
  }
  out.insert(out.end(), in.rbegin(), in.rend());
  return out;
}

const std::vector<Shape>& flatShapes() {
  static const std::vector<Shape> shapes{
      {"U", {{3, 3, 0}, {2, 3, 0}, {2, -2, 0}, {-2, -2, 0}, {-2, 3, 0}, {-3, 3, 0}, {-3, -3, 0}, {3, -3, 0}}},
      {"L with corners on its edges",
       {{0, 0, 0},
        {1, 0, 0},
        {2, 0, 0},
        {2, 0.5f, 0},
        {2, 1, 0},
        {1, 1, 0},
        {1, 1.5f, 0},
        {1, 2, 0},
        {0, 2, 0},
        {0, 1, 0}}},
      {"comb",
       {{0, 0, 0},
        {7, 0, 0},
        {7, 3, 0},
        {6, 3, 0},
        {6, 1, 0},
        {5, 1, 0},
        {5, 3, 0},
        {4, 3, 0},
        {4, 1, 0},
        {3, 1, 0},
        {3, 3, 0},
        {2, 3, 0},
        {2, 1, 0},
        {1, 1, 0},
        {1, 3, 0},
        {0, 3, 0}}},
      {"star", star(5, 0.3f)},
      {"spiral", spiral(25)},
      {"square with a hole, over a bridge",
       {{0, 0, 0},
        {4, 0, 0},
        {4, 4, 0},
        {0, 4, 0},
        {0, 0, 0},
        {1, 1, 0},
        {1, 3, 0},
        {3, 3, 0},
        {3, 1, 0},
        {1, 1, 0}}},
      {"two squares that touch in a corner",
       {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {2, 1, 0}, {2, 2, 0}, {1, 2, 0}, {1, 1, 0}, {0, 1, 0}}},
      {"dart with two corners in one place", {{0, 0, 0}, {2, -1, 0}, {2, -1, 0}, {0, 2, 0}, {-2, -1, 0}}},
      {"square", {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}}};
  return shapes;
}

double signedArea(const Points& p) {
  double sum = 0;
  for (size_t i = 0; i < p.size(); ++i) {
    const Vec3 &a = p[i], &b = p[(i + 1) % p.size()];
    sum += static_cast<double>(a.x()) * static_cast<double>(b.y()) -
           static_cast<double>(a.y()) * static_cast<double>(b.x());
  }
  return sum / 2;
}

double twiceArea(const Points& p, const PolygonCutter::Triangle& t) {
  const Eigen::Vector3d a = p[t[0]].cast<double>(), b = p[t[1]].cast<double>(), c = p[t[2]].cast<double>();
  return (b - a).cross(c - a).norm();
}

double area(const Points& p, const Triangles& triangles) {
  double sum = 0;
  for (const auto& t : triangles) sum += twiceArea(p, t) / 2;
  return sum;
}

/// The triangles as sets of positions, in a canonical order.
std::vector<Points> placesOf(const Points& p, const Triangles& triangles) {
  const auto isLess = [](const Vec3& a, const Vec3& b) {
    return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
  };
  std::vector<Points> out;
  for (const auto& t : triangles) {
    Points corners{p[t[0]], p[t[1]], p[t[2]]};
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end(), isLess), corners.end());
    out.push_back(corners);
  }
  std::sort(out.begin(), out.end(), [&](const Points& a, const Points& b) {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end(), isLess);
  });
  return out;
}

TEST(Polygons, FlatOnesAreCoveredOnceFromEveryStartCorner) {
  for (const Shape& shape : flatShapes())
    for (const bool reversed : {false, true})
      for (size_t first = 0; first < shape.points.size(); ++first) {
        std::vector<uint32_t> ring = ringFrom(shape.points.size(), first);
        if (reversed) std::reverse(ring.begin(), ring.end());
        Triangles triangles;
        EXPECT_TRUE(PolygonCutter(shape.points).cut(ring, triangles)) << shape.name << " from " << first;
        EXPECT_LE(triangles.size(), ring.size() - 2);
        // No triangle is reversed and the areas add up: none overlaps another or leaves the shape.
        EXPECT_NEAR(area(shape.points, triangles), signedArea(shape.points), 1e-6)
            << shape.name << " from " << first;
        for (const auto& t : triangles) {
          const Points corners{shape.points[t[0]], shape.points[t[1]], shape.points[t[2]]};
          EXPECT_GE((reversed ? -1 : 1) * signedArea(corners), -1e-9) << shape.name << " from " << first;
        }
      }
}

TEST(Polygons, TurnedOnesAreCoveredLikeThoseInAPlaneOfTheAxes) {
  const Quat turn(Eigen::AngleAxisf(1.1f, Eigen::Vector3f(1, 2, 3).normalized()));
  for (const Shape& shape : flatShapes()) {
    Points points = shape.points;
    for (Vec3& p : points) p = Vec3(0.01f * (turn * p) + Vec3(0.5f, -0.3f, 0.2f));
    for (size_t first = 0; first < points.size(); ++first) {
      Triangles triangles;
      EXPECT_TRUE(PolygonCutter(points).cut(ringFrom(points.size(), first), triangles)) << shape.name;
      EXPECT_NEAR(area(points, triangles), 1e-4 * signedArea(shape.points), 1e-7) << shape.name << first;
    }
  }
}

TEST(Polygons, UnevenOnesHaveTheSameTrianglesFromEveryStartCorner) {
  std::vector<Shape> shapes = flatShapes();
  shapes.push_back({"saddle", {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}});
  shapes.push_back({"hexagon", star(3, 1)});
  for (Shape& shape : shapes) {
    for (size_t i = 0; i < shape.points.size(); ++i)  // coincident corners stay coincident
      shape.points[i].z() = 0.05f * std::sin(3.7f * shape.points[i].x() + 1.3f * shape.points[i].y());
    Triangles first;
    EXPECT_TRUE(PolygonCutter(shape.points).cut(ringFrom(shape.points.size(), 0), first)) << shape.name;
    for (size_t from = 1; from < shape.points.size(); ++from) {
      Triangles triangles;
      PolygonCutter(shape.points).cut(ringFrom(shape.points.size(), from), triangles);
      EXPECT_EQ(placesOf(shape.points, triangles), placesOf(shape.points, first))
          << shape.name << " from " << from;
    }
  }
}

TEST(Polygons, ConvexOnesAreFannedFromTheirFirstCorner) {
  const Points hexagon = star(3, 1);
  Triangles triangles;
  PolygonCutter(hexagon).cut(ringFrom(6, 2), triangles);
  EXPECT_EQ(triangles, (Triangles{{2, 3, 4}, {2, 4, 5}, {2, 5, 0}, {2, 0, 1}}));
}

TEST(Polygons, RepeatedCornersAreNoCorners) {
  const Points square{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  Triangles triangles;
  EXPECT_TRUE(PolygonCutter(square).cut(std::vector<uint32_t>{0, 0, 1, 2, 2, 2, 3, 0}, triangles));
  EXPECT_EQ(triangles, (Triangles{{0, 1, 2}, {0, 2, 3}}));
  triangles.clear();
  EXPECT_FALSE(PolygonCutter(square).cut(std::vector<uint32_t>{0, 1, 1, 0}, triangles));
  EXPECT_TRUE(triangles.empty());
}

TEST(Polygons, OnesThatCrossThemselvesOrHaveNoAreaAreReported) {
  Points pentagram;
  for (int i = 0; i < 5; ++i) {
    const float turn = 0.8f * std::numbers::pi_v<float> * static_cast<float>(i);
    pentagram.emplace_back(std::cos(turn), std::sin(turn), 0);
  }
  for (const Points& points : {pentagram, Points{{0, 0, 0}, {2, 1, 0}, {2, 0, 0}, {0, 2, 0}},
                               Points{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}}, Points(4, Vec3(1, 1, 1))})
    for (size_t first = 0; first < points.size(); ++first) {
      Triangles triangles;
      EXPECT_FALSE(PolygonCutter(points).cut(ringFrom(points.size(), first), triangles)) << points.size();
      EXPECT_EQ(triangles.size(), points.size() - 2) << "what there is, is kept";
    }
}

TEST(Polygons, ManyCornersAreCutAndTooManyEndIt) {
  const Points points = star(400, 0.9f);
  Triangles triangles;
  PolygonCutter cutter(points);
  EXPECT_TRUE(cutter.cut(ringFrom(points.size(), 0), triangles));
  EXPECT_EQ(triangles.size(), points.size() - 2);
  EXPECT_NEAR(area(points, triangles), signedArea(points), 1e-6);
  EXPECT_FALSE(cutter.isSpent());
  PolygonCutter hasty(points, 10000);
  hasty.cut(ringFrom(points.size(), 0), triangles);
  EXPECT_TRUE(hasty.isSpent());
}

}  // namespace
}  // namespace strandcast
