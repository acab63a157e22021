// How well rigid parts follow a skin that is blended.
#include "scenes/skin_parts.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <map>
#include <string>

#include "collision/mesh_query.h"
#include "tests/groom/expect_error.h"
#include "tests/groom/skinned_arm.h"

namespace strandcast {
namespace {

/// Places of the parts and of the skin at a time of the first clip.
struct Bent {
  TriangleMesh skin;
  std::vector<TriangleMesh> parts;
};

Bent bentAt(const SkinnedMesh& skin, const std::vector<SkinPart>& parts, double seconds) {
  std::vector<JointTransform> locals = skin.skeleton.rest();
  skin.clips.at(0).pose(seconds, locals);
  const std::vector<Placement> world = skin.skeleton.place(locals);
  Bent bent;
  bent.skin = skin.mesh;
  bent.skin.positions = skin.blended(world);
  for (const SkinPart& part : parts) {
    const Pose pose = partPose(part, skin.bindingsAt(world));
    bent.parts.push_back(part.mesh);
    for (Vec3& p : bent.parts.back().positions) p = pose.apply(p);
  }
  return bent;
}

struct Apart {
  double mean = 0, most_below = 0, most_above = 0;  ///< m: of the parts' surface from the skin's
};

/// From the skin to the union of the parts, and from what of the parts lies outside all others to the skin.
Apart apart(const Bent& bent) {
  std::vector<MeshQuery> parts;
  for (const TriangleMesh& part : bent.parts) parts.emplace_back(part);
  TriangleMesh outer;
  for (size_t i = 0; i < parts.size(); ++i)
    for (const auto& t : bent.parts[i].triangles) {
      const Vec3 middle =
          (bent.parts[i].positions[t[0]] + bent.parts[i].positions[t[1]] + bent.parts[i].positions[t[2]]) / 3;
      bool hidden = false;
      for (size_t k = 0; k < parts.size() && !hidden; ++k)
        hidden = k != i && parts[k].signedDistance(middle) < -2e-5f;
      if (hidden) continue;
      const auto first = static_cast<uint32_t>(outer.positions.size());
      for (const uint32_t v : t) outer.positions.push_back(bent.parts[i].positions[v]);
      outer.triangles.push_back({first, first + 1, first + 2});
    }
  const MeshQuery skin(bent.skin), surface(outer);
  Apart out;
  double count = 0;
  const auto add = [&](float signed_distance) {
    out.mean += std::fabs(static_cast<double>(signed_distance));
    count += 1;
    (signed_distance < 0 ? out.most_below : out.most_above) =
        std::max(signed_distance < 0 ? out.most_below : out.most_above,
                 std::fabs(static_cast<double>(signed_distance)));
  };
  for (const Vec3& p : bent.skin.positions) {
    bool inside = false;
    for (const MeshQuery& part : parts) inside = inside || part.signedDistance(p) < 0;
    add(inside ? surface.distance(p) : -surface.distance(p));
  }
  for (size_t t = 0; t < outer.triangles.size(); ++t)
    add(skin.signedDistance(
        (outer.positions[3 * t] + outer.positions[3 * t + 1] + outer.positions[3 * t + 2]) / 3));
  out.mean /= count;
  return out;
}

samples::ArmOptions broadArm(float blend) {
  samples::ArmOptions options;
  options.blend = blend;
  return options;
}

TEST(SkinParts, EveryPartIsClosedAndAtRestTheyAreTheMesh) {
  const SkinnedMesh skin = readGltfSkin(samples::armGlb(), "arm.glb");
  const std::vector<SkinPart> parts = cutSkin(skin, {});
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
  const Apart rest = apart(bentAt(skin, parts, 0));
  EXPECT_LT(rest.mean + rest.most_below + rest.most_above, 1e-6);
}

TEST(SkinParts, AJointsOwnPartGoesWithIt) {
  const SkinnedMesh skin = readGltfSkin(samples::armGlb(), "arm.glb");
  const std::vector<SkinPart> parts = cutSkin(skin, {});
  std::vector<JointTransform> locals = skin.skeleton.rest();
  skin.clips.at(0).pose(0.7, locals);
  const std::vector<Placement> world = skin.skeleton.place(locals);
  for (const SkinPart& part : parts) {
    const int joint = skin.skeleton.find(part.name);
    if (joint < 0) continue;
    const Pose pose = partPose(part, skin.bindingsAt(world));
    const Placement moved = world[static_cast<size_t>(joint)] *
                            skin.skeleton.place(skin.skeleton.rest())[static_cast<size_t>(joint)].inverse();
    for (const Vec3& p : part.mesh.positions)
      EXPECT_LT((pose.apply(p) - (moved * p.cast<double>()).cast<float>()).norm(), 1e-6f) << part.name;
  }
}

// docs/architecture.md, "Skinned bodies", has these numbers.
TEST(SkinParts, FollowABentArm) {
  for (const float blend : {0.03f, 0.06f, 0.1f})
    for (const int between : {0, SkinCut{}.between}) {
      const SkinnedMesh skin = readGltfSkin(samples::armGlb(broadArm(blend)), "arm.glb");
      const std::vector<SkinPart> parts = cutSkin(skin, {between, SkinCut{}.overlap});
      for (const double degrees : {15, 30, 45, 60}) {
        const Apart a = apart(bentAt(skin, parts, degrees / 60));
        std::printf(
            "weights go over in %3.0f mm, %zu parts, bent by %2.0f degrees: mean %.2f mm, %.1f below, %.1f "
            "above\n",
            2e3 * static_cast<double>(blend), parts.size(), degrees, 1e3 * a.mean, 1e3 * a.most_below,
            1e3 * a.most_above);
        if (between == 0) continue;
        EXPECT_LT(a.mean, 1e-3);
        EXPECT_LT(a.most_below, 3.2e-3);
        EXPECT_LT(a.most_above, 13e-3);
      }
    }
}

TEST(SkinParts, MoreJointsThanTheWireHasPlacesForGetFewerPartsBetween) {
  samples::ArmOptions options;
  options.joints.clear();
  for (int j = 0; j < 40; ++j) options.joints.push_back("joint" + std::to_string(j));
  options.bone = 0.05f;
  options.blend = 0.02f;
  options.sectors = 8;
  EXPECT_LE(cutSkin(readGltfSkin(samples::armGlb(options), "worm.glb"), {}).size(), kMostSkinParts);
  for (int j = 40; j < 120; ++j) options.joints.push_back("joint" + std::to_string(j));
  expectError([&] { cutSkin(readGltfSkin(samples::armGlb(options), "worm.glb"), {}); },
              {"worm.glb", "120 joints carry the mesh", "100 at most"});
}

}  // namespace
}  // namespace strandcast
