#include "collision/mesh_repair.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "collision/body_distance.h"
#include "collision/field_bake.h"
#include "tests/collision/shapes.h"
#include "tests/expect_error.h"

namespace strandcast {
namespace {

using shapes::box;
using shapes::potato;
using shapes::randomPoint;
using shapes::sphere;
using shapes::together;

FieldOptions coarse() {
  FieldOptions options;
  options.cell = 0.02f;
  return options;
}

/// Positions of corners, each triangle from its least corner on; sorted.
using Surface = std::vector<std::array<std::array<float, 3>, 3>>;

Surface surfaceOf(const TriangleMesh& mesh) {
  Surface out;
  for (const auto& t : mesh.triangles) {
    auto& corners = out.emplace_back();
    for (size_t c = 0; c < 3; ++c) {
      const Vec3& p = mesh.positions[t[c]];
      corners[c] = {p.x(), p.y(), p.z()};
    }
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
  }
  std::sort(out.begin(), out.end());
  return out;
}

/// The repaired mesh has the winding and the triangles of the right one.
void expectSameSurface(const TriangleMesh& broken, const TriangleMesh& right, const char* what) {
  const OrientedSurface oriented = orientSurface(broken);
  EXPECT_TRUE(oriented.repair.changed()) << what;
  EXPECT_TRUE(surfaceOf(oriented.mesh) == surfaceOf(right)) << what << ", " << right.name;
}

/// Both meshes have the same inside.
void expectSameInside(const TriangleMesh& broken, const TriangleMesh& right) {
  const MeshQuery found(orientSurface(broken).mesh), wanted(right);
  std::mt19937 random(3);
  int inside = 0;
  for (int i = 0; i < 1000; ++i) {
    const Vec3 p = randomPoint(random, 0.12f);
    inside += isInside(wanted, p) ? 1 : 0;
    ASSERT_EQ(isInside(found, p), isInside(wanted, p)) << p.transpose();
  }
  EXPECT_GT(inside, 20);
}

void turn(std::array<uint32_t, 3>& triangle) { std::swap(triangle[1], triangle[2]); }

/// Reverses the triangles whose centre satisfies `which`.
template <class Which>
TriangleMesh turned(TriangleMesh mesh, Which which) {
  for (auto& t : mesh.triangles)
    if (which(Vec3((mesh.positions[t[0]] + mesh.positions[t[1]] + mesh.positions[t[2]]) / 3))) turn(t);
  return mesh;
}
TriangleMesh insideOut(TriangleMesh mesh) {
  return turned(std::move(mesh), [](const Vec3&) { return true; });
}

/// Each corner has a vertex of its own, as in files without indices, displaced by at most `noise` (m).
TriangleMesh soup(const TriangleMesh& mesh, float noise) {
  std::mt19937 random(4);
  TriangleMesh out;
  for (const auto& t : mesh.triangles) {
    const auto first = static_cast<uint32_t>(out.positions.size());
    for (const uint32_t v : t) out.positions.push_back(mesh.positions[v] + randomPoint(random, noise));
    out.triangles.push_back({first, first + 1, first + 2});
  }
  return out;
}

/// A bust: a sphere with a hole of 40 degrees at its bottom.
TriangleMesh bust() {
  TriangleMesh mesh = sphere(0.1f, 3);
  std::erase_if(mesh.triangles, [&](const auto& t) { return mesh.positions[t[0]].y() < -0.094f; });
  return mesh;
}

TEST(SurfaceOrientation, AHalfThatWasMirroredIsTurned) {
  for (const TriangleMesh& right : {sphere(0.05f, 3), potato(0.05f, 3), box({0.05f, 0.04f, 0.03f}), bust()})
    for (const float where : {-0.02f, 0.001f, 0.013f}) {
      const auto half = [&](const Vec3& p) { return p.x() > where; };
      const TriangleMesh broken = turned(right, half);
      expectSameSurface(broken, right, right.name.c_str());
      const SurfaceRepair repair = orientSurface(broken).repair;
      EXPECT_GT(repair.turned_triangles, 0u);
      EXPECT_LE(repair.turned_triangles, right.triangles.size() / 2 + 1) << "the smaller part";
      EXPECT_EQ(orientSurface(turned(soup(right, 0), half)).repair.turned_triangles, repair.turned_triangles);
    }
  expectSameInside(turned(bust(), [](const Vec3& p) { return p.x() > 0; }), bust());
}

TEST(SurfaceOrientation, TrianglesWoundAtRandomAreWoundAlike) {
  std::mt19937 random(7);
  for (const TriangleMesh& right : {sphere(0.05f, 3), potato(0.05f, 3), bust()})
    for (const unsigned one_in : {2u, 3u, 10u})
      expectSameSurface(turned(right, [&](const Vec3&) { return random() % one_in == 0; }), right, "random");
  const TriangleMesh ball = sphere(0.05f, 3);
  expectSameInside(turned(ball, [&](const Vec3&) { return random() % 2 == 0; }), ball);
}

TEST(SurfaceOrientation, TrianglesThatAreThereTwiceCountOnce) {
  const TriangleMesh right = potato(0.05f, 3);
  const auto top = [](const Vec3& p) { return p.y() > 0.01f; };
  TriangleMesh half = right;
  std::erase_if(half.triangles, [&](const auto& t) { return !top(right.positions[t[0]]); });
  expectSameSurface(together(right, right), right, "the same way round");
  expectSameSurface(together(right, insideOut(right)), right, "both ways round");
  expectSameSurface(together(right, turned(right, top)), right, "partly both ways");
  expectSameSurface(together(right, insideOut(half)), right, "a part both ways");
  expectSameSurface(together(together(right, insideOut(right)), right), right, "three times");
  TriangleMesh rolled = right;
  for (auto& t : rolled.triangles) std::rotate(t.begin(), t.begin() + 1, t.end());
  expectSameSurface(together(right, insideOut(rolled)), right, "from another corner");
  EXPECT_EQ(orientSurface(together(right, half)).repair.repeated, half.triangles.size());
  expectSameInside(together(right, insideOut(right)), right);
}

// A quad (a b c d) and its reverse (d c b a), each divided from its first corner.
TEST(SurfaceOrientation, QuadsAndTheirReversesCountOnceAlongWhateverDiagonal) {
  const TriangleMesh right = shapes::globe(0.05f, 12, 20);
  TriangleMesh reverse = right;
  for (size_t t = 0; t + 1 < reverse.triangles.size(); t += 2) {
    const auto [a, b, c] = right.triangles[t];
    const uint32_t d = right.triangles[t + 1][2];
    reverse.triangles[t] = {d, c, b};
    reverse.triangles[t + 1] = {d, b, a};
  }
  TriangleMesh half = reverse, open = right, open_reverse = reverse;
  std::erase_if(half.triangles, [&](const auto& t) { return half.positions[t[0]].x() < 0.001f; });
  for (TriangleMesh* mesh : {&open, &open_reverse}) mesh->triangles.resize(mesh->triangles.size() - 3 * 40);
  expectSameInside(together(open, open_reverse), open);
  for (const TriangleMesh& other : {reverse, insideOut(reverse), half})
    expectSameInside(together(right, other), right);
  TriangleMesh boxes = together(box({0.05f, 0.05f, 0.05f}), box({0.05f, 0.05f, 0.05f}));
  for (size_t v = 8; v < 16; ++v) boxes.positions[v].x() -= 0.1f;  // the diagonals of the wall cross
  const OrientedSurface joined = orientSurface(boxes);
  EXPECT_EQ(joined.mesh.triangles.size(), 20u);
  EXPECT_TRUE(checkMesh(joined.mesh).open_edges.empty());
}

TEST(SurfaceOrientation, BodiesOfOppositeWindingDoNotCancel) {
  const TriangleMesh ball = sphere(0.05f, 3), beside = sphere(0.04f, 3, {0.05f, 0, 0}),
                     apart = sphere(0.03f, 3, {0, 0.12f, 0});
  expectSameSurface(together(ball, insideOut(beside)), together(ball, beside), "overlapping");
  expectSameSurface(together(insideOut(ball), beside), together(ball, beside), "the larger");
  expectSameSurface(together(ball, insideOut(apart)), together(ball, apart), "apart");
  const TriangleMesh three = together(together(ball, beside), apart);
  expectSameSurface(together(together(ball, insideOut(beside)), insideOut(apart)), three, "two of three");
  expectSameInside(together(ball, insideOut(beside)), together(ball, beside));
}

// Eyes that protrude from a head, through its skin or out of a hole in it.
TEST(SurfaceOrientation, EyesWoundInwardsAreTurned) {
  const TriangleMesh left = sphere(0.02f, 2, {0.03f, 0.02f, 0.085f}),
                     right = sphere(0.02f, 2, {-0.03f, 0.02f, 0.085f});
  TriangleMesh holed = sphere(0.1f, 3);
  std::erase_if(holed.triangles, [&](const auto& t) {
    const Vec3& p = holed.positions[t[0]];
    return p.z() > 0 && std::hypot(std::fabs(p.x()) - 0.03f, p.y() - 0.02f) < 0.017f;
  });
  for (const TriangleMesh& head : {sphere(0.1f, 3), bust(), holed}) {
    const TriangleMesh eyes = together(left, right);
    expectSameSurface(together(head, together(insideOut(left), right)), together(head, eyes), "one");
    expectSameSurface(together(head, insideOut(eyes)), together(head, eyes), "both");
    expectSameSurface(insideOut(together(head, insideOut(eyes))), together(head, eyes),
                      "in a head inside out");
  }
}

TEST(SurfaceOrientation, WhatIsWoundAsItShouldBeStaysAsItIs) {
  const TriangleMesh outer = sphere(0.1f, 3), inner = sphere(0.06f, 3);
  TriangleMesh thin = box({0.1f, 0.0005f, 0.1f}), lining = sphere(0.095f, 3), hat = outer;
  for (TriangleMesh* dome : {&lining, &hat})
    std::erase_if(dome->triangles, [&](const auto& t) { return dome->positions[t[0]].y() < 0; });
  TriangleMesh sheet;
  sheet.positions = {{-0.1f, 0, -0.1f}, {0.1f, 0, -0.1f}, {0.1f, 0, 0.1f}, {-0.1f, 0, 0.1f}};
  sheet.triangles = {{0, 1, 2}, {0, 2, 3}};
  TriangleMesh above = insideOut(sheet);
  for (Vec3& p : above.positions) p.y() += 1e-3f;
  const std::vector<std::pair<const char*, TriangleMesh>> meshes = {
      {"ball", outer},
      {"potato", potato(0.1f, 3)},
      {"bust", bust()},
      {"shells alike", together(outer, inner)},
      {"hollow ball", together(outer, insideOut(inner))},
      {"ball in a hollow", together(together(outer, insideOut(inner)), sphere(0.03f, 2))},
      {"hat with a lining", together(hat, insideOut(lining))},
      {"thin slab", thin},
      {"sheet", sheet},
      {"two sheets a millimetre apart", together(sheet, above)},
      {"boxes that share an edge", together(box({0.05f, 0.05f, 0.05f}), [] {
         TriangleMesh other = box({0.05f, 0.05f, 0.05f});
         for (Vec3& p : other.positions) p += Vec3(0.1f, 0.1f, 0);
         return other;
       }())}};
  for (const auto& [name, mesh] : meshes)
    for (const TriangleMesh& given : {mesh, insideOut(mesh), soup(mesh, 0)}) {
      const OrientedSurface oriented = orientSurface(given);
      EXPECT_FALSE(oriented.repair.changed()) << name;
      EXPECT_EQ(oriented.mesh.triangles, given.triangles) << name;
      // A hollow shell and a body in an inverted hull: as a whole inside out, the two cannot be told apart.
      const bool is_unclear = oriented.repair.is_inside_out && oriented.repair.hollows > 0;
      EXPECT_EQ(oriented.repair.lines().empty(), !is_unclear) << name;
    }
  EXPECT_EQ(orientSurface(together(outer, insideOut(inner))).repair.hollows, 1u);
  EXPECT_EQ(orientSurface(together(inner, insideOut(outer))).repair.lines().size(), 1u);
}

TEST(SurfaceOrientation, FieldsAreBakedOfTheRepairedSurface) {
  const TriangleMesh right = sphere(0.05f, 2);
  const TriangleMesh mirrored = turned(right, [](const Vec3& p) { return p.x() > 0; });
  const DistanceField wanted = FieldBaker(right, coarse()).bake();
  EXPECT_TRUE(wanted.hasInside());
  for (const TriangleMesh& broken : {mirrored, together(right, mirrored)}) {
    const DistanceField found = FieldBaker(broken, coarse()).bake();
    EXPECT_EQ(found.index, wanted.index);
    EXPECT_EQ(found.samples, wanted.samples);
    EXPECT_EQ(found.corners, wanted.corners);
  }
  FieldOptions trusting = coarse();
  trusting.is_oriented = true;
  EXPECT_NE(FieldBaker(mirrored, trusting).bake().samples, wanted.samples) << "taken as it is wound";
}

TEST(SurfaceOrientation, AWallBetweenBodiesIsNoSurface) {
  TriangleMesh two = box({0.05f, 0.05f, 0.05f}), beyond = two;
  for (Vec3& p : beyond.positions) p.x() += 0.1f;
  TriangleMesh right = box({0.1f, 0.05f, 0.05f});
  for (Vec3& p : right.positions) p.x() += 0.05f;
  TriangleMesh once = together(two, beyond);  // with only one of the two walls
  std::erase_if(once.triangles, [&](const auto& t) {
    const auto first = static_cast<uint32_t>(two.positions.size());
    return t[0] >= first &&
           std::all_of(t.begin(), t.end(), [&](uint32_t v) { return once.positions[v].x() < 0.06f; });
  });
  ASSERT_EQ(once.triangles.size(), 22u);
  for (const TriangleMesh& mesh : {together(two, beyond), together(two, insideOut(beyond)), once}) {
    EXPECT_TRUE(checkMesh(orientSurface(mesh).mesh).open_edges.empty());
    expectSameInside(mesh, right);
  }
}

TEST(SurfaceOrientation, TJunctionsSliversAndRoundedCornersAreBridged) {
  const TriangleMesh right = sphere(0.05f, 3);
  const auto half = [](const Vec3& p) { return p.z() > 0.003f; };
  // One triangle divided at the middle of an edge that its neighbour does not divide.
  TriangleMesh split = right;
  const auto [a, b, c] = split.triangles[500];
  const auto middle = static_cast<uint32_t>(split.positions.size());
  split.positions.push_back(0.5f * (split.positions[a] + split.positions[b]));
  split.triangles[500] = {a, middle, c};
  split.triangles.push_back({middle, b, c});
  TriangleMesh slivers = split;  // the gap filled with a degenerate triangle, and further degenerate ones
  slivers.triangles.push_back({b, middle, a});
  slivers.triangles.push_back({a, a, b});
  slivers.triangles.push_back({c, c, c});
  const TriangleMesh loose = soup(right, 2e-8f);
  for (const TriangleMesh& mesh : {split, slivers, loose}) {
    EXPECT_FALSE(orientSurface(mesh).repair.changed());
    expectSameInside(turned(mesh, half), right);
  }
}

TEST(SurfaceOrientation, FinsAndASurfaceOfOneSideChangeNothingElse) {
  TriangleMesh lashes = sphere(0.05f, 3);
  const auto [a, b, c] = lashes.triangles[40];
  lashes.positions.push_back(lashes.positions[a] * 1.4f);
  lashes.triangles.push_back({a, b, static_cast<uint32_t>(lashes.positions.size() - 1)});
  EXPECT_FALSE(orientSurface(lashes).repair.changed());
  TriangleMesh strip;  // a Moebius strip
  for (int i = 0; i < 40; ++i) {
    const float round = 2 * std::numbers::pi_v<float> * static_cast<float>(i) / 40, twist = round / 2;
    const Vec3 out(std::cos(round), 0, std::sin(round));
    for (const float side : {-1.0f, 1.0f})
      strip.positions.push_back(0.08f * out +
                                side * 0.02f * (std::cos(twist) * out + std::sin(twist) * Vec3::UnitY()));
  }
  for (uint32_t i = 0; i < 40; ++i) {
    const uint32_t p = 2 * i, q = i < 39 ? p + 2 : 1, r = i < 39 ? p + 3 : 0;
    strip.triangles.push_back({p, p + 1, q});
    strip.triangles.push_back({q, p + 1, r});
  }
  EXPECT_EQ(orientSurface(strip).mesh.triangles, strip.triangles);
}

TEST(SurfaceOrientation, WarningsSayWhatWasRepairedAndWhereTheSideStaysInDoubt) {
  const auto warningsOf = [](const TriangleMesh& mesh) {
    std::string all;
    for (const std::string& line : orientSurface(mesh).repair.lines()) all += line + "\n";
    return all;
  };
  const TriangleMesh ball = sphere(0.05f, 2);
  EXPECT_EQ(warningsOf(ball), "");
  EXPECT_EQ(warningsOf(insideOut(ball)), "");
  EXPECT_EQ(warningsOf(together(ball, insideOut(sphere(0.04f, 2, {0.06f, 0, 0})))),
            "1 of 2 pieces of the surface is wound inside out, and is turned\n");
  TriangleMesh some = ball;
  for (size_t t = 0; t < 7; ++t) turn(some.triangles[t * 40]);
  EXPECT_EQ(warningsOf(some), "7 of 320 triangles are wound against their neighbours, and are turned\n");
  EXPECT_EQ(warningsOf(together(ball, ball)),
            "320 of 640 triangles repeat others, with the same corners, and are left out\n");
  TriangleMesh torn = ball;  // like a net
  for (size_t t = 0; t < torn.triangles.size(); t += 3) torn.triangles[t][1] = torn.triangles[t][0];
  const std::vector<std::string> doubts = FieldBaker(torn, coarse()).warnings();
  ASSERT_EQ(doubts.size(), 1u);
  EXPECT_NE(doubts[0].find("inside and outside are in doubt at "), std::string::npos) << doubts[0];
  EXPECT_LT(FieldBaker(bust(), coarse()).uncertainShare(), 0.02) << "but for the rim of its hole";
  EXPECT_NE(errorOf([] { orientSurface({}); }).find("no triangles"), std::string::npos);
}

TEST(SurfaceOrientation, ManyPiecesAreTakenInOneGo) {
  std::mt19937 random(5);
  TriangleMesh many;
  for (int i = 0; i < 60; ++i) {
    const TriangleMesh ball = sphere(0.004f, 1, randomPoint(random, 0.1f));
    many = together(std::move(many), i % 3 == 0 ? insideOut(ball) : ball);
  }
  const OrientedSurface oriented = orientSurface(many);
  EXPECT_EQ(oriented.repair.pieces, 60u);
  EXPECT_GE(oriented.repair.turned_pieces + oriented.repair.hollows, 20u);
  TriangleMesh loose;
  for (int i = 0; i < 3000; ++i) {
    const auto first = static_cast<uint32_t>(loose.positions.size());
    for (int c = 0; c < 3; ++c) loose.positions.push_back(randomPoint(random, 0.1f));
    loose.triangles.push_back({first, first + 1, first + 2});
  }
  EXPECT_EQ(orientSurface(loose).mesh.triangles, loose.triangles) << "flat, so none has an inside";
}

}  // namespace
}  // namespace strandcast
