// Skins, skeletons and clips of glTF: what is read, and what is refused and how.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "groom/file_bytes.h"
#include "groom/mesh_file.h"
#include "groom/skinned_mesh.h"
#include "tests/groom/expect_error.h"
#include "tests/groom/sample_files.h"
#include "tests/groom/scratch_folder.h"
#include "tests/groom/skinned_arm.h"

namespace strandcast {
namespace {

using samples::armWith;
using samples::smallArm;

std::vector<Vec3> posed(const SkinnedMesh& skin, double seconds) {
  std::vector<JointTransform> locals = skin.skeleton.rest();
  skin.clips.at(0).pose(seconds, locals);
  return skin.blended(skin.skeleton.place(locals));
}

TEST(GltfSkin, AtRestTheMeshIsWhereItIsWithoutItsSkin) {
  for (const auto& bytes : {samples::armGlb(), samples::armGltf()}) {
    const SkinnedMesh skin = readGltfSkin(bytes, "arm.glb");
    const TriangleMesh rigid = readGltfMesh(bytes, "arm.glb").mesh;
    ASSERT_EQ(skin.mesh.positions.size(), rigid.positions.size());
    EXPECT_EQ(skin.mesh.triangles, rigid.triangles);
    for (size_t v = 0; v < rigid.positions.size(); ++v)
      EXPECT_LT((skin.mesh.positions[v] - rigid.positions[v]).norm(), 1e-6f);
    EXPECT_EQ(skin.skeleton.find("lower"), 2) << "the mesh's node lies before it";
    EXPECT_EQ(skin.skeleton.find("foot"), -1);
    ASSERT_EQ(skin.clips.size(), 1u);
    EXPECT_EQ(skin.clips[0].name, "bend");
    EXPECT_EQ(skin.clips[0].duration, 2);
  }
}

TEST(GltfSkin, ABodyWhoseJointsRestInAnotherPoseThanTheyWereBoundInIsReadWhereTheyAre) {
  const std::string bone = fmt::format(R"("name":"head","translation":[0,{},0])", smallArm().bone);
  const auto bytes = armWith(smallArm(), bone, bone + R"(,"rotation":[0,0,0.5,0.8660254])");
  const SkinnedMesh skin = readGltfSkin(bytes, "arm.gltf");
  const TriangleMesh rigid = readGltfMesh(bytes, "arm.gltf").mesh,
                     straight = readGltfMesh(samples::armGltf(smallArm()), "arm.gltf").mesh;
  EXPECT_EQ(rigid.positions, skin.mesh.positions);
  EXPECT_EQ(rigid.triangles, straight.triangles);
  float moved = 0;
  for (size_t v = 0; v < rigid.positions.size(); ++v)
    moved = std::max(moved, (rigid.positions[v] - straight.positions[v]).norm());
  EXPECT_GT(moved, 0.8f * smallArm().bone) << "its tip, by 60 degrees";
}

TEST(GltfSkin, VerticesGoWithTheirJointAndBlendBetween) {
  const samples::ArmOptions options;
  const SkinnedMesh skin = readGltfSkin(samples::armGlb(options), "arm.glb");
  const std::vector<Vec3> bent = posed(skin, 1);
  const Vec3 elbow(0, options.bone, 0);
  const Quat turn(Eigen::AngleAxisf(std::numbers::pi_v<float> / 3, Eigen::Vector3f::UnitZ()));
  size_t still = 0, turned = 0, blended = 0;
  for (size_t v = 0; v < bent.size(); ++v) {
    const Vec3 rest = skin.mesh.positions[v], moved = elbow + turn * (rest - elbow);
    const float from_elbow = rest.y() - elbow.y();
    if (from_elbow < -options.blend) {
      EXPECT_LT((bent[v] - rest).norm(), 1e-6f);
      ++still;
    } else if (from_elbow > options.blend) {
      EXPECT_LT((bent[v] - moved).norm(), 1e-6f);
      ++turned;
    } else {
      const float t = (from_elbow + options.blend) / (2 * options.blend);
      EXPECT_LT((bent[v] - rest - t * t * (3 - 2 * t) * (moved - rest)).norm(), 1e-6f);
      ++blended;
    }
  }
  EXPECT_GT(still, 500u);
  EXPECT_GT(turned, 500u);
  EXPECT_GT(blended, 200u);
}

TEST(GltfSkin, EightBitWeightsAreThoseOfFloatsWithinTheirStep) {
  samples::ArmOptions narrow;
  narrow.narrow_weights = true;
  const std::vector<Vec3> a = posed(readGltfSkin(samples::armGlb(), "arm.glb"), 1);
  const std::vector<Vec3> b = posed(readGltfSkin(samples::armGlb(narrow), "arm.glb"), 1);
  ASSERT_EQ(a.size(), b.size());
  float worst = 0;
  for (size_t v = 0; v < a.size(); ++v) worst = std::max(worst, (a[v] - b[v]).norm());
  EXPECT_LT(worst, 0.1f / 255);
  EXPECT_GT(worst, 0);
}

TEST(GltfSkin, EveryInterpolationIsThatOfTheSpecification) {
  const auto angle = [](const char* interpolation, double seconds) {
    samples::ArmOptions options;
    options.interpolation = interpolation;
    const SkinnedMesh skin = readGltfSkin(samples::armGltf(options), "arm.gltf");
    std::vector<JointTransform> locals = skin.skeleton.rest();
    skin.clips.at(0).pose(seconds, locals);
    const Quat q = locals[static_cast<size_t>(skin.skeleton.find("lower"))].rotation;
    EXPECT_NEAR(q.norm(), 1, 1e-5f);
    return 2 * std::atan2(q.z(), q.w()) * 180 / std::numbers::pi_v<float>;
  };
  EXPECT_NEAR(angle("STEP", 0.99), 0, 1e-3f);
  EXPECT_NEAR(angle("STEP", 1.01), 60, 1e-3f);
  EXPECT_NEAR(angle("LINEAR", 0.25), 15, 1e-3f);
  EXPECT_NEAR(angle("LINEAR", 1.25), 45, 1e-3f);
  // Tangents of zero: the value is Hermite's 3t^2 - 2t^3 between the quaternions, normalised.
  const float t = 0.15625f, half = std::numbers::pi_v<float> / 6;
  const float expected =
      2 * std::atan2(t * std::sin(half), 1 - t + t * std::cos(half)) * 180 / std::numbers::pi_v<float>;
  EXPECT_NEAR(angle("CUBICSPLINE", 0.25), expected, 1e-3f);
  for (const char* interpolation : {"STEP", "LINEAR", "CUBICSPLINE"}) {
    EXPECT_NEAR(angle(interpolation, -1), 0, 1e-3f);
    EXPECT_NEAR(angle(interpolation, 5), 0, 1e-3f) << "held after the last key";
    EXPECT_NEAR(angle(interpolation, 1), 60, 1e-2f);
  }
}

TEST(GltfSkin, WhatHangsOnANodeWithoutASkinMovesWithIt) {
  const auto bytes = armWith({}, R"({"mesh":0,"skin":0}],)", R"({"mesh":0,"skin":0},{"mesh":0}],)");
  std::string whole(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const std::string lower = R"({"name":"lower",)";
  whole.replace(whole.find(lower), lower.size(), R"({"name":"lower","children":[3],)");
  const SkinnedMesh both = readGltfSkin(samples::fromText(whole), "arm.gltf");
  const size_t alone = readGltfSkin(bytes, "arm.gltf").mesh.positions.size();  // the new node is in no scene
  ASSERT_EQ(both.mesh.positions.size(), 2 * alone);
  const std::vector<Vec3> bent = posed(both, 1);
  const Quat turn(Eigen::AngleAxisf(std::numbers::pi_v<float> / 3, Eigen::Vector3f::UnitZ()));
  const Vec3 elbow(0, 0.25f, 0);
  const size_t hung = (both.mesh.positions[0] - elbow - both.stored[0]).norm() < 1e-6f ? 0 : alone;
  for (size_t v = hung; v < hung + alone; ++v) {
    EXPECT_LT((both.mesh.positions[v] - elbow - both.stored[v]).norm(), 1e-6f);
    EXPECT_LT((bent[v] - elbow - turn * both.stored[v]).norm(), 1e-6f);
  }
}

void expectSkinError(const std::string& from, const std::string& to, const std::string& place) {
  expectError([&] { readGltfSkin(armWith(smallArm(), from, to), "arm.gltf"); }, {"arm.gltf", place});
}

TEST(GltfSkin, SkinsThatDoNotFitAreRefused) {
  expectSkinError(R"("skin":0)", R"("skin":1)", "there is no skins[1]");
  expectSkinError(R"(,"skin":0)", "", "no mesh of the scene has a skin");
  expectSkinError(R"("joints":[0,1])", R"("joints":[])", "skins[0]");
  expectSkinError(R"("joints":[0,1])", R"("joints":[0,9])", "joint 1 is no node");
  expectSkinError(R"("joints":[0,1])", R"("joints":[0])", "hangs on joint 1 of 1");
  expectSkinError(R"("joints":[0,1])", R"("joints":[0,1,1])", "fewer inverse bind matrices");
  expectSkinError(R"("inverseBindMatrices":4)", R"("inverseBindMatrices":5)", "accessors[5]");
  expectSkinError(R"("JOINTS_0":2,)", "", "no JOINTS_0");
  expectSkinError(R"("JOINTS_0":2)", R"("JOINTS_0":3)", "8 or 16 bits");
  expectSkinError(R"("JOINTS_0":2)", R"("JOINTS_0":2,"JOINTS_1":2)", "more than four weights");
  expectSkinError(R"("WEIGHTS_0":3)", R"("WEIGHTS_0":2)", "neither 32-bit floats nor normalised");
  expectSkinError(R"("WEIGHTS_0":3)", R"("WEIGHTS_0":6)", "are not those of");
  expectSkinError(R"("translation":[0,0.25,0])", R"("matrix":[1,0,0,0,0.5,1,0,0,0,0,1,0,0,0,0,1])", "shears");
  expectSkinError(R"("translation":[0,0.25,0])", R"("matrix":[0,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1])",
                  "no inverse");
}

TEST(GltfSkin, ClipsThatDoNotFitAreRefused) {
  expectSkinError(R"("sampler":0)", R"("sampler":1)", "animations[0].samplers[1]");
  expectSkinError(R"("path":"rotation")", R"("path":"colour")", "animations[0].channels[0]");
  expectSkinError(R"("path":"rotation")", R"("path":"scale")", "VEC3");
  expectSkinError(R"("node":1,)", R"("node":7,)", "animations[0].channels[0]");
  expectSkinError(R"("input":5)", R"("input":6)", "accessors[6]");
  expectSkinError(R"("input":5)", R"("input":1)", "do not fit");
  expectSkinError(R"("LINEAR")", R"("CUBICSPLINE")", "do not fit 3 keys");
  expectSkinError(R"("LINEAR")", R"("WAVY")", "not STEP, LINEAR or CUBICSPLINE");
  expectSkinError(R"("channels":[{)", R"("channels":[{"sampler":0,"target":{"node":1,"path":"rotation"}},{)",
                  "two channels");
  expectSkinError(R"({"name":"head","translation":[0,0.25,0]})",
                  R"({"name":"head","matrix":[1,0,0,0,0,1,0,0,0,0,1,0,0,0.25,0,1]})", "cannot be animated");
  samples::ArmOptions backwards = smallArm();
  backwards.seconds = -1;
  expectError([&] { readGltfSkin(samples::armGlb(backwards), "arm.glb"); }, {"arm.glb", "key 1"});
  backwards.seconds = 0;
  expectError([&] { readGltfSkin(samples::armGlb(backwards), "arm.glb"); }, {"key 1 is not later"});
}

TEST(LoadSkin, UnitsAndAxesMoveTheWholeSkeleton) {
  const ScratchFolder folder;
  writeFileBytes(folder / "arm.glb", samples::armGlb());
  const SkinnedMesh plain = loadSkinnedMesh(folder / "arm.glb", {});
  const SkinnedMesh turned = loadSkinnedMesh(folder / "arm.glb", {0.1f, UpAxis::kZ});
  const std::vector<Vec3> a = posed(plain, 1), b = posed(turned, 1);
  for (size_t v = 0; v < a.size(); ++v)
    EXPECT_LT((0.1f * Vec3(a[v].x(), a[v].z(), -a[v].y()) - b[v]).norm(), 1e-6f);
  expectError([&] { loadSkinnedMesh(folder / "arm.obj", {}); }, {"arm.obj", "no skins"});
  expectError([&] { loadSkinnedMesh(folder / "arm.glb", {1e9f, UpAxis::kAuto}); }, {"arm.glb", "10 km"});
}

}  // namespace
}  // namespace strandcast
