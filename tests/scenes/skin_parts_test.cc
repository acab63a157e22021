// Refinement of a coarse skin into triangles over which weights change little, and the accuracy with which
// parts follow a blended skin.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <string>

#include "collision/mesh_query.h"
#include "collision/skin_parts.h"
#include "tests/expect_error.h"
#include "tests/io/skinned_arm.h"
#include "tests/real_data.h"
#include "tests/thorough.h"

namespace strandcast {
namespace {

SkinnedMesh armOf(float spacing, int sectors) {
  samples::ArmOptions options;
  options.spacing = spacing;
  options.sectors = sectors;
  return readGltfSkin(samples::armGlb(options), "arm.glb");
}

double weightOf(const std::vector<SkinShare>& shares, uint32_t binding) {
  for (const SkinShare& share : shares)
    if (share.binding == binding) return share.weight();
  return 0;
}

TEST(FineSkin, OverEachTriangleWeightsChangeLittleAndNothingOpens) {
  const SkinnedMesh skin = armOf(0.1f, 8);
  const FineSkin fine = fineSkin(skin);
  EXPECT_GT(fine.triangles.size(), 4 * skin.mesh.triangles.size());
  std::map<std::pair<uint32_t, uint32_t>, int> edges;
  for (const auto& t : fine.triangles)
    for (size_t c = 0; c < 3; ++c) {
      const uint32_t from = t[c], to = t[(c + 1) % 3];
      edges[std::minmax(from, to)] += from < to ? 1 : -1;
      for (const uint32_t binding : {0u, 1u})
        EXPECT_LE(std::fabs(weightOf(fine.shares[from], binding) - weightOf(fine.shares[to], binding)),
                  0.08 + 1e-9);
    }
  for (const auto& [edge, count] : edges) EXPECT_EQ(count, 0);
}

// If blended from weights of their own, the added vertices would lie off the triangles.
TEST(FineSkin, ItsVerticesStayInTheFlatTrianglesOfTheMesh) {
  const SkinnedMesh skin = armOf(0.1f, 8);
  const FineSkin fine = fineSkin(skin);
  std::vector<JointTransform> locals = skin.skeleton.rest();
  for (const double seconds : {0.0, 0.5, 1.0}) {
    skin.clips.at(0).pose(seconds, locals);
    const std::vector<Placement> world = skin.skeleton.worldTransforms(locals),
                                 bindings = skin.bindingsAt(world);
    TriangleMesh bent = skin.mesh;
    bent.positions = skin.blended(world);
    const MeshQuery query(bent);
    for (size_t v = 0; v < fine.positions.size(); ++v) {
      const Vec3 place(blended(fine.shares[v], bindings).cast<float>());
      EXPECT_LT(query.distance(place), 1e-6f) << v << " at " << seconds;
      if (seconds == 0) {
        EXPECT_LT((place - fine.positions[v]).norm(), 1e-6f) << v;
      }
    }
  }
}

TEST(FineSkin, WhatIsFineStaysAsItIs) {
  samples::ArmOptions options;
  options.blend = 0.1f;
  const SkinnedMesh skin = readGltfSkin(samples::armGlb(options), "arm.glb");
  const FineSkin fine = fineSkin(skin);
  EXPECT_EQ(fine.triangles, skin.mesh.triangles);
  ASSERT_EQ(fine.positions.size(), skin.mesh.positions.size());
  for (size_t v = 0; v < fine.positions.size(); ++v) EXPECT_EQ(fine.positions[v], skin.mesh.positions[v]);
}

}  // namespace
namespace {

/// The skin and its parts at a time of a clip. Meshes of parts are at rest, so that a query point must be
/// transformed back to rest.
struct Blended {
  TriangleMesh skin;
  std::vector<Pose> poses;
  std::vector<SurfaceBend> bends;
};

Blended blendedAt(const SkinnedMesh& skin, const std::vector<SkinPart>& parts, double seconds,
                  size_t clip = 0) {
  std::vector<JointTransform> locals = skin.skeleton.rest();
  skin.clips.at(clip).pose(seconds, locals);
  const std::vector<Placement> world = skin.skeleton.worldTransforms(locals);
  Blended out;
  out.skin = skin.mesh;
  out.skin.positions = skin.blended(world);
  for (const SkinPart& part : parts) {
    out.poses.push_back(partPose(part, skin.bindingsAt(world)));
    out.bends.push_back(partBend(part, skin.bindingsAt(world), out.poses.back()));
  }
  return out;
}

/// m, distance between the surfaces of the parts and of the skin.
struct Apart {
  double mean = 0, most_below = 0, most_above = 0;
};

/// Evaluated at all vertices of the skin and at the centres of its triangles, in lengths at rest.
/// `most_above` leaves out places over which the skin itself has folded.
Apart apart(const Blended& blended, const std::vector<SkinPart>& parts) {
  std::vector<MeshQuery> queries;
  std::vector<Box> boxes;
  for (const SkinPart& part : parts) {
    queries.emplace_back(part.mesh);
    boxes.push_back(part.mesh.bounds());
  }
  TriangleMesh skin = blended.skin;
  computeNormals(skin);
  std::vector<Vec3> places = skin.positions, normals = skin.normals;
  for (const auto& t : skin.triangles) {
    const Vec3 &a = skin.positions[t[0]], &b = skin.positions[t[1]], &c = skin.positions[t[2]];
    places.push_back((a + b + c) / 3);
    normals.push_back((b - a).cross(c - a).normalized());
  }
  const MeshQuery query(skin);
  Apart out;
  for (size_t n = 0; n < places.size(); ++n) {
    float nearest = 1e9f;
    for (size_t i = 0; i < parts.size(); ++i) {
      // Outside a part's box the bend at the border of the box applies (kernels/distance_field.h).
      const Vec3 p = blended.poses[i].inverse().apply(places[n]),
                 within = p.cwiseMax(Vec3(boxes[i].min())).cwiseMin(Vec3(boxes[i].max())),
                 place = p + blended.bends[i].shift(within);
      if (boxes[i].exteriorDistance(Eigen::Vector3f(place)) < nearest)
        nearest = std::min(nearest, queries[i].signedDistance(place));
    }
    const double off = static_cast<double>(nearest);
    out.mean += std::fabs(off) / static_cast<double>(places.size());
    out.most_below = std::max(out.most_below, off);
    if (-off > out.most_above && query.windingNumber(places[n] + 1e-3f * normals[n]) < 0.5f)
      out.most_above = -off;
  }
  return out;
}

samples::ArmOptions broadArm(float blend) {
  samples::ArmOptions options;
  options.blend = blend;
  return options;
}

TEST(SkinParts, EveryPartIsClosedAndAtRestTheyAreTheMesh) {
  const SkinnedMesh skin = readGltfSkin(samples::armGlb(), "arm.glb");
  const std::vector<SkinPart> parts = cutSkin(skin);
  EXPECT_EQ(parts.size(), 7u) << "two joints and five parts between them";
  for (const SkinPart& part : parts) {
    std::map<std::pair<uint32_t, uint32_t>, int> edges;
    for (const auto& t : part.mesh.triangles)
      for (size_t c = 0; c < 3; ++c) {
        const uint32_t from = t[c], to = t[(c + 1) % 3];
        edges[std::minmax(from, to)] += from < to ? 1 : -1;
      }
    for (const auto& [edge, count] : edges) EXPECT_EQ(count, 0) << part.name;
  }
  const Apart rest = apart(blendedAt(skin, parts, 0), parts);
  EXPECT_LT(rest.mean + rest.most_below + rest.most_above, 1e-6);
}

TEST(SkinParts, AJointsOwnPartGoesWithIt) {
  const SkinnedMesh skin = readGltfSkin(samples::armGlb(), "arm.glb");
  const std::vector<SkinPart> parts = cutSkin(skin);
  std::vector<JointTransform> locals = skin.skeleton.rest();
  skin.clips.at(0).pose(0.7, locals);
  const std::vector<Placement> world = skin.skeleton.worldTransforms(locals);
  for (const SkinPart& part : parts) {
    const int joint = skin.skeleton.find(part.name);
    if (joint < 0) continue;
    const Pose pose = partPose(part, skin.bindingsAt(world));
    const Placement moved =
        world[static_cast<size_t>(joint)] *
        skin.skeleton.worldTransforms(skin.skeleton.rest())[static_cast<size_t>(joint)].inverse();
    for (const Vec3& p : part.mesh.positions)
      EXPECT_LT((pose.apply(p) - (moved * p.cast<double>()).cast<float>()).norm(), 1e-6f) << part.name;
  }
}

// docs/architecture.md, "Skinned bodies", quotes these numbers. In the first case, at 60 degrees, the skin
// itself folds.
TEST(SkinParts, FollowABentArm) {
  for (const float blend : {0.03f, 0.06f, 0.1f}) {
    const SkinnedMesh skin = readGltfSkin(samples::armGlb(broadArm(blend)), "arm.glb");
    for (const int between : {0, 5}) {
      const std::vector<SkinPart> parts = cutSkin(skin, between);
      for (const double degrees : {15, 30, 45, 60}) {
        if (kSanitized && (between == 0 || degrees < 60)) continue;  // the same code, half a minute
        const Apart a = apart(blendedAt(skin, parts, degrees / 60), parts);
        std::printf(
            "weights go over in %3.0f mm, %zu parts, bent by %2.0f degrees: mean %.2f mm, %.1f below, %.1f "
            "above\n",
            2e3 * static_cast<double>(blend), parts.size(), degrees, 1e3 * a.mean, 1e3 * a.most_below,
            1e3 * a.most_above);
        if (between == 0) continue;
        EXPECT_LT(a.mean, 1e-4);
        EXPECT_LT(a.most_below, 1.3e-3);
        EXPECT_LT(a.most_above, 2e-3);
      }
    }
  }
}

// A triangle of this arm is as long as the whole elbow. So the region that is weighted to both joints is a
// band of large triangles, each flat between them.
TEST(SkinParts, FollowABentArmOfFewTriangles) {
  samples::ArmOptions options;
  options.spacing = 0.1f;
  options.sectors = 8;
  const SkinnedMesh skin = readGltfSkin(samples::armGlb(options), "arm.glb");
  EXPECT_LT(skin.mesh.triangles.size(), 200u);
  const std::vector<SkinPart> parts = cutSkin(skin);
  for (const double degrees : {15, 30, 45, 60}) {
    const Apart a = apart(blendedAt(skin, parts, degrees / 60), parts);
    std::printf("%zu triangles, %zu parts, bent by %2.0f degrees: mean %.2f mm, %.1f below, %.1f above\n",
                skin.mesh.triangles.size(), parts.size(), degrees, 1e3 * a.mean, 1e3 * a.most_below,
                1e3 * a.most_above);
    EXPECT_LT(a.mean, 1.5e-4);
    EXPECT_LT(a.most_below, 1.3e-3);
    EXPECT_LT(a.most_above, 2e-3);
  }
}

// docs/architecture.md, "Skinned bodies", quotes these numbers.
TEST(SkinParts, FollowARealFox) {
  if (!thorough()) GTEST_SKIP() << kSkippedUnlessThorough;
  const auto file = dataFolder() / "motion" / "Fox.glb";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no " << file << " (set STRANDCAST_DATA)";
  const SkinnedMesh skin = loadSkinnedMesh(file, {0.01f, UpAxis::kAuto});
  const std::vector<SkinPart> parts = cutSkin(skin);
  EXPECT_LE(parts.size(), kMaxSkinParts);
  constexpr int kLooks = 8;
  for (size_t clip = 0; clip < skin.clips.size(); ++clip) {
    Apart all;
    for (int look = 0; look < kLooks; ++look) {
      const double seconds = skin.clips[clip].duration * look / kLooks;
      const Apart a = apart(blendedAt(skin, parts, seconds, clip), parts);
      all.mean += a.mean / kLooks;
      all.most_below = std::max(all.most_below, a.most_below);
      all.most_above = std::max(all.most_above, a.most_above);
    }
    std::printf("a fox of 1.5 m, %s, %zu parts: mean %.2f mm, %.1f below, %.1f above\n",
                skin.clips[clip].name.c_str(), parts.size(), 1e3 * all.mean, 1e3 * all.most_below,
                1e3 * all.most_above);
    EXPECT_LT(all.mean, 1.5e-3);
    EXPECT_LT(all.most_below, 25e-3);
    EXPECT_LT(all.most_above, 20e-3);
  }
}

// A bend extrapolates far from the vertices to which it was fitted. This must not put hair there into a part.
TEST(SkinParts, PlacesOffTheSkinAreInNoPart) {
  for (const float blend : {0.03f, 0.06f, 0.1f}) {
    const SkinnedMesh skin = readGltfSkin(samples::armGlb(broadArm(blend)), "arm.glb");
    const std::vector<SkinPart> parts = cutSkin(skin);
    const Blended blended = blendedAt(skin, parts, 1);
    TriangleMesh surface = blended.skin;
    computeNormals(surface);
    const MeshQuery query(surface);
    std::vector<MeshQuery> queries;
    for (const SkinPart& part : parts) queries.emplace_back(part.mesh);
    for (const float off : {0.003f, 0.01f, 0.03f}) {
      float least = 1;
      for (size_t v = 0; v < surface.positions.size(); ++v) {
        const Vec3 place = surface.positions[v] + off * surface.normals[v];
        const float truth = query.signedDistance(place);
        if (truth < 0.5f * off) continue;  // inside the crease
        for (size_t i = 0; i < parts.size(); ++i) {
          const Vec3 p = blended.poses[i].inverse().apply(place);
          least = std::min(least, queries[i].signedDistance(p + blended.bends[i].shift(p)) / truth);
        }
      }
      EXPECT_GT(least, 0.25f) << "weights go over in " << 2 * blend << " m, " << off << " m off";
    }
  }
}

TEST(SkinParts, AtRestNothingIsBent) {
  const SkinnedMesh skin = readGltfSkin(samples::armGlb(), "arm.glb");
  const std::vector<Placement> world = skin.skeleton.worldTransforms(skin.skeleton.rest());
  for (const SkinPart& part : cutSkin(skin)) {
    const Pose pose = partPose(part, skin.bindingsAt(world));
    EXPECT_TRUE(partBend(part, skin.bindingsAt(world), pose).isNone()) << part.name;
  }
}

samples::ArmOptions swellingArm(float bulge) {
  samples::ArmOptions options;
  options.bulge = bulge;
  options.spacing = 0.016f;
  options.sectors = 20;
  return options;
}

/// The skin and its parts at a weight of its only target.
Blended swollen(const SkinnedMesh& skin, const std::vector<SkinPart>& parts, float weight) {
  const std::vector<Placement> world = skin.skeleton.worldTransforms(skin.skeleton.rest()),
                               bindings = skin.bindingsAt(world, std::vector<float>{weight});
  Blended out;
  out.skin = skin.mesh;
  out.skin.positions = skin.blended(world, std::vector<float>{weight});
  for (const SkinPart& part : parts) {
    out.poses.push_back(partPose(part, bindings));
    out.bends.push_back(partBend(part, bindings, out.poses.back()));
  }
  return out;
}

// docs/architecture.md, "Skinned bodies", quotes these numbers.
TEST(SkinParts, FollowWhatMorphTargetsMove) {
  for (const float bulge : {0.01f, -0.01f}) {
    const SkinnedMesh skin = readGltfSkin(samples::armGlb(swellingArm(bulge)), "arm.glb");
    const std::vector<SkinPart> parts = cutSkin(skin);
    const Apart all = apart(swollen(skin, parts, 1), parts);
    std::printf("a bulge of %.0f mm, %zu parts: mean %.2f mm, %.1f below, %.1f above\n",
                1e3 * static_cast<double>(bulge), parts.size(), 1e3 * all.mean, 1e3 * all.most_below,
                1e3 * all.most_above);
    for (const SurfaceBend& bend : swollen(skin, parts, 0).bends) EXPECT_TRUE(bend.isNone());
    const double size = std::fabs(static_cast<double>(bulge));
    EXPECT_LT(all.mean, 0.02 * size);
    EXPECT_LT(all.most_below, 0.3 * size);
    EXPECT_LT(all.most_above, 0.3 * size);
  }
}

TEST(SkinParts, OfAJointBendOnlyWhereTargetsMoveThem) {
  SkinnedMesh skin = readGltfSkin(samples::armGlb(swellingArm(0.01f)), "arm.glb");
  size_t moved = 0;
  for (const SkinPart& part : cutSkin(skin)) {
    const bool is_moved = part.name.starts_with("lower moved");
    moved += is_moved;
    if (part.name == "upper" || part.name == "lower") {
      EXPECT_TRUE(part.samples.empty()) << part.name;
    }
    EXPECT_EQ(is_moved, is_moved && !part.samples.empty()) << part.name;
  }
  EXPECT_GT(moved, 1u);
  SkeletonClip none;
  skin.keepTargets(none);
  const std::vector<SkinPart> plain = cutSkin(readGltfSkin(samples::armGlb(swellingArm(0)), "arm.glb")),
                              parts = cutSkin(skin);
  ASSERT_EQ(parts.size(), plain.size());
  for (size_t i = 0; i < parts.size(); ++i) {
    EXPECT_EQ(parts[i].mesh.positions, plain[i].mesh.positions);
    EXPECT_EQ(parts[i].mesh.triangles, plain[i].mesh.triangles);
  }
}

TEST(SkinParts, OfTooManyJointsBendAsAWholeWhereTargetsMoveThemAll) {
  samples::ArmOptions options = swellingArm(0.01f);
  options.joints.clear();
  for (int j = 0; j < 60; ++j) options.joints.push_back("joint" + std::to_string(j));
  options.bone = 0.05f;
  options.blend = 0.02f;
  options.spacing = 0.05f;
  options.sectors = 4;
  SkinnedMesh skin = readGltfSkin(samples::armGlb(options), "worm.glb");
  for (uint32_t v = 0; v < skin.stored.size(); ++v) skin.targets[0].moves.push_back({v, Vec3(0.01f, 0, 0)});
  skin.bindTargets();
  const std::vector<SkinPart> parts = cutSkin(skin, 0);
  EXPECT_EQ(parts.size(), 60u);
  for (const SkinPart& part : parts) EXPECT_FALSE(part.samples.empty()) << part.name;
}

TEST(SkinParts, MoreJointsThanTheWireHasPlacesForGetFewerPartsBetween) {
  samples::ArmOptions options;
  options.joints.clear();
  for (int j = 0; j < 40; ++j) options.joints.push_back("joint" + std::to_string(j));
  options.bone = 0.05f;
  options.blend = 0.02f;
  options.sectors = 8;
  EXPECT_LE(cutSkin(readGltfSkin(samples::armGlb(options), "worm.glb")).size(), kMaxSkinParts);
  for (int j = 40; j < 120; ++j) options.joints.push_back("joint" + std::to_string(j));
  expectError([&] { cutSkin(readGltfSkin(samples::armGlb(options), "worm.glb")); },
              {"worm.glb", "120 joints carry the mesh", "100 at most"});
}

}  // namespace
}  // namespace strandcast
