// Skinned bodies in scenes: clips of their own, BVH clips, the head's motion, and hair that rests on them.
#include "scenes/skinned_body.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <optional>

#include "collision/mesh_query.h"
#include "io/file_bytes.h"
#include "io/mesh_file.h"
#include "tests/expect_error.h"
#include "tests/io/sample_files.h"
#include "tests/io/scratch_folder.h"
#include "tests/io/skinned_arm.h"
#include "tests/scenes/furry_arm.h"

namespace strandcast {
namespace {

SkinnedBody arm(const SkinnedMotion& motion, const samples::ArmOptions& options = {}) {
  return SkinnedBody(readGltfSkin(samples::armGlb(options), "arm.glb"), motion);
}

double worstBetween(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  float worst = 0;
  for (size_t v = 0; v < a.size(); ++v) worst = std::max(worst, (a[v] - b[v]).norm());
  return static_cast<double>(worst);
}

TEST(SkinnedBody, AClipStartsFromRestAndLoopsWithoutAJump) {
  const SkinnedBody body = arm({"bend", "lower"});
  EXPECT_EQ(body.duration(), 2);
  EXPECT_LT(worstBetween(body.surface(0, {}), body.skin().mesh.positions), 1e-6);
  EXPECT_GT(worstBetween(body.surface(1, {}), body.skin().mesh.positions), 0.2) << "60 degrees";
  const double step = 1e-3;
  for (double t = 0; t < 5; t += step)
    ASSERT_LT(worstBetween(body.surface(t, {}), body.surface(t + step, {})), 2.5 * step) << t;
}

TEST(SkinnedBody, TheHeadsMotionTurnsItsJointAndWhatHangsOnIt) {
  samples::ArmOptions options;
  options.joints = {"chest", "Head", "hat"};
  options.bone = 0.15f;
  const SkinnedBody body = arm({}, options);
  EXPECT_EQ(body.joint(), "Head");
  EXPECT_LT((body.pivot() - Vec3(0, 0.15f, 0)).norm(), 1e-6f);
  EXPECT_FALSE(body.hasClip());
  const Pose head = proceduralMotion("turn", body.pivot())(1.25);
  const std::vector<Vec3> turned = body.surface(1.25, head);
  const std::vector<float> weights = body.jointWeights();
  for (size_t v = 0; v < turned.size(); ++v) {
    const Vec3 rest = body.skin().mesh.positions[v];
    EXPECT_LT((turned[v] - rest - weights[v] * (head.apply(rest) - rest)).norm(), 1e-6f);
  }
  EXPECT_EQ(weights.front(), 0) << "the bottom is the chest's";
  EXPECT_EQ(weights.back(), 1) << "the top is the hat's";
}

/// A clip with joints of the same names as an arm's at other offsets; the lower one rotates about Z.
std::string bendingBvh(const std::string& upper, const std::string& lower, int side = 1) {
  std::string text =
      "HIERARCHY\nROOT " + upper + "\n{\nOFFSET 0 0 0\nCHANNELS 3 Xposition Yposition Zposition\nJOINT " +
      lower +
      "\n{\nOFFSET 0 100 0\nCHANNELS 3 Zrotation Xrotation Yrotation\nEnd Site\n{\nOFFSET 0 70 0\n}\n}\n}\n";
  text += "MOTION\nFrames: 61\nFrame Time: 0.03333333\n";
  for (int f = 0; f <= 60; ++f)
    text += std::to_string(f) + " 0 0 " + std::to_string(side * (60 - 2 * std::abs(f - 30))) + " 0 0\n";
  return text;
}

TEST(SkinnedBody, ABvhClipMovesTheJointsOfItsNames) {
  const ScratchFolder folder;
  std::ofstream(folder / "Bend.BVH") << bendingBvh("upper", "lower");
  const SkinnedBody bvh = arm({(folder / "Bend.BVH").string(), "lower"}), own = arm({"bend", "lower"});
  ASSERT_EQ(bvh.notes().size(), 3u);
  EXPECT_EQ(bvh.notes()[2],
            "the clip " + (folder / "Bend.BVH").string() +
                ": 'upper' travels 0.15 m from the first frame to the last, which is taken out to "
                "play it in place");
  EXPECT_TRUE(own.notes().empty()) << "its clip comes back";
  EXPECT_NE(bvh.notes()[0].find("its unit is guessed: 0.0025 m, the ratio of 1 bone"), std::string::npos)
      << bvh.notes()[0];
  EXPECT_NE(bvh.notes()[1].find("2 of 3 joints"), std::string::npos) << bvh.notes()[1];
  for (const double t : {0.2, 0.5, 0.75, 0.9, 1.5})  // not at the reversal, which the spline smooths
    EXPECT_LT(worstBetween(bvh.surface(t, {}), own.surface(t, {})), 1e-3) << t << ": travel is taken out";
  std::ofstream(folder / "other.bvh") << bendingBvh("Hips", "Spine");
  expectError(
      [&] {
        arm({(folder / "other.bvh").string(), "lower"});
      },
      {"other.bvh", "no joint of the clip"});
}

TEST(SkinnedBody, AMirroredSkeletonMovesAsTheMirrorImage) {
  const auto mirrored = [](const std::string& clip) {
    const std::string upper = R"("name":"upper","translation":[0,0,0])";
    const auto gltf = samples::armWith({}, upper, upper + R"(,"scale":[-1,1,1])");
    return SkinnedBody(readGltfSkin(gltf, "arm.gltf"), {clip, "lower"});
  };
  const auto image = [](const Vec3& p) { return Vec3(-p.x(), p.y(), p.z()); };
  const ScratchFolder folder;
  const std::string left = (folder / "left.bvh").string(), right = (folder / "right.bvh").string();
  std::ofstream(left) << bendingBvh("upper", "lower");
  std::ofstream(right) << bendingBvh("upper", "lower", -1);
  for (const auto& [clip, image_clip] :
       {std::pair<std::string, std::string>{"bend", "bend"}, {left, right}}) {
    const SkinnedBody plain = arm({clip, "lower"}), other = mirrored(image_clip);
    const Pose head = proceduralMotion("nod", plain.pivot())(0.3);  // about X, like its mirror image
    for (const double t : {0.0, 0.3, 0.7, 1.2}) {
      std::vector<Vec3> images;
      for (const Vec3& p : plain.surface(t, head)) images.push_back(image(p));
      EXPECT_LT(worstBetween(images, other.surface(t, head)), 1e-5) << clip << " at " << t;
      const Pose a = plain.carried(t), b = other.carried(t);
      for (const Vec3& p : {Vec3(0, 0.5f, 0), Vec3(0.1f, 0, 0.2f)})
        EXPECT_LT((image(a.apply(p)) - b.apply(image(p))).norm(), 1e-5f) << clip << " at " << t;
      const auto parts = plain.placedParts(plain.at(t, head)),
                 other_parts = other.placedParts(other.at(t, head));
      for (size_t i = 0; i < parts.size(); ++i) {
        const Vec3 p = plain.pivot();
        EXPECT_LT((image(parts[i].pose.apply(p)) - other_parts[i].pose.apply(p)).norm(), 1e-5f);
      }
    }
  }
}

samples::ArmOptions swellingArm(bool skinned = true) {
  samples::ArmOptions options;
  options.spacing = 0.02f;
  options.bulge = 0.01f;
  options.skinned = skinned;
  return options;
}

TEST(SkinnedBody, AClipOfMorphTargetsStartsFromRestAndLoopsWithoutAJump) {
  for (const float rest : {0.0f, 1.0f}) {
    samples::ArmOptions options = swellingArm();
    options.bulge_at_rest = rest;
    const SkinnedBody body = arm({"swell", "lower"}, options);
    EXPECT_TRUE(body.hasClip());
    EXPECT_EQ(body.notes().back(), "the clip plays 1 morph targets (bulge)");
    const std::vector<Vec3>& still = body.skin().mesh.positions;
    EXPECT_LT(worstBetween(body.surface(0, {}), still), 1e-7);
    const std::vector<Vec3> swollen = body.surface(1, {}), shrunk = body.surface(2, {});
    float most = 0;
    for (size_t v = 0; v < still.size(); ++v) {
      if (rest == 0) {
        EXPECT_LT((swollen[v] - still[v] - samples::bulgeAt(options, still[v])).norm(), 1e-6f);
      }
      most = std::max(most, (swollen[v] - shrunk[v]).norm());
    }
    EXPECT_NEAR(most, 0.01f, 1e-3f);
    for (double t = 0; t < 2.5; t += 5e-3)
      ASSERT_LT(worstBetween(body.surface(t, {}), body.surface(t + 5e-3, {})), 4e-4) << t;
  }
}

TEST(SkinnedBody, WithoutASkinIsOneWhereItsMorphTargetsArePlayed) {
  const SkinnedBody body = arm({"swell", ""}, swellingArm(false));
  EXPECT_EQ(body.joint(), "figure") << "nothing else carries it";
  EXPECT_GT(worstBetween(body.surface(1, {}), body.skin().mesh.positions), 9e-3);
  const Pose head{Vec3(0.1f, 0, 0), Quat(Eigen::AngleAxisf(0.5f, Vec3::UnitY()))};
  const std::vector<Vec3> swollen = body.surface(1, {}), moved = body.surface(1, head);
  for (size_t v = 0; v < moved.size(); ++v) EXPECT_LT((moved[v] - head.apply(swollen[v])).norm(), 1e-6f);
  size_t bent = 0;
  for (const SkinnedBody::PlacedPart& part : body.placedParts(body.at(1, head))) bent += !part.bend.isNone();
  EXPECT_GT(bent, 0u);
  EXPECT_LT(bent, body.parts().size()) << "the rest of it is rigid";
}

TEST(SkinnedBody, ClipsThatPlayNoMorphTargetLeaveThemAtRest) {
  samples::ArmOptions options = swellingArm();
  const SkinnedBody body = arm({"bend", "lower"}, options), still = arm({"", "lower"}, options);
  options.bulge = 0;
  const SkinnedBody plain = arm({"bend", "lower"}, options);
  EXPECT_EQ(body.parts().size(), plain.parts().size());
  EXPECT_EQ(still.parts().size(), plain.parts().size());
  EXPECT_EQ(body.surface(1, {}), plain.surface(1, {}));
}

TEST(SkinnedBody, HasAllMorphTargetsWhereProgramsAreToWeighThem) {
  const samples::ArmOptions options = swellingArm();
  // A file whose clips play none.
  const std::vector<std::byte> file = samples::armWith(options, R"("path":"weights")", R"("path":"pointer")");
  EXPECT_TRUE(readGltfSkin(file, "arm.gltf").targets.empty());
  SkinnedMotion motion{"bend", "lower"};
  motion.targets = BodyTargets::kAll;
  for (const bool is_played : {true, false}) {
    const SkinnedBody body(
        readGltfSkin(is_played ? samples::armGlb(options) : file, "arm.gltf", {}, motion.targets), motion);
    ASSERT_EQ(body.skin().targets.size(), 1u);
    EXPECT_EQ(body.skin().targets[0].name, "bulge");
    EXPECT_EQ(body.notes().back(), "the skin has 1 morph targets (bulge)");
    EXPECT_EQ(body.surface(0, {}), arm({"bend", "lower"}, options).surface(0, {}));
    const SkinnedBody::Moment moment = body.at(0, {}, std::vector<float>{0.5f});
    const std::vector<Vec3> swollen = body.skin().blended(moment.joints, moment.weights);
    const std::vector<Vec3>& still = body.skin().mesh.positions;
    float most = 0;
    for (size_t v = 0; v < still.size(); ++v) {
      EXPECT_LT((swollen[v] - still[v] - 0.5f * samples::bulgeAt(options, still[v])).norm(), 1e-6f);
      most = std::max(most, (swollen[v] - still[v]).norm());
    }
    EXPECT_GT(most, 4e-3f);
    size_t bent = 0;
    for (const SkinnedBody::PlacedPart& part : body.placedParts(moment)) bent += !part.bend.isNone();
    EXPECT_GT(bent, 0u) << "contact follows";
  }
}

TEST(SkinnedBody, AFileNamesItsRigWhetherItIsReadOrNot) {
  const std::vector<std::byte> file = samples::armGlb(swellingArm());
  const BodyRig skinned = readGltfSkin(file, "arm.glb").rig, rigid = readGltfMesh(file, "arm.glb").rig;
  for (const BodyRig& rig : {skinned, rigid}) {
    EXPECT_EQ(std::count(rig.joints.begin(), rig.joints.end(), "upper"), 1);
    EXPECT_EQ(std::count(rig.joints.begin(), rig.joints.end(), "lower"), 1);
    EXPECT_EQ(rig.targets, std::vector<std::string>{"bulge"});
  }
  EXPECT_TRUE(readGltfMesh(samples::armGlb(swellingArm(false)), "arm.glb").rig.joints.empty()) << "no skin";
}

using Palette = std::vector<std::optional<Placement>>;

Placement placementOf(const Pose& pose) {
  Placement out = Placement::Identity();
  out.translate(pose.position.cast<double>());
  out.rotate(pose.rotation.cast<double>());
  return out;
}

/// Motions from rest of all joints at a time of the clip, rounded to seven floats a joint as on the wire.
Palette paletteOf(const SkinnedBody& body, double seconds) {
  const Skeleton& skeleton = body.skin().skeleton;
  const std::vector<Placement> rest = skeleton.worldTransforms(skeleton.rest()),
                               joints = body.at(seconds, {}).joints;
  Palette palette;
  for (size_t j = 0; j < joints.size(); ++j) {
    const Placement motion = joints[j] * rest[j].inverse();
    palette.emplace_back(
        placementOf({Vec3(motion.translation().cast<float>()), nearestRotation(motion.linear())}));
  }
  return palette;
}

TEST(SkinnedBody, JointsWithoutAMotionFollowTheirNearestAncestorThatHasOne) {
  samples::ArmOptions options;
  options.joints = {"hips", "spine", "neck", "head", "hat"};
  const SkinnedBody body = arm({}, options);
  const Skeleton& skeleton = body.skin().skeleton;
  const std::vector<Placement> rest = skeleton.worldTransforms(skeleton.rest());
  const auto index = [&](const char* name) { return static_cast<size_t>(skeleton.find(name)); };
  const Placement spine = placementOf({Vec3(0.1f, 0, 0.3f), Quat(Eigen::AngleAxisf(0.5f, Vec3::UnitX()))}),
                  head = placementOf({Vec3(0, 0.2f, 0), Quat(Eigen::AngleAxisf(-0.7f, Vec3::UnitY()))});
  Palette palette(skeleton.joints.size());
  palette[index("spine")] = spine;
  palette[index("head")] = head;
  const SkinnedBody::Moment moment = body.fromPalette(palette, {}, {});
  for (const auto& [joint, motion] : {std::pair{"hips", Placement(Placement::Identity())},
                                      {"spine", spine},
                                      {"neck", spine},
                                      {"head", head},
                                      {"hat", head}}) {
    const size_t j = index(joint);
    EXPECT_LT((moment.joints[j].matrix() - (motion * rest[j]).matrix()).norm(), 1e-6) << joint;
  }
  EXPECT_LT((placementOf(moment.carried).matrix() - head.matrix()).norm(), 1e-6);
  const SkinnedBody::Moment still = body.fromPalette(Palette(palette.size()), {}, {});
  EXPECT_LT(worstBetween(body.skin().blended(still.joints), body.skin().mesh.positions), 1e-6);
}

TEST(SkinnedBody, ItsHairIsCarriedByItsJointAndTheAncestors) {
  samples::ArmOptions options;
  options.joints = {"hips", "spine", "neck", "head", "hat"};
  const SkinnedBody body = arm({}, options);
  std::vector<std::string> names;
  for (const size_t joint : body.carriers()) names.push_back(body.skin().skeleton.joints[joint].name);
  ASSERT_GE(names.size(), 4u) << "and the nodes above the skeleton";
  names.resize(4);
  EXPECT_EQ(names, (std::vector<std::string>{"head", "neck", "spine", "hips"}));
}

TEST(SkinnedBody, APaletteGivesTheSkinOfTheClip) {
  const samples::ArmOptions options = swellingArm();
  const Pose head = proceduralMotion("nod", Vec3(0, 0.25f, 0))(0.3);
  for (const char* clip : {"bend", "swell"}) {
    const SkinnedBody body = arm({clip, "lower"}, options);
    for (const double t : {0.3, 0.9, 1.4}) {
      const SkinnedBody::Moment by_clip = body.at(t, head),
                                moment = body.fromPalette(paletteOf(body, t), by_clip.weights, head);
      EXPECT_LT(worstBetween(body.skin().blended(moment.joints, moment.weights), body.surface(t, head)),
                1e-6);
      const Pose difference = moment.carried * by_clip.carried.inverse();
      EXPECT_LT(difference.position.norm(), 1e-6f);
      EXPECT_LT(difference.rotation.angularDistance(Quat::Identity()), 1e-6f);
    }
  }
}

TEST(SkinnedBody, WhatItDoesNotHaveIsRefused) {
  expectError([] { arm({"walk", "lower"}); }, {"no clip 'walk'", "arm.glb", "bend"});
  expectError(
      [] {
        const auto bytes = samples::armWith({}, R"("input":5)", R"("input":1)");
        SkinnedBody(readGltfSkin(bytes, "arm.gltf"), {"bend", "lower"});
      },
      {"no clip 'bend'", "read without animations that cannot be read", "do not fit"});
  expectError([] { arm({"bend", "louver"}); }, {"no joint 'louver'", "arm.glb", "lower"});
  expectError([] { arm({"bend", ""}); }, {"'head' in its name", "arm.glb", "--body-joint"});
  expectError([] { arm({"/nowhere/walk.bvh", "lower"}); }, {"the file cannot be found", "/nowhere/walk.bvh"});
}

/// The arm lies along -X (its file has X up) and its forearm bends down or up about Z. Hair from behind lies
/// across it on both sides of the elbow.
float deepestUnderTheSkin(samples::ArmOptions options, float degrees) {
  const ScratchFolder folder;
  options.degrees = degrees;
  writeFileBytes(folder / "arm.glb", samples::armGlb(options));
  std::vector<std::vector<Vec3>> strands;
  for (int s = 0; s < 24; ++s) {
    std::vector<Vec3>& strand = strands.emplace_back();
    for (int i = 0; i < 25; ++i)  // the file's axes: X up, Y to the left
      strand.emplace_back(0.06f, 0.13f + 0.01f * static_cast<float>(s),
                          -0.08f + 0.01f * static_cast<float>(i));
  }
  writeStrands(folder / "hair.obj", strands);
  SceneOptions scene_options;
  scene_options.groom = {folder / "hair.obj"};
  scene_options.body = folder / "arm.glb";
  scene_options.units = {1, UpAxis::kX};
  scene_options.body_units.up = UpAxis::kX;
  scene_options.skinned = SkinnedMotion{"bend", "upper"};
  scene_options.body_cell = 0.003f;
  const Scene scene = makeScene(scene_options);
  Simulation simulation = simulated(scene);
  float deepest = 0;
  TriangleMesh skin = scene.body;
  for (int step = 1; step <= 200; ++step) {
    const double end = simulation.time() + static_cast<double>(simulation.parameters().time_step);
    moveTo(scene.skinned.get(), end, scene.motion(end), simulation);
    simulation.step();
    if (step % 8 != 0) continue;
    skin.positions = scene.skinned->surface(simulation.time(), scene.motion(simulation.time()));
    const MeshQuery query(skin);
    for (const Vec3& p : simulation.guides()) {
      EXPECT_TRUE(p.allFinite());
      deepest = std::max(deepest, -query.signedDistance(p));
    }
  }
  EXPECT_EQ(simulation.measure().non_finite, 0u);
  std::printf("forearm bent by %.0f degrees: hair %.2f mm under the blended skin at most\n",
              static_cast<double>(degrees), 1e3 * static_cast<double>(deepest));
  return deepest;
}

// The parts are up to 0.9 mm under the skin of this arm (SkinParts.FollowABentArm).
TEST(SkinnedScene, HairOnABendingArmStaysOnItsSkin) {
  EXPECT_LT(deepestUnderTheSkin({}, 60), 1e-3f + 1e-3f) << "the forearm goes down";
  EXPECT_LT(deepestUnderTheSkin({}, -60), 1e-3f + 1e-3f) << "up, against the hair";
}

// 128 triangles. No gap may open between the parts.
TEST(SkinnedScene, HairOnACoarseBendingArmStaysOnItsSkin) {
  samples::ArmOptions options;
  options.spacing = 0.1f;
  options.sectors = 8;
  EXPECT_LT(deepestUnderTheSkin(options, 60), 1e-3f + 1e-3f);
}

TEST(SkinnedScene, AClipSentAsAPaletteGivesTheHairOfTheClip) {
  const ScratchFolder folder;
  SceneOptions options = bendingArm(folder, UpAxis::kX);
  options.motion = "nod";
  options.primitives.emplace_back();
  options.primitives[0].shape.a = Vec3(-0.4f, 0.1f, 0);
  options.primitives[0].shape.radius = 0.03f;
  options.primitives[0].joint = "lower";
  writeStrands(folder / "hair.obj", fur(48, 0.1f, 0.45f, 0.04f, 0.12f));
  const Scene scene = makeScene(options);
  const SkinnedBody& body = *scene.skinned;
  ASSERT_GT(body.roots()->bones(), 1u);
  Simulation by_clip = simulated(scene, makeReferenceBackend()),
             by_palette = simulated(scene, makeReferenceBackend());
  double farthest = 0;
  for (int step = 0; step < 120; ++step) {
    const double end = by_clip.time() + static_cast<double>(by_clip.parameters().time_step);
    const Pose head = scene.motion(end);
    stepWith(scene, by_clip);
    place(body, body.fromPalette(paletteOf(body, end), {}, head), head, by_palette);
    by_palette.step();
    for (const BodyId id : by_clip.bodyIds()) {
      const Pose difference = by_palette.bodyPose(id) * by_clip.bodyPose(id).inverse();
      EXPECT_LT(difference.position.norm(), 1e-6f) << id;
    }
    for (size_t v = 0; v < by_clip.guides().size(); ++v)
      farthest = std::max<double>(farthest, (by_clip.guides()[v] - by_palette.guides()[v]).norm());
  }
  std::printf("a clip sent as a palette moves hair by %.2g um at most\n", 1e6 * farthest);
  EXPECT_LT(farthest, 1e-6);
}

TEST(SkinnedScene, ACutOfThePaletteMovesHairWithTheSkin) {
  const ScratchFolder folder;
  const SceneOptions options = bendingArm(folder, UpAxis::kY);
  writeStrands(folder / "hair.obj", fur(24, 0.1f, 0.45f, 0.04f, 0.12f));
  const Scene scene = makeScene(options);
  const SkinnedBody& body = *scene.skinned;
  Simulation far = simulated(scene), here = simulated(scene);
  constexpr int kCut = 30;
  Pose motion;
  for (int step = 0; step < 60; ++step) {
    const double end = here.time() + static_cast<double>(here.parameters().time_step);
    if (step == kCut)  // gravity keeps its direction
      motion = {Vec3(3, 1, -2), Quat(Eigen::AngleAxisf(2, Vec3::UnitY()))};
    Palette palette = paletteOf(body, end);
    place(body, body.fromPalette(palette, {}, {}), {}, here);
    for (std::optional<Placement>& joint : palette) joint = placementOf(motion) * *joint;
    place(body, body.fromPalette(palette, {}, {}), {}, far);
    for (Simulation* simulation : {&here, &far}) {
      if (step == kCut) simulation->jumpToPoses();  // here by one step of the bend
      simulation->step();
      EXPECT_EQ(simulation->resetDiverged(), 0u);
    }
    for (size_t v = 0; v < far.guides().size(); ++v)
      EXPECT_LT((far.guides()[v] - motion.apply(here.guides()[v])).norm(), 5e-6f) << step;
    EXPECT_LT(far.measure().max_penetration, 1e-4);
  }
}

/// Hips that travel and sway, a bending spine and a turning head, with a period of one second.
std::string walkingBvh() {
  std::string text =
      "HIERARCHY\nROOT hips\n{\nOFFSET 0 90 0\nCHANNELS 6 Xposition Yposition Zposition Yrotation Xrotation "
      "Zrotation\n";
  for (const char* joint : {"spine", "neck", "head"})
    text += std::string("JOINT ") + joint + "\n{\nOFFSET 0 20 0\nCHANNELS 3 Yrotation Xrotation Zrotation\n";
  text += "End Site\n{\nOFFSET 0 20 0\n}\n}\n}\n}\n}\nMOTION\nFrames: 31\nFrame Time: 0.0333333\n";
  for (int f = 0; f <= 30; ++f) {
    const double turn = 2 * 3.14159265358979 * f / 30, sway = std::sin(turn), bounce = std::cos(2 * turn);
    const double values[] = {2 * sway,   90 + 2 * bounce, 4.0 * f,   8 * sway, 3, 4 * sway,  // hips
                             -12 * sway, 4 * bounce,      -6 * sway,                         // spine
                             6 * sway,   5 * bounce,      3 * sway,                          // neck
                             35 * sway,  8 * bounce,      4 * sway};                         // head
    for (const double value : values) text += std::to_string(value) + " ";
    text += "\n";
  }
  return text;
}

TEST(SkinnedScene, AWalkingFigureOf600StepsLeavesAllHairFinite) {
  const ScratchFolder folder;
  samples::ArmOptions options;
  options.joints = {"hips", "spine", "neck", "head"};
  options.radius = 0.08f;
  options.bone = 0.18f;
  options.blend = 0.05f;
  options.spacing = 0.015f;
  writeFileBytes(folder / "figure.glb", samples::armGlb(options));
  std::ofstream(folder / "walk.bvh") << walkingBvh();
  std::vector<std::vector<Vec3>> strands;
  for (int s = 0; s < 60; ++s) {  // from the crown outward and down beside the neck
    const float turn = 2.4f * static_cast<float>(s), wide = 0.083f + 0.0005f * static_cast<float>(s % 7);
    std::vector<Vec3>& strand = strands.emplace_back();
    for (int i = 0; i < 24; ++i)
      strand.emplace_back(wide * std::cos(turn), 0.70f - 0.014f * static_cast<float>(i),
                          wide * std::sin(turn));
    strand.front() = Vec3(0.97f * 0.08f * std::cos(turn), 0.705f, 0.97f * 0.08f * std::sin(turn));
  }
  writeStrands(folder / "hair.obj", strands);
  SceneOptions scene_options;
  scene_options.groom = {folder / "hair.obj"};
  scene_options.body = folder / "figure.glb";
  scene_options.units = {1, UpAxis::kY};
  scene_options.skinned = SkinnedMotion{(folder / "walk.bvh").string(), ""};
  scene_options.motion = "nod";
  scene_options.body_cell = 0.005f;
  const Scene scene = makeScene(scene_options);
  Simulation simulation = simulated(scene);
  Measurement worst;
  for (int step = 1; step <= 600; ++step) {
    const double end = simulation.time() + static_cast<double>(simulation.parameters().time_step);
    moveTo(scene.skinned.get(), end, scene.motion(end), simulation);
    simulation.step();
    EXPECT_EQ(simulation.resetDiverged(), 0u);
    if (step % 20 != 0) continue;
    const Measurement now = simulation.measure();
    worst.non_finite += now.non_finite;
    worst.max_penetration = std::max(worst.max_penetration, now.max_penetration);
  }
  std::printf("%zu parts, 600 steps: %zu not finite, %.3f mm in a part at most\n", scene.bodies.size(),
              static_cast<size_t>(worst.non_finite), 1e3 * worst.max_penetration);
  EXPECT_EQ(worst.non_finite, 0u);
  EXPECT_LT(worst.max_penetration, 1e-3);
}

/// An arm along -X that bends down, hair that falls on it, and bodies attached to its joints.
class HangingBodies : public ::testing::Test {
 protected:
  HangingBodies() {
    std::vector<std::vector<Vec3>> strands;
    for (int s = 0; s < 24; ++s) {
      std::vector<Vec3>& strand = strands.emplace_back();
      for (int i = 0; i < 25; ++i)  // the file's axes: X up, Y to the left
        strand.emplace_back(0.06f, 0.25f + 0.01f * static_cast<float>(s),
                            -0.08f + 0.01f * static_cast<float>(i));
    }
    writeStrands(folder_ / "hair.obj", strands);
  }
  static ScenePrimitive ball(const std::string& joint, const Vec3& at, float radius = 0.03f) {
    ScenePrimitive ball;
    ball.shape.a = at;
    ball.shape.radius = radius;
    ball.joint = joint;
    ball.where = "arm.toml line 7";
    return ball;
  }
  static void moveTo(const Scene& scene, double seconds, Simulation& simulation) {
    strandcast::moveTo(scene.skinned.get(), seconds, scene.motion(seconds), simulation);
  }
  /// The attached shape in the input of the next step of a simulation at `seconds`.
  static MovingPrimitive onTheWay(const Scene& scene, double seconds) {
    Simulation simulation = simulated(scene);
    moveTo(scene, seconds, simulation);
    simulation.step();
    moveTo(scene, seconds + static_cast<double>(simulation.parameters().time_step), simulation);
    return simulation.nextInput().primitives.back();
  }

  const ScratchFolder folder_;
  SceneOptions options_ = bendingArm(folder_, UpAxis::kX);
};

TEST_F(HangingBodies, AreOneForEachJointAndGoWithIt) {
  options_.motion = "nod+turn";
  options_.skinned->joint = "lower";
  options_.primitives = {ball("lower", Vec3(-0.4f, 0.1f, 0)), ball("upper", Vec3(-0.1f, 0.1f, 0)),
                         ball("lower", Vec3(-0.5f, 0, 0.1f)), ball("lower", Vec3(-0.5f, 0, 0))};
  options_.primitives[3].name = "watch";
  const Scene scene = makeScene(options_);
  const size_t parts = scene.skinned->parts().size();
  ASSERT_EQ(scene.bodies.size(), parts + 3);
  EXPECT_EQ(scene.bodies[parts].primitives.size(), 2u);
  for (size_t i = parts; i < parts + 3; ++i) EXPECT_FALSE(scene.bodies[i].follows_head);
  EXPECT_EQ(scene.named_bodies.at("watch"), parts + 2);
  EXPECT_EQ(*scene.skinned->jointOf(parts), "lower");
  EXPECT_EQ(*scene.skinned->jointOf(parts + 1), "upper");
  EXPECT_EQ(scene.skinned->jointOf(0), nullptr);
  // A vertex with all its weight on the joint moves like a body attached to the joint.
  const std::vector<float> lower = scene.skinned->jointWeights();
  Simulation simulation = simulated(scene);
  for (const double t : {0.0, 0.3, 0.9, 1.4, 2.2}) {
    moveTo(scene, t, simulation);
    simulation.step();
    const std::vector<Vec3> skin = scene.skinned->surface(t, scene.motion(t));
    float farthest = 0;
    for (size_t v = 0; v < skin.size(); ++v) {
      const Vec3& rest = scene.body.positions[v];
      if (lower[v] == 1) {
        EXPECT_LT((simulation.bodyPose(parts).apply(rest) - skin[v]).norm(), 2e-6f) << t;
      } else if (lower[v] == 0) {
        EXPECT_LT((simulation.bodyPose(parts + 1).apply(rest) - skin[v]).norm(), 2e-6f) << t;
      }
      farthest = std::max(farthest, (skin[v] - rest).norm());
    }
    if (t > 0) {
      EXPECT_GT(farthest, 0.05f) << t;
    }
    EXPECT_EQ(simulation.bodyPose(parts + 2).position, simulation.bodyPose(parts).position);
  }
}

TEST_F(HangingBodies, MoveWithTheVelocityOfTheirJoint) {
  options_.primitives = {ball("lower", Vec3(-0.4f, 0.1f, 0))};
  const Scene scene = makeScene(options_);
  const MovingPrimitive moving = onTheWay(scene, 0.8);  // halfway down
  const Vec3 begin(moving.a_begin[0], moving.a_begin[1], moving.a_begin[2]),
      end(moving.a_end[0], moving.a_end[1], moving.a_end[2]),
      spin(moving.angular_velocity[0], moving.angular_velocity[1], moving.angular_velocity[2]);
  const float turn = 60 * 3.14159265f / 180;  // rad/s, about the elbow
  EXPECT_NEAR(spin.norm(), turn, 1e-3f * turn);
  EXPECT_NEAR(std::fabs(spin.z()), turn, 1e-3f * turn);
  const Vec3 elbow(-0.25f, 0, 0);
  EXPECT_NEAR((begin - elbow).norm(), std::hypot(0.15f, 0.1f), 1e-5f);
  const Vec3 velocity = (end - begin) / scene.parameters.time_step;
  EXPECT_LT((velocity - spin.cross(0.5f * (begin + end) - elbow)).norm(), 1e-3f) << velocity.transpose();
}

TEST_F(HangingBodies, KeepHairOut) {
  options_.primitives = {ball("lower", Vec3(-0.36f, 0.03f, 0), 0.025f)};
  options_.primitives[0].name = "ball";
  const Scene scene = makeScene(options_);
  const BodyId id = scene.named_bodies.at("ball");
  Simulation simulation = simulated(scene);
  float nearest = 1, least = 1;
  for (int step = 1; step <= 100; ++step) {
    moveTo(scene, simulation.time() + static_cast<double>(simulation.parameters().time_step), simulation);
    simulation.step();
    const Vec3 middle = simulation.bodyPose(id).apply(Vec3(-0.36f, 0.03f, 0));
    for (const Vec3& p : simulation.guides()) nearest = std::min(nearest, (p - middle).norm() - 0.025f);
    least = std::min(least, middle.y());
  }
  EXPECT_LT(least, 0) << "the forearm goes down";
  EXPECT_GT(nearest, -2e-4f) << "m, into it";
  EXPECT_LT(nearest, 1e-3f) << "hair lies on it";
  simulation.removeBody(id);
  moveTo(scene, simulation.time() + static_cast<double>(simulation.parameters().time_step), simulation);
  simulation.step();
  EXPECT_FALSE(simulation.hasBody(id)) << "the others go on without it";
}

TEST_F(HangingBodies, AMeshIsNoPartOfTheSkin) {
  std::ofstream(folder_ / "corner.obj")
      << "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
  options_.primitives = {ball("lower", Vec3(-0.4f, 0, 0))};
  options_.primitives[0].shape.kind = PrimitiveKind::kField;
  options_.primitives[0].file = folder_ / "corner.obj";
  options_.primitives[0].cell = 0.02f;
  const Scene scene = makeScene(options_);
  const ContactPrimitive& shape = scene.bodies.back().primitives.at(0);
  EXPECT_GT(shape.a.norm(), 1) << "docs/wire.md: its own frame is not that of the skin";
  ShapeData data;
  const uint32_t at = data.add(shape);
  for (const double t : {0.0, 1.0}) {
    const Pose pose = scene.skinned->placedBodies(scene.skinned->at(t, {})).at(0).pose;
    EXPECT_EQ(pose.position.norm() > 0.1f, t > 0) << "bent";
    const auto distance = [&](const Vec3& p) {
      return signedDistance(moved(shape, pose, pose, 1, at), pose.apply(p), data.words);
    };
    EXPECT_NEAR(distance(Vec3(-0.39f, 0.2f, 0.2f)), 0.01f, 1e-3f) << t;
    EXPECT_NEAR(distance(Vec3(-0.41f, 0.2f, 0.2f)), -0.01f, 1e-3f) << t;
  }
}

TEST_F(HangingBodies, AnUnknownJointIsRefused) {
  options_.primitives = {ball("louver", Vec3(-0.4f, 0.1f, 0))};
  expectError([&] { makeScene(options_); },
              {"the body has no joint 'louver': arm.toml line 7; did you mean 'lower'?"});
  options_.primitives[0].joint = "tentacle";
  expectError([&] { makeScene(options_); }, {"no joint 'tentacle': arm.toml line 7; it has", "upper, lower"});
}

TEST(SkinnedScene, WhatCannotBeSkinnedIsRefused) {
  SceneOptions options;
  options.skinned = SkinnedMotion{};
  expectError([&] { makeScene(options); }, {"no body", "--body"});
  const ScratchFolder folder;
  writeStrands(folder / "hair.obj", {{Vec3(0, 0.3f, 0), Vec3(0, 0.4f, 0), Vec3(0, 0.5f, 0)}});
  options.groom = {folder / "hair.obj"};
  options.body = folder / "arm.glb";
  options.body_contact = BodyContact::kSpheres;
  expectError([&] { makeScene(options); }, {"arm.glb", "spheres"});
}

TEST(SkinnedBody, OfSeveralMorphingNodesTheJointsToChooseFromAreNamed) {
  const auto bytes = samples::armWith(swellingArm(false), R"("name":"figure"})",
                                      R"("name":"figure","children":[3]},{"mesh":0,"name":"beard"})");
  const SkinnedMesh two = readGltfSkin(bytes, "face.gltf");
  expectError(
      [&] {
        SkinnedBody(two, {"swell", ""});
      },
      {"'head' in its name", "--body-joint", "figure, beard"});
  expectError([&] { SkinnedBody(two, {"swell", "bread"}); }, {"'bread'", "beard"});
  EXPECT_EQ(SkinnedBody(two, {"swell", "beard"}).joint(), "beard");
}

TEST(SkinnedBody, TheTravelOfAClipOfItsOwnIsReportedInMetres) {
  // The neck moves through the positions of the skin's first three vertices.
  const auto bytes = samples::armGltf(samples::smallArm());
  std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const auto insert = [&](const std::string& before, const std::string& more) {
    text.insert(text.find(before), more);
  };
  insert(R"(],"bufferViews":[)", R"(,{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"})");
  insert(R"(],"samplers":[)", R"(,{"sampler":1,"target":{"node":0,"path":"translation"}})");
  insert(R"(]}],"accessors":[)", R"(,{"input":5,"output":7})");
  SkinnedMesh skin = readGltfSkin(samples::fromText(text), "walker.gltf");
  const float travel = (skin.stored[2] - skin.stored[0]).norm();
  for (const float unit : {1.0f, 10.0f, 0.01f}) {
    skin.skeleton.root.linear() = static_cast<double>(unit) * Eigen::Matrix3d::Identity();
    const std::vector<std::string> notes = SkinnedBody(skin, {"bend", "head"}).notes();
    if (unit < 1) {
      EXPECT_TRUE(notes.empty()) << "0.3 mm";
      continue;
    }
    ASSERT_EQ(notes.size(), 1u);
    EXPECT_EQ(notes[0],
              fmt::format("the clip bend: 'neck' travels {:.3g} m from the first frame to the last, which is "
                          "taken out to play it in place",
                          unit * travel));
  }
}

}  // namespace
}  // namespace strandcast
