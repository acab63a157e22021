// Skins, skeletons and clips of glTF: what is read, and what is refused with which error.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <tuple>

#include "io/file_bytes.h"
#include "io/mesh_file.h"
#include "io/skinned_mesh.h"
#include "tests/expect_error.h"
#include "tests/io/gltf_builder.h"
#include "tests/io/sample_files.h"
#include "tests/io/scratch_folder.h"
#include "tests/io/skinned_arm.h"

namespace strandcast {
namespace {

using samples::armWith;
using samples::smallArm;

std::vector<Vec3> posed(const SkinnedMesh& skin, double seconds) {
  std::vector<JointTransform> locals = skin.skeleton.rest();
  skin.clips.at(0).pose(seconds, locals);
  return skin.blended(skin.skeleton.worldTransforms(locals));
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
  // No scene contains the new node.
  const size_t alone = readGltfSkin(bytes, "arm.gltf").mesh.positions.size();
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
  expectSkinError(R"("WEIGHTS_0":3)", R"("WEIGHTS_0":2)", "neither 32-bit floats nor normalised");
  expectSkinError(R"("WEIGHTS_0":3)", R"("WEIGHTS_0":6)", "are not those of");
  expectSkinError(R"("translation":[0,0.25,0])", R"("matrix":[1,0,0,0,0.5,1,0,0,0,0,1,0,0,0,0,1])", "shears");
  expectSkinError(R"("translation":[0,0.25,0])", R"("matrix":[0,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1])",
                  "no inverse");
}

/// The body is read without the clip, and the report gives the reason.
void expectNoClip(const samples::Bytes& bytes, const std::string& why) {
  const SkinnedMesh skin = readGltfSkin(bytes, "arm.gltf");
  EXPECT_TRUE(skin.clips.empty()) << why;
  ASSERT_EQ(skin.report.left_out.size(), 1u) << why;
  EXPECT_NE(skin.report.left_out[0].find("animations that cannot be read"), std::string::npos);
  EXPECT_NE(skin.report.left_out[0].find(why), std::string::npos) << skin.report.left_out[0];
}
void expectNoClip(const std::string& from, const std::string& to, const std::string& why) {
  expectNoClip(armWith(smallArm(), from, to), why);
}

TEST(GltfSkin, ClipsThatDoNotFitAreLeftOutAndSaid) {
  expectNoClip(R"("sampler":0)", R"("sampler":1)", "animations[0].samplers[1]");
  expectNoClip(R"("path":"rotation")", R"("path":"colour")", "animations[0].channels[0]");
  expectNoClip(R"("path":"rotation")", R"("path":"scale")", "VEC3");
  expectNoClip(R"("node":1,)", R"("node":7,)", "animations[0].channels[0]");
  expectNoClip(R"("input":5)", R"("input":6)", "accessors[6]");
  expectNoClip(R"("input":5)", R"("input":1)", "do not fit");
  expectNoClip(R"("LINEAR")", R"("CUBICSPLINE")", "do not fit 3 keys");
  expectNoClip(R"("LINEAR")", R"("WAVY")", "not STEP, LINEAR or CUBICSPLINE");
  expectNoClip(R"("channels":[{)", R"("channels":[{"sampler":0,"target":{"node":1,"path":"rotation"}},{)",
               "two channels");
  expectNoClip(R"({"name":"head","translation":[0,0.25,0]})",
               R"({"name":"head","matrix":[1,0,0,0,0,1,0,0,0,0,1,0,0,0.25,0,1]})", "cannot be animated");
  samples::ArmOptions backwards = smallArm();
  backwards.seconds = -1;
  expectNoClip(samples::armGlb(backwards), "key 1");
  backwards.seconds = 0;
  expectNoClip(samples::armGlb(backwards), "key 1 is not later");
}

/// A tetrahedron on nine joints side by side along x, with these sets of weights.
SkinnedMesh onNineJoints(const std::vector<std::array<uint8_t, 16>>& joints,
                         const std::vector<std::array<float, 16>>& weights) {
  samples::GltfBuilder builder;
  std::string attributes = fmt::format(R"("POSITION":{})", builder.points(samples::tetrahedron()));
  for (size_t set = 0; set < joints.size(); ++set) {
    const std::vector<uint8_t> numbers(joints[set].begin(), joints[set].end());
    attributes += fmt::format(
        R"(,"JOINTS_{}":{})", set,
        builder.accessor(fmt::format(R"("bufferView":{},"componentType":5121,"count":4,"type":"VEC4")",
                                     builder.view(numbers))));
    if (set >= weights.size()) continue;
    attributes += fmt::format(R"(,"WEIGHTS_{}":{})", set,
                              builder.floats({weights[set].begin(), weights[set].end()}, "VEC4"));
  }
  const size_t indices = builder.indices(samples::tetrahedronTriangles());
  std::string nodes = R"({"mesh":0,"skin":0})", list;
  for (int j = 0; j < 9; ++j) {
    nodes += fmt::format(R"(,{{"name":"j{}"}})", j);
    list += fmt::format("{}{}", j > 0 ? "," : "", j + 1);
  }
  return readGltfSkin(
      builder.gltf(fmt::format(R"("nodes":[{}],"skins":[{{"joints":[{}]}}],)", nodes, list) +
                   fmt::format(R"("meshes":[{{"primitives":[{{"attributes":{{{}}},"indices":{}}}]}}])",
                               attributes, indices)),
      "body.gltf");
}
std::map<std::string, float> weightsOf(const SkinnedMesh& skin, size_t vertex) {
  std::map<std::string, float> weights;
  for (const auto& [binding, weight] : skin.influences[vertex])
    if (weight > 0) weights[skin.skeleton.joints[skin.bindings[binding].joint].name] += weight;
  return weights;
}
void expectWeights(const SkinnedMesh& skin, size_t vertex, const std::map<std::string, float>& expected) {
  const std::map<std::string, float> found = weightsOf(skin, vertex);
  ASSERT_EQ(found.size(), expected.size()) << "vertex " << vertex;
  for (const auto& [joint, weight] : expected) EXPECT_NEAR(found.at(joint), weight, 1e-6f) << vertex << joint;
}

TEST(GltfSkin, OfAnyNumberOfWeightsTheFourLargestAreKept) {
  const SkinnedMesh skin = onNineJoints({{0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 5, 5, 0, 0},
                                         {4, 5, 6, 7, 4, 0, 0, 0, 4, 5, 6, 7, 6, 6, 6, 6},
                                         {8, 0, 0, 0, 0, 0, 0, 0, 8, 0, 0, 0, 7, 8, 1, 2}},
                                        {{0.1f, 0.1f, 0.02f, 0.05f, 0.5f, 0.3f, 0.1f, 0.05f,  //
                                          0, 0, 0, 0, 0.1f, 0.1f, 0, 0},
                                         {0.3f, 0.2f, 0.08f, 0.05f, 0.05f, 0, 0, 0,  //
                                          0.25f, 0.25f, 0, 0, 0.1f, 0.1f, 0.1f, 0.1f},
                                         {0.1f, 0, 0, 0, 0, 0, 0, 0,  //
                                          0.5f, 0, 0, 0, 0.05f, 0.15f, 0.1f, 0.1f}});
  expectWeights(skin, 0, {{"j4", 3 / 7.0f}, {"j5", 2 / 7.0f}, {"j0", 1 / 7.0f}, {"j1", 1 / 7.0f}});
  expectWeights(skin, 1,
                {{"j0", 0.5f / 0.95f}, {"j1", 0.3f / 0.95f}, {"j2", 0.1f / 0.95f}, {"j3", 0.05f / 0.95f}});
  expectWeights(skin, 2, {{"j8", 0.5f}, {"j4", 0.25f}, {"j5", 0.25f}});
  expectWeights(skin, 3,
                {{"j6", 0.4f / 0.85f}, {"j5", 0.2f / 0.85f}, {"j8", 0.15f / 0.85f}, {"j1", 0.1f / 0.85f}});
  ASSERT_EQ(skin.report.left_out.size(), 1u);
  EXPECT_EQ(skin.report.left_out[0], "the weights beyond the four largest of 3 vertices, of 0.100 at most");
}

TEST(GltfSkin, OddWeightsAreMendedAndSaid) {
  const SkinnedMesh skin = onNineJoints(
      {{3, 1, 0, 0, 1, 0, 0, 0, 2, 4, 0, 0, 5, 0, 0, 0}, {0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3}},
      {{0, 0, 0, 0, 1, -0.25f, 0, 0, 1, 3, 0, 0, 200, 0, 0, 0}});
  expectWeights(skin, 0, {{"j0", 1}});
  expectWeights(skin, 1, {{"j1", 1}});
  expectWeights(skin, 2, {{"j2", 0.25f}, {"j4", 0.75f}});
  expectWeights(skin, 3, {{"j5", 1}});
  ASSERT_EQ(skin.report.warnings.size(), 2u);
  EXPECT_NE(skin.report.warnings[0].find("1 weights below 0"), std::string::npos);
  EXPECT_NE(skin.report.warnings[1].find("1 vertices have no weight"), std::string::npos);
  EXPECT_NE(skin.report.left_out.at(0).find("JOINTS_1, as there is no WEIGHTS_1"), std::string::npos);
}

samples::ArmOptions swellingArm() {
  samples::ArmOptions options = smallArm();
  options.sectors = 12;
  options.spacing = 0.03f;
  options.bulge = 0.05f;
  return options;
}
std::vector<Vec3> swollen(const SkinnedMesh& skin, double seconds) {
  std::vector<float> weights = skin.restWeights();
  skin.clips.back().weigh(seconds, weights);
  return skin.blended(skin.skeleton.worldTransforms(skin.skeleton.rest()), weights);
}

TEST(GltfMorphs, OfClipsMoveTheSkinBeforeItIsBlended) {
  for (const float rest : {0.0f, 0.5f, -1.0f})
    for (const bool skinned : {true, false}) {
      samples::ArmOptions options = swellingArm();
      options.bulge_at_rest = rest;
      options.skinned = skinned;
      const SkinnedMesh skin = readGltfSkin(samples::armGlb(options), "arm.glb");
      options.bulge = 0;
      options.skinned = true;
      const SkinnedMesh plain = readGltfSkin(samples::armGlb(options), "arm.glb");
      ASSERT_EQ(skin.targets.size(), 1u);
      EXPECT_EQ(skin.targets[0].name, "bulge");
      EXPECT_EQ(skin.clips.size(), 2u);
      EXPECT_EQ(skin.clips[1].duration, 2);
      const TriangleMesh rigid = readGltfMesh(samples::armGlb([&] {
                                                samples::ArmOptions again = swellingArm();
                                                again.bulge_at_rest = rest;
                                                again.skinned = skinned;
                                                return again;
                                              }()),
                                              "arm.glb")
                                     .mesh;
      const std::vector<Vec3> none = swollen(skin, 0), half = swollen(skin, 0.5), all = swollen(skin, 1);
      float most = 0;
      for (size_t v = 0; v < none.size(); ++v) {
        const Vec3 bulge = samples::bulgeAt(swellingArm(), plain.mesh.positions[v]),
                   at = plain.mesh.positions[v];
        EXPECT_LT((skin.mesh.positions[v] - at - rest * bulge).norm(), 1e-6f);
        EXPECT_LT((rigid.positions[v] - at - rest * bulge).norm(), 1e-6f);
        EXPECT_LT((none[v] - at).norm(), 1e-6f);
        EXPECT_LT((half[v] - at - 0.5f * bulge).norm(), 1e-6f);
        EXPECT_LT((all[v] - at - bulge).norm(), 1e-6f);
        most = std::max(most, bulge.norm());
      }
      EXPECT_GT(most, 0.04f);
    }
  // When the joint bends, the bulge rotates with it.
  const SkinnedMesh skin = readGltfSkin(samples::armGlb(swellingArm()), "arm.glb");
  std::vector<JointTransform> locals = skin.skeleton.rest();
  skin.clips[0].pose(1, locals);
  const std::vector<Placement> world = skin.skeleton.worldTransforms(locals);
  const std::vector<Vec3> bent = skin.blended(world), both = skin.blended(world, std::vector<float>{1});
  const Quat turn(Eigen::AngleAxisf(std::numbers::pi_v<float> / 3, Eigen::Vector3f::UnitZ()));
  for (size_t v = 0; v < bent.size(); ++v) {
    const Vec3 rest = skin.mesh.positions[v];
    if (rest.y() > swellingArm().bone + swellingArm().blend) {
      EXPECT_LT((both[v] - bent[v] - turn * samples::bulgeAt(swellingArm(), rest)).norm(), 1e-6f);
    }
  }
}

TEST(GltfMorphs, BindingsOfTargetsAddUpToTheBlendedSkin) {
  const SkinnedMesh skin = readGltfSkin(samples::armGlb(swellingArm()), "arm.glb");
  std::vector<JointTransform> locals = skin.skeleton.rest();
  skin.clips[0].pose(0.7, locals);
  const std::vector<Placement> world = skin.skeleton.worldTransforms(locals);
  const std::vector<float> weights{0.8f};
  const std::vector<Placement> bindings = skin.bindingsAt(world, weights);
  ASSERT_EQ(bindings.size(), skin.bindings.size() + skin.target_bindings.size());
  std::vector<Vec3> sums = skin.blended(world);
  for (size_t i = 0; i < skin.target_bindings.size(); ++i)
    for (const auto& [vertex, by] : skin.targets[skin.target_bindings[i].target].moves)
      for (const auto& [binding, weight] : skin.influences[vertex])
        if (binding == skin.target_bindings[i].binding)
          sums[vertex] +=
              weight * (bindings[skin.bindings.size() + i].linear() * by.cast<double>()).cast<float>();
  const std::vector<Vec3> blended = skin.blended(world, weights);
  for (size_t v = 0; v < sums.size(); ++v) EXPECT_LT((sums[v] - blended[v]).norm(), 1e-6f);
}

TEST(GltfMorphs, WeightsGoOverAsTheInterpolationSays) {
  for (const auto& [interpolation, quarter, late] :
       {std::tuple{"STEP", 0.0f, 1.0f}, {"LINEAR", 0.25f, 0.75f}, {"CUBICSPLINE", 0.15625f, 0.84375f}}) {
    samples::ArmOptions options = swellingArm();
    options.interpolation = interpolation;
    const SkinnedMesh skin = readGltfSkin(samples::armGlb(options), "arm.glb");
    std::vector<float> weights{7};
    for (const auto& [seconds, expected] :
         {std::pair{-1.0, 0.0f}, {0.25, quarter}, {1.0, 1.0f}, {1.25, late}, {9.0, 0.0f}}) {
      skin.clips.at(1).weigh(seconds, weights);
      EXPECT_NEAR(weights[0], expected, 1e-6f) << interpolation << " at " << seconds;
    }
  }
}

TEST(GltfMorphs, ThatCannotBePlayedAreLeftOutAndTheRestOfTheClipIsPlayed) {
  const samples::ArmOptions options = swellingArm();
  const std::string weights = fmt::format(
      R"("channels":[{{"sampler":0,"target":{{"node":{},"path":"weights"}})", options.joints.size());
  const auto read = [&](const std::string& from, const std::string& to) {
    return readGltfSkin(armWith(options, from, to), "arm.gltf");
  };
  for (const auto& [from, to, words] :
       {std::tuple{R"("input":5,"output":8)", R"("input":5,"output":1)",
                   "weights do not fit 3 keys of 1 targets"},
        {R"("input":5,"output":8)", R"("input":5,"output":7)", "cannot be read"},
        {R"("input":5,"output":8)", R"("input":5,"output":88)", "there is no accessors[88]"},
        {R"("input":5,"output":8)", R"("output":8)", "no input"}}) {
    const SkinnedMesh skin = read(from, to);
    EXPECT_EQ(skin.clips.size(), 1u) << "nothing else is in the clip that swells";
    EXPECT_TRUE(skin.targets.empty());
    ASSERT_EQ(skin.report.left_out.size(), 1u);
    EXPECT_NE(skin.report.left_out[0].find(words), std::string::npos) << skin.report.left_out[0];
    EXPECT_NE(skin.report.left_out[0].find("animations[1].channels[0]"), std::string::npos);
  }
  const SkinnedMesh twice = read(weights, weights + "}," + weights.substr(weights.find('[') + 1));
  EXPECT_EQ(twice.clips.at(1).morphs.size(), 1u);
  EXPECT_NE(twice.report.left_out.at(0).find("second channels of the weights"), std::string::npos);
  const SkinnedMesh pointer = read(R"("path":"weights")", R"("path":"pointer")");
  EXPECT_NE(pointer.report.left_out.at(0).find("KHR_animation_pointer"), std::string::npos);
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

TEST(SkinReader, ARefusedMorphClipSaysWhy) {
  samples::ArmOptions options = samples::smallArm();
  options.bulge = 0.01f;
  options.skinned = false;
  const auto refused = [&](const std::string& from, const std::string& to, const std::string& why) {
    const auto bytes = samples::armWith(options, from, to);
    expectError([&] { readGltfSkin(bytes, "face.gltf"); },
                {"no mesh of the scene has a skin or morph targets that are animated, read without", why,
                 "face.gltf"});
  };
  refused(R"("output":8)", R"("output":1)", "do not fit");
  refused(R"("output":8)", R"("output":99)", "there is no accessors[99]");
  refused(R"("interpolation":"LINEAR"}]}],)", R"("interpolation":"CURVED"}]}],)",
          "the interpolation is not STEP, LINEAR or CUBICSPLINE");
  refused(R"("node":2,"path":"weights")", R"("node":1,"path":"weights")",
          "weights of morph targets of nodes without a mesh (animations[1].channels[0])");
  options.skinned = true;
  const auto still = samples::armWith(
      options, R"("channels":[{"sampler":0,"target":{"node":2,"path":"weights"}}])", R"("channels":[])");
  const std::vector<std::string> told = readGltfSkin(still, "face.gltf").report.left_out;
  EXPECT_NE(std::find(told.begin(), told.end(), "animations that move nothing of the scene (animations[1])"),
            told.end());
}

}  // namespace
}  // namespace strandcast
