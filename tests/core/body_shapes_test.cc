// Compares signed distances to bodies with their definition. The signed distance from p to a convex body is
// the maximum over unit directions n of n.p - h(n), with the support function h(n) = maximum of n.x over the
// body.
#include <gtest/gtest.h>

#include <functional>
#include <numbers>
#include <random>

#include "core/contact_primitive.h"
#include "core/error.h"
#include "kernels/scalar_strands.h"
#include "tests/collision/shapes.h"
#include "tests/conformance/conformance_model.h"

namespace strandcast {
namespace {

namespace k = kernels::f64;
using Vector = Eigen::Vector3d;
using Support = std::function<double(const Vector&)>;

k::real3 lanes(const Vector& v) { return {v.x(), v.y(), v.z()}; }
Vector vector(const k::real3& v) { return {v.x, v.y, v.z}; }

// Signed distance by search: the maximum over 4000 directions spread over the sphere, then refined by random
// changes of decreasing size. Never above the true distance; slightly below it where the maximum is a ridge.
double bruteForce(const Vector& p, const Support& support, std::mt19937& random) {
  double best = -1e9;
  Vector direction = Vector::UnitY();
  const auto consider = [&](const Vector& n) {
    const double distance = n.dot(p) - support(n);
    if (distance > best) best = distance, direction = n;
  };
  for (int i = 0; i < 4000; ++i) {
    const double y = 1 - (2 * i + 1) / 4000.0, ring = std::sqrt(1 - y * y), turn = 2.39996322972865 * i;
    consider({ring * std::cos(turn), y, ring * std::sin(turn)});
  }
  std::normal_distribution<double> normal;
  for (double size = 0.05; size > 1e-8; size *= 0.8) {
    const Vector from = direction;
    for (int i = 0; i < 40; ++i)
      consider((from + size * Vector(normal(random), normal(random), normal(random))).normalized());
  }
  return best;
}

using Distance = std::function<double(const Vector&, Vector&)>;

/// At random points: the distance is that to the supporting plane across the normal, and no direction gives a
/// larger one.
void expectExact(const Distance& distance, const Support& support) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> range(-0.25, 0.25);
  int inside = 0;
  for (int i = 0; i < 100; ++i) {
    const Vector p = (i % 2 == 0 ? 1 : 0.3) * Vector(range(random), range(random), range(random));
    Vector normal;
    const double mine = distance(p, normal);
    const double truth = bruteForce(p, support, random);
    inside += truth < 0;
    EXPECT_NEAR(normal.norm(), 1, 1e-12);
    EXPECT_NEAR(normal.dot(p) - support(normal), mine, 1e-9) << p.transpose();
    EXPECT_LE(truth, mine + 1e-9) << p.transpose();
    EXPECT_GE(truth, mine - 1e-3) << p.transpose();
  }
  EXPECT_GT(inside, 1);
}

TEST(BodyShapes, TaperedCapsulesAreTheHullOfTwoBalls) {
  struct Case {
    Vector a, b;
    double radius, radius_b;
  };
  for (const Case& c :
       {Case{{-0.1, 0, 0}, {0.1, 0.05, 0}, 0.08, 0.03}, Case{{-0.1, 0, 0}, {0.1, 0.05, 0}, 0.02, 0.1},
        Case{{0, -0.1, 0}, {0, 0.1, 0}, 0.05, 0.05}, Case{{0, 0, 0}, {0, 0.05, 0}, 0.04, 0.12},
        Case{{0, 0, 0}, {0, 0.05, 0}, 0.12, 0.04}, Case{{0, 0, 0.01}, {0, 0, 0.01}, 0.06, 0.1}})
    expectExact(
        [&](const Vector& p, Vector& normal) {
          k::real3 n;
          double along = 0;
          const double d =
              k::taperedCapsuleDistance(lanes(p), lanes(c.a), lanes(c.b), c.radius, c.radius_b, n, along);
          EXPECT_TRUE(along >= 0 && along <= 1);
          normal = vector(n);
          return d;
        },
        [&](const Vector& n) { return std::max(n.dot(c.a) + c.radius, n.dot(c.b) + c.radius_b); });
  k::real3 n;
  double along = 0;
  EXPECT_NEAR(k::taperedCapsuleDistance({0, 0.01, 0}, {0, 0, 0}, {0, 0.02, 0}, 0.1, 0.01, n, along), -0.09,
              1e-12)
      << "on the axis, within the larger ball";
}

TEST(BodyShapes, BoxesAreExactInsideAndOut) {
  const Vector e(0.1, 0.05, 0.15);
  expectExact(
      [&](const Vector& p, Vector& normal) {
        k::real3 n;
        const double d = k::boxDistance(lanes(p), lanes(e), n);
        normal = vector(n);
        return d;
      },
      [&](const Vector& n) { return n.cwiseAbs().dot(e); });
}

TEST(BodyShapes, EllipsoidsAreExactInsideAndOut) {
  for (const Vector& e :
       {Vector(0.1, 0.05, 0.15), Vector(0.1, 0.1, 0.1), Vector(0.2, 0.01, 0.1), Vector(0.15, 0.15, 0.04)})
    expectExact(
        [&](const Vector& p, Vector& normal) {
          k::real3 n;
          const double d = k::ellipsoidDistance(lanes(p), lanes(e), n);
          normal = vector(n);
          return d;
        },
        [&](const Vector& n) { return n.cwiseProduct(e).norm(); });
}

TEST(BodyShapes, ConvexBodiesAreExactInsideAndBeforeTheirFaces) {
  ShapeData shapes;
  const MovingPrimitive wedge = furtherBody(3, 0.01f, shapes);
  const Eigen::Map<const Eigen::Matrix<float, 4, Eigen::Dynamic>> planes(
      reinterpret_cast<const float*>(shapes.words.data()), 4, wedge.extra);
  EXPECT_EQ(wedge.extra, 5u) << "eight triangles on five planes";
  std::mt19937 random(6);
  std::uniform_real_distribution<float> range(-0.2f, 0.2f);
  const Pose place{Vec3(wedge.a_end), Quat(wedge.rotation_end[3], wedge.rotation_end[0],
                                           wedge.rotation_end[1], wedge.rotation_end[2])};
  int inside = 0;
  for (int i = 0; i < 500; ++i) {
    const Vec3 p(range(random), range(random), range(random));
    const float truth = (planes.topRows<3>().transpose() * p - planes.row(3).transpose()).maxCoeff();
    inside += truth < 0;
    EXPECT_NEAR(signedDistance(wedge, place.apply(p), shapes.words), truth, 1e-6);
  }
  EXPECT_GT(inside, 10);
}

TEST(BodyShapes, ConvexBodiesAreRefusedWhereTheyAreNone) {
  TriangleMesh mesh;
  mesh.name = "dart";
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.1f, 0.1f, 0.1f}};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 4}, {2, 3, 4}, {3, 1, 4}};
  try {
    convexBody(mesh);
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("not convex"), std::string::npos) << error.what();
  }
  mesh.positions.resize(4);
  mesh.triangles = {{0, 2, 1}, {0, 1, 2}};
  EXPECT_THROW(convexBody(mesh), Error) << "flat";
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  TriangleMesh open = shapes::box(Vec3(1, 1, 1));
  EXPECT_EQ(convexBody(open).planes.size(), 6u);
  open.triangles.resize(open.triangles.size() - 2);
  EXPECT_THROW(convexBody(open), Error) << "open";
  EXPECT_EQ(convexBody(mesh).planes.size(), 4u);
}

TEST(BodyShapes, FieldsAreNearTheSurfaceWhatWasBakedAndNowhereFarther) {
  ShapeData shapes;
  const MovingPrimitive ring = furtherBody(4, 0.01f, shapes);
  const Pose place{Vec3(ring.a_end), Quat(ring.rotation_end[3], ring.rotation_end[0], ring.rotation_end[1],
                                          ring.rotation_end[2])};
  std::mt19937 random(7);
  std::uniform_real_distribution<float> range(-0.2f, 0.2f);
  int stored = 0, deep = 0;
  for (int i = 0; i < 5000; ++i) {
    const Vec3 p(range(random), 0.5f * range(random), range(random));  // relative to the centre of the ring
    const float truth = std::hypot(std::hypot(p.x(), p.z()) - 0.08f, p.y()) - 0.04f;
    const float mine = signedDistance(ring, place.apply(p), shapes.words);
    if (std::fabs(truth) < 0.012f) {
      EXPECT_NEAR(mine, truth, 4e-4) << "a part of a cell";
      ++stored;
    } else {
      EXPECT_EQ(std::signbit(mine), std::signbit(truth));
      EXPECT_LE(std::fabs(mine), std::fabs(truth) + 4e-4);
      deep += truth < 0;
    }
  }
  EXPECT_GT(stored, 300);
  EXPECT_GT(deep, 100);
}

// The bent surface is the set of points whose rest position lies on the ring. The bend changes by a third or
// more over 0.1 m.
TEST(BodyShapes, ABentFieldIsWhereItsBendTakesTheSurface) {
  ShapeData shapes;
  const MovingPrimitive body = furtherBody(kFurtherKinds - 1, 0.01f, shapes);
  const Pose place{Vec3(body.a_end), Quat(body.rotation_end[3], body.rotation_end[0], body.rotation_end[1],
                                          body.rotation_end[2])};
  const SurfaceBend bend = bendOfRing();
  const auto rest = [](const Vec3& p) { return std::hypot(std::hypot(p.x(), p.z()) - 0.08f, p.y()) - 0.04f; };
  const auto bentRing = [&](float around, float about) {  // radians
    const float out = 0.08f + 0.04f * std::cos(about);
    const Vec3 at_rest(out * std::cos(around), 0.04f * std::sin(about), out * std::sin(around));
    Vec3 p = at_rest;
    for (int step = 0; step < 30; ++step) p = at_rest - bend.shift(p);
    return p;
  };
  std::vector<Vec3> surface;
  for (int i = 0; i < 400; ++i)
    for (int k = 0; k < 200; ++k) {
      const float around = 0.01570796f * static_cast<float>(i), about = 0.0314159f * static_cast<float>(k);
      surface.push_back(bentRing(around, about));
      if (i % 13 != 0 || k % 7 != 0) continue;
      const Vec3 along = bentRing(around + 1e-2f, about) - bentRing(around - 1e-2f, about);
      const Vec3 across = bentRing(around, about + 1e-2f) - bentRing(around, about - 1e-2f);
      const Vec3 normal = across.cross(along).normalized();
      for (const float way : {-2e-3f, -1e-3f, 0.0f, 1e-3f, 2e-3f}) {
        const Vec3 p = surface.back() + way * normal;
        EXPECT_NEAR(signedDistance(body, place.apply(p), shapes.words), way, 6e-4f) << "a part of a cell";
      }
    }
  std::mt19937 random(9);
  std::uniform_real_distribution<float> range(-0.15f, 0.15f);
  int beyond = 0;
  for (int i = 0; i < 1500; ++i) {
    const Vec3 p(range(random), 0.6f * range(random), range(random));
    float truth = 1e9f;
    for (const Vec3& point : surface) truth = std::min(truth, (p - point).squaredNorm());
    truth = std::copysign(std::sqrt(truth), rest(p + bend.shift(p)));
    const float mine = signedDistance(body, place.apply(p), shapes.words);
    if (std::fabs(truth) < 8e-3f) continue;
    EXPECT_EQ(std::signbit(mine), std::signbit(truth));
    EXPECT_LE(std::fabs(mine), std::fabs(truth) + 4e-4);
    ++beyond;
  }
  EXPECT_GT(beyond, 500);
}

TEST(BodyShapes, AnyPointHasAnAnswer) {
  for (int kind = 0; kind < kFurtherKinds; ++kind) {
    ShapeData shapes;
    const MovingPrimitive body = furtherBody(kind, 0.01f, shapes);
    EXPECT_GT(signedDistance(body, Vec3(0, 1e6f, 0), shapes.words), 1e-3f);
    for (const float bad : {NAN, INFINITY, -INFINITY, 1e30f}) {
      signedDistance(body, Vec3(bad, 0, 0), shapes.words);
      signedDistance(body, Vec3(0, bad, bad), shapes.words);
    }
  }
}

TEST(BodyShapes, BoxesOfTheirWayHoldThem) {
  std::mt19937 random(8);
  std::uniform_real_distribution<float> range(-0.3f, 0.3f);
  for (int kind = 0; kind < kFurtherKinds; ++kind) {
    ShapeData shapes;
    const MovingPrimitive body = furtherBody(kind, 0.01f, shapes);
    const Box box = sweptBox(body);
    int inside = 0;
    for (int i = 0; i < 3000; ++i) {
      const Vec3 p(range(random), range(random), range(random));
      if (signedDistance(body, p, shapes.words) > 0) continue;
      ++inside;
      EXPECT_TRUE(box.contains(Eigen::Vector3f(p))) << "kind " << kind;
    }
    EXPECT_GT(inside, 10);
    EXPECT_LT(box.sizes().maxCoeff(), 0.6f);
  }
}

TEST(BodyShapes, WhatIsSharedIsKeptOnce) {
  ContactPrimitive a;
  a.kind = PrimitiveKind::kField;
  a.field = std::make_shared<DistanceField>(
      sampledField([](const Vec3& p) { return p.norm() - 0.05f; },
                   Box(Eigen::Vector3f::Constant(-0.05f), Eigen::Vector3f::Constant(0.05f)), 0.01f, 0.03f));
  ShapeData shapes;
  const uint32_t first = shapes.add(a);
  const uint64_t revision = shapes.revision;
  const size_t words = shapes.words.size();
  EXPECT_EQ(shapes.add(a), first);
  EXPECT_EQ(shapes.revision, revision);
  EXPECT_EQ(shapes.words.size(), words);
  a.field = std::make_shared<DistanceField>(*a.field);
  EXPECT_EQ(shapes.add(a), words);
  EXPECT_NE(shapes.revision, revision);
}

TEST(BodyShapes, BadShapesAreRefused) {
  const auto refused = [](const ContactPrimitive& shape) {
    EXPECT_THROW(checkPrimitive(shape, "a test"), Error);
  };
  ContactPrimitive shape;
  shape.radius = 0.1f;
  EXPECT_NO_THROW(checkPrimitive(shape, "a test"));
  shape.radius = 3e38f;
  refused(shape);
  shape.radius = 0.1f;
  shape.a.x() = -1.1e4f;
  refused(shape);
  shape.a.x() = 0;
  shape.friction = -1;
  refused(shape);
  for (const PrimitiveKind kind :
       {PrimitiveKind::kSphere, PrimitiveKind::kCapsule, PrimitiveKind::kTaperedCapsule}) {
    shape = {};
    shape.kind = kind;
    refused(shape);
    shape.radius_b = 0.1f;
    if (kind == PrimitiveKind::kTaperedCapsule) {
      EXPECT_NO_THROW(checkPrimitive(shape, "a test")) << "a cone";
    } else {
      refused(shape);
    }
    shape.radius = 0.1f;
    EXPECT_NO_THROW(checkPrimitive(shape, "a test"));
  }
  shape = {};
  shape.kind = PrimitiveKind::kPlane;
  shape.b = Vec3(0, 2, 0);
  refused(shape);
  shape.kind = PrimitiveKind::kBox;
  refused(shape);
  shape.extent = Vec3(1, 1, 1);
  EXPECT_NO_THROW(checkPrimitive(shape, "a test"));
  shape.rotation = Quat(2, 0, 0, 0);
  refused(shape);
  shape = {};
  shape.kind = PrimitiveKind::kEllipsoid;
  shape.extent = Vec3(1, 0.001f, 1);
  refused(shape);
  shape.extent = Vec3::Constant(1e-6f);
  EXPECT_NO_THROW(checkPrimitive(shape, "a test"));
  EXPECT_TRUE(std::isfinite(signedDistance(moved(shape, Pose{}, Pose{}, 1), Vec3::Constant(1e7f))));
  shape.extent = Vec3::Constant(1e-44f);
  refused(shape);
  shape.kind = PrimitiveKind::kConvex;
  refused(shape);
  shape.kind = PrimitiveKind::kField;
  refused(shape);
}

}  // namespace
}  // namespace strandcast
