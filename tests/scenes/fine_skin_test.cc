// Refinement of a coarse skin into triangles over which weights change little.
#include "collision/skin_parts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "collision/mesh_query.h"
#include "tests/io/skinned_arm.h"

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
}  // namespace strandcast
