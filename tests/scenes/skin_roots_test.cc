// Roots of hair on a blended skin: position, rotation, and roots that are not on it.
#include "collision/skin_roots.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "collision/mesh_query.h"
#include "core/backend.h"
#include "core/sag_free.h"
#include "io/file_bytes.h"
#include "tests/expect_error.h"
#include "tests/io/scratch_folder.h"
#include "tests/io/skinned_arm.h"
#include "tests/scenes/furry_arm.h"

namespace strandcast {
namespace {

constexpr float kDegree = 3.14159265f / 180;

/// An arm along Y whose forearm bends by 60 degrees within a second, with fur all over.
class SkinRootsOfAnArm : public ::testing::Test {
 protected:
  Scene furry(int strands = 300, float radius = 0.0395f, float length = 0.05f) {
    writeStrands(folder_ / "hair.obj", fur(strands, 0.02f, 0.48f, radius, length));
    return makeScene(options_);
  }
  static std::vector<Pose> rootsAt(const Scene& scene, double seconds, Simulation& simulation) {
    moveTo(scene.skinned.get(), seconds, scene.motion(seconds), simulation);
    simulation.step();
    return simulation.rootPoses();
  }
  /// Rotation from rest to the current pose.
  static Quat turned(const Pose& now, const Pose& rest) { return now.rotation * rest.rotation.conjugate(); }
  static bool hasNote(const Scene& scene, const std::string& text) {
    return std::any_of(scene.notes.begin(), scene.notes.end(),
                       [&](const std::string& note) { return note.find(text) != std::string::npos; });
  }

  const ScratchFolder folder_;
  SceneOptions options_ = bendingArm(folder_, UpAxis::kY);
};

/// A point of a triangle of the skin, with the forearm's weight there.
struct OnSkin {
  MeshPoint at;
  double forearm;

  Vec3 place(const Scene& scene, const std::vector<Vec3>& skin) const {
    const auto& corners = scene.body.triangles[at.triangle];
    return at.barycentric[0] * skin[corners[0]] + at.barycentric[1] * skin[corners[1]] +
           at.barycentric[2] * skin[corners[2]];
  }
  Vec3 normal(const Scene& scene, const std::vector<Vec3>& skin) const {
    const auto& corners = scene.body.triangles[at.triangle];
    return (skin[corners[1]] - skin[corners[0]]).cross(skin[corners[2]] - skin[corners[0]]).normalized();
  }
};
std::vector<OnSkin> underRoots(const Scene& scene) {
  const MeshQuery query(scene.body);
  const SkinnedMesh& skin = scene.skinned->skin();
  std::vector<OnSkin> out;
  for (size_t s = 0; s < scene.groom.strands.strands(); ++s) {
    OnSkin on{query.closest(scene.groom.strands.strand(s)[0]), 0};
    for (int c = 0; c < 3; ++c)
      for (const SkinInfluence& influence : skin.influences[scene.body.triangles[on.at.triangle][c]])
        if (skin.skeleton.joints[skin.bindings[influence.binding].joint].name == "lower")
          on.forearm += static_cast<double>(on.at.barycentric[c] * influence.weight);
    out.push_back(on);
  }
  return out;
}

TEST_F(SkinRootsOfAnArm, StayOnTheBlendedSkinAndTurnWithIt) {
  const Scene scene = furry();
  Simulation simulation = simulated(scene);
  const std::vector<OnSkin> under = underRoots(scene);
  const std::vector<Pose> rest = simulation.model().rest_roots;
  size_t blended = 0;
  for (const double t : {0.0, 0.3, 0.8, 1.0, 1.3, 1.9, 2.6, 3.0}) {
    const std::vector<Pose> roots = rootsAt(scene, t, simulation);
    const std::vector<Vec3> skin = scene.skinned->surface(t, {});
    for (size_t s = 0; s < roots.size(); ++s) {
      // The offset from the skin to the root is that at rest, rotated with the root.
      const Vec3 way = rest[s].position - under[s].place(scene, scene.body.positions);
      const Vec3 place = under[s].place(scene, skin) + turned(roots[s], rest[s]) * way;
      ASSERT_LT((roots[s].position - place).norm(), 1e-6f) << "strand " << s << " at " << t;
      EXPECT_GT(way.norm(), 1e-5f);
      if (t != 0.8 && t != 1.0 && t != 3.0) continue;
      // The rotation nearest to (1 - s) E + s R is known in closed form for a rotation R in a plane.
      const double bend = (t == 0.8 ? 48 : 60) * static_cast<double>(kDegree), share = under[s].forearm;
      const double angle = std::atan2(share * std::sin(bend), 1 - share + share * std::cos(bend));
      const Quat expected(Eigen::AngleAxisf(static_cast<float>(angle), Eigen::Vector3f::UnitZ()));
      ASSERT_LT(turned(roots[s], rest[s]).angularDistance(expected), 2e-3f) << "share " << share;
      blended += share > 0.05 && share < 0.95;
    }
  }
  EXPECT_GT(blended, 100u);
}

/// Mean and maximum change, in degrees, of the angle between strands at the elbow and the skin when the arm
/// bends by 60 degrees.
std::pair<float, float> leanAtTheElbow(const Scene& scene) {
  Simulation simulation = simulated(scene);
  moveTo(scene.skinned.get(), 1, {}, simulation);
  simulation.step();
  const std::vector<Pose> roots = simulation.rootPoses(), rest = simulation.model().rest_roots;
  const std::vector<Vec3> skin = scene.skinned->surface(1, {});
  float sum = 0, most = 0, count = 0;
  const std::vector<OnSkin> under = underRoots(scene);
  for (size_t s = 0; s < roots.size(); ++s) {
    if (under[s].forearm < 0.02 || under[s].forearm > 0.98) continue;
    if (rest[s].position.x() < -0.02f) continue;  // inner side of the elbow, where the skin is folded
    const auto angle = [&](const Pose& root, const std::vector<Vec3>& of) {
      return std::acos(
          std::clamp((root.rotation * Vec3(0, 0, 1)).dot(under[s].normal(scene, of)), -1.0f, 1.0f));
    };
    const float change = std::fabs(angle(roots[s], skin) - angle(rest[s], scene.body.positions)) / kDegree;
    sum += change;
    most = std::max(most, change);
    count += 1;
  }
  EXPECT_GT(count, 20);
  return {sum / count, most};
}

TEST_F(SkinRootsOfAnArm, KeepTheirAngleToTheSkinOfABentElbow) {
  const Scene on_skin = furry(600);
  options_.skinned->roots = BodyRoots::kJoint;
  const auto [mean, most] = leanAtTheElbow(on_skin);
  const auto [joint_mean, joint_most] = leanAtTheElbow(furry(600));
  std::printf(
      "strands at an elbow bent by 60 degrees lean by %.1f degrees in the mean, %.1f at most; of the "
      "joint %.1f, %.1f\n",
      static_cast<double>(mean), static_cast<double>(most), static_cast<double>(joint_mean),
      static_cast<double>(joint_most));
  EXPECT_LT(mean, 0.25f * joint_mean);
  EXPECT_LT(most, 10) << "degrees: how weights change along the skin leans it, too";
}

TEST_F(SkinRootsOfAnArm, WhollyOnTheJointAreAsTheJointIsBitForBit) {
  options_.skinned->joint = "lower";
  options_.motion = "nod";
  const Scene on_skin = furry();
  options_.skinned->roots = BodyRoots::kJoint;
  const Scene on_joint = furry();
  EXPECT_EQ(on_joint.skinned->roots(), nullptr);
  Simulation a = simulated(on_skin), b = simulated(on_joint);
  EXPECT_EQ(b.model().bones.size(), 1u);
  const std::vector<OnSkin> under = underRoots(on_skin);
  size_t whole = 0, other = 0;
  for (int step = 0; step < 60; ++step) {
    stepWith(on_skin, a);
    stepWith(on_joint, b);
  }
  const std::vector<Pose> skin = a.rootPoses(), joint = b.rootPoses();
  for (size_t s = 0; s < skin.size(); ++s) {
    const float way = (skin[s].position - joint[s].position).norm();
    if (under[s].forearm > 1 - 1e-7) {
      EXPECT_EQ(a.model().rootBone(s), 0) << s;
      EXPECT_EQ(way, 0);
      ++whole;
    } else if (under[s].forearm == 0) {
      EXPECT_LT((skin[s].position - a.model().rest_roots[s].position).norm(), 1e-6f) << "the other stands";
      EXPECT_GT(way, 1e-3f);
      ++other;
    }
  }
  EXPECT_GT(whole, 100u);
  EXPECT_GT(other, 100u);
  // All roots of the other joint share one bone.
  EXPECT_LT(a.model().bones.size(), on_skin.groom.strands.strands() - whole - other + 3);
}

TEST_F(SkinRootsOfAnArm, FarFromTheSkinGoWithTheJoint) {
  std::vector<std::vector<Vec3>> strands = fur(20, 0.3f, 0.48f, 0.058f, 0.05f), far = strands;
  for (std::vector<Vec3>& strand : far)
    for (Vec3& p : strand) p += 0.006f * Vec3(p.x(), 0, p.z()).normalized();
  strands.insert(strands.end(), far.begin(), far.end());
  writeStrands(folder_ / "hair.obj", strands);
  const Scene scene = makeScene(options_);
  EXPECT_TRUE(hasNote(scene, "20 of 40 roots are farther than 20 mm from the skin: they follow 'upper'"));
  Simulation simulation = simulated(scene);
  const std::vector<Pose> roots = rootsAt(scene, 1, simulation);
  for (size_t s = 0; s < roots.size(); ++s) {
    const float way = (roots[s].position - simulation.model().rest_roots[s].position).norm();
    if (s < 20) {
      EXPECT_GT(way, 0.04f) << s;
    } else {
      EXPECT_EQ(way, 0) << s;
    }
  }
}

TEST_F(SkinRootsOfAnArm, AreWhatPinsSay) {
  const Scene free = furry();
  options_.pins = {{{}, "ribbon", 0.6f, 1, "fur.toml line 3"}};
  const Scene tips = furry();
  const StrandModel without = sceneModel(free), with = sceneModel(tips);
  EXPECT_EQ(with.root_bones, without.root_bones) << "a pin elsewhere on the strand leaves its root";
  for (size_t s = 0; s < with.strands(); ++s) {
    EXPECT_FALSE(with.isBonePinned(s, with.offsets[s]));
    EXPECT_EQ(with.bones[with.pin_bones[with.offsets[s + 1] - 1]], "ribbon");
  }
  options_.pins = {{{}, "head", 0, 0.1f, "fur.toml line 3"}};
  const Scene pinned = furry();
  const StrandModel model = sceneModel(pinned);
  EXPECT_EQ(model.root_bones, std::vector<uint16_t>(model.strands(), 0));
  Simulation simulation = simulated(pinned);
  const std::vector<Pose> roots = rootsAt(pinned, 1, simulation);
  for (size_t s = 0; s < roots.size(); ++s)
    EXPECT_EQ(roots[s].position, simulation.model().rest_roots[s].position) << "the upper arm stands";
}

TEST_F(SkinRootsOfAnArm, ShareBonesWhereThereAreTooFew) {
  const Scene scene = furry(400);
  const SkinnedMesh& skin = scene.skinned->skin();
  const std::vector<bool> rigid(skin.skeleton.joints.size(), true);
  const SkinRoots each(skin, rigid, 0, scene.groom.strands), few(skin, rigid, 0, scene.groom.strands, 60);
  EXPECT_LE(few.bones(), 60u);
  EXPECT_GT(few.bones(), 10u);
  EXPECT_GT(each.bones(), 100u);
  ASSERT_FALSE(few.notes().empty());
  EXPECT_NE(few.notes().back().find("share one of"), std::string::npos) << few.notes().back();
  const std::vector<Placement> bent = [&] {
    std::vector<JointTransform> locals = skin.skeleton.rest();
    locals[1].rotation = Quat(Eigen::AngleAxisf(60 * kDegree, Eigen::Vector3f::UnitZ()));
    return skin.bindingsAt(skin.skeleton.worldTransforms(locals));
  }();
  std::vector<Pose> exact(each.bones() + 1), shared(few.bones() + 1);
  each.place(bent, {}, std::span(exact).subspan(1));
  few.place(bent, {}, std::span(shared).subspan(1));
  float worst = 0, way = 0;
  for (size_t s = 0; s < scene.groom.strands.strands(); ++s) {
    const Vec3 rest = scene.groom.strands.strand(s)[0], there = exact[each.rootBones()[s]].apply(rest);
    worst = std::max(worst, (shared[few.rootBones()[s]].apply(rest) - there).norm());
    way = std::max(way, (there - rest).norm());
  }
  EXPECT_LT(worst, 0.01f) << "m";
  EXPECT_GT(way, 0.2f);
  expectError([&] { SkinRoots(skin, rigid, 0, scene.groom.strands, 0); }, {"too few bones", "0 of"});
}

TEST(SkinRootsOnAFace, GoAndTurnWithTheSkinThatMorphTargetsMove) {
  samples::ArmOptions options;
  options.bulge = 0.012f;
  for (const char* joint : {"upper", "lower"}) {
    SkinnedBody body(readGltfSkin(samples::armGlb(options), "arm.glb"), {"swell", joint});
    StrandSet strands;
    for (const std::vector<Vec3>& strand : fur(400, 0.25f, 0.48f, 0.0395f, 0.02f)) strands.append(strand);
    body.growOnSkin(strands, 65535);
    const TriangleMesh& rest = body.skin().mesh;
    const MeshQuery query(rest);
    for (const double t : {0.7, 1.0, 1.3}) {
      const std::vector<Vec3> now = body.surface(t, {});
      const std::vector<Pose> poses = body.placedRoots(body.at(t, {}));
      float most = 0, lean = 0;
      for (size_t s = 0; s < strands.strands(); ++s) {
        const Vec3 root = strands.strand(s)[0];
        const MeshPoint on = query.closest(root);
        const auto& c = rest.triangles[on.triangle];
        const auto place = [&](const std::vector<Vec3>& p) {
          return Vec3(on.barycentric[0] * p[c[0]] + on.barycentric[1] * p[c[1]] +
                      on.barycentric[2] * p[c[2]]);
        };
        const auto normal = [&](const std::vector<Vec3>& p) {
          return Vec3((p[c[1]] - p[c[0]]).cross(p[c[2]] - p[c[0]]).normalized());
        };
        const uint16_t bone = body.roots()->rootBones()[s];
        const Pose pose = bone > 0 ? poses[bone - 1u] : Pose{};
        ASSERT_LT((pose.apply(place(rest.positions)) - place(now)).norm(), 1e-6f)
            << "strand " << s << " at " << t;
        EXPECT_LT((pose.rotation * normal(rest.positions) - normal(now)).norm(), 0.12f) << "strand " << s;
        most = std::max(most, (place(now) - place(rest.positions)).norm());
        lean = std::max(lean, (normal(now) - normal(rest.positions)).norm());
      }
      EXPECT_GT(most, 0.005f);
      EXPECT_GT(lean, 0.2f) << "so that turns matter";
    }
  }
}

TEST_F(SkinRootsOfAnArm, OfAJointThatAClipStretchesAreStretchedAlong) {
  const Scene scene = furry();
  SkinnedMesh skin = scene.skinned->skin();
  SkeletonClip clip;
  clip.name = "grow";
  clip.samplers.push_back({ClipInterpolation::kLinear, 3, {0, 1}, {1, 1, 1, 1.5f, 1.5f, 1.5f}});
  clip.channels.push_back({1, ClipPath::kScale, 0});
  clip.duration = 1;
  skin.clips = {clip};
  SkinnedBody body(skin, {"grow", "lower"});
  body.growOnSkin(scene.groom.strands, 65535);
  const std::vector<Pose> poses = body.placedRoots(body.at(0.7, {}));
  const std::vector<Vec3> now = body.surface(0.7, {});
  EXPECT_GT((now.back() - skin.mesh.positions.back()).norm(), 0.02f);
  size_t on_forearm = 0;
  const std::vector<OnSkin> under = underRoots(scene);
  for (size_t s = 0; s < under.size(); ++s) {
    if (under[s].forearm < 1 - 1e-7) continue;
    const uint16_t bone = body.roots()->rootBones()[s];
    ASSERT_GT(bone, 0) << "it is not where the joint would have it";
    const Vec3 place = under[s].place(scene, skin.mesh.positions);
    EXPECT_LT((poses[bone - 1u].apply(place) - under[s].place(scene, now)).norm(), 1e-6f);
    ++on_forearm;
  }
  EXPECT_GT(on_forearm, 100u);
}

TEST_F(SkinRootsOfAnArm, OnEveryBackendCarryTheSameHair) {
  const Scene scene = furry(60);
  std::vector<StrandState> states;
  for (const bool reference : {true, false}) {
    Simulation simulation = simulated(scene, reference ? makeReferenceBackend() : makeSimdBackend(2));
    for (int step = 0; step < 40; ++step) stepWith(scene, simulation);
    states.push_back(simulation.state());
    const std::vector<Pose> roots = simulation.rootPoses();
    for (size_t s = 0; s < roots.size(); ++s)
      EXPECT_LT((states.back().positions[simulation.model().offsets[s]] - roots[s].position).norm(), 1e-6f);
  }
  float apart = 0;
  for (size_t v = 0; v < states[0].positions.size(); ++v)
    apart = std::max(apart, (states[0].positions[v] - states[1].positions[v]).norm());
  EXPECT_LT(apart, 1e-4f) << "m";
}

/// The worst values in 300 steps of a bending arm with fur.
struct Worst {
  Measurement measured{};
  float deepest = 0;  ///< m, under the blended skin
  size_t reset = 0;
};
Worst worstOfFur(const Scene& scene) {
  Parameters parameters = scene.parameters;
  parameters.solver = SolverKind::kRod;
  StrandModel model = sceneModel(scene);
  makeSagFree(model, parameters.gravity);
  Simulation simulation(std::move(model), scene.bodies, parameters, makeSimdBackend(), nullptr,
                        makeTreeBroadPhase());
  Worst worst;
  TriangleMesh skin = scene.body;
  for (int step = 1; step <= 300; ++step) {
    stepWith(scene, simulation);
    worst.reset += simulation.resetDiverged();
    if (step % 10 != 0) continue;
    const Measurement now = simulation.measure();
    worst.measured.non_finite += now.non_finite;
    worst.measured.max_stretch = std::max(worst.measured.max_stretch, now.max_stretch);
    skin.positions = scene.skinned->surface(simulation.time(), scene.motion(simulation.time()));
    const MeshQuery query(skin);
    const std::span<const Vec3> guides = simulation.guides();
    for (size_t s = 0; s < simulation.model().strands(); ++s)
      for (uint32_t v = simulation.model().offsets[s] + 2; v < simulation.model().offsets[s + 1]; ++v)
        worst.deepest = std::max(worst.deepest, -query.signedDistance(guides[v]));
  }
  return worst;
}

// The parts are up to 0.9 mm below the skin of this arm, and 1.1 mm above it in the crease (SkinParts).
TEST_F(SkinRootsOfAnArm, HairOnTheWholeArmKeepsItsLengthAndStaysOutOfIt) {
  const Worst on_skin = worstOfFur(furry(300));
  options_.skinned->roots = BodyRoots::kJoint;
  const Worst on_joint = worstOfFur(furry(300));
  std::printf(
      "fur on a bending arm: stretched by %.2g, %.2f mm under the skin at most; with the joint %.2f mm\n",
      on_skin.measured.max_stretch, 1e3 * static_cast<double>(on_skin.deepest),
      1e3 * static_cast<double>(on_joint.deepest));
  EXPECT_EQ(on_skin.measured.non_finite, 0u);
  EXPECT_EQ(on_skin.reset, 0u);
  EXPECT_LT(on_skin.measured.max_stretch, 1e-4);
  EXPECT_LT(on_skin.deepest, 2e-3f);
  EXPECT_LT(on_skin.deepest, on_joint.deepest) << "whose roots the forearm leaves behind";
}

TEST_F(SkinRootsOfAnArm, ResetPutsStrandsWhereTheirRootsAre) {
  const Scene scene = furry(60);
  Simulation simulation = simulated(scene);
  for (int step = 0; step < 50; ++step) stepWith(scene, simulation);
  simulation.reset();
  const StrandState rest = restState(simulation.model(), simulation.rootPoses()), now = simulation.state();
  for (size_t v = 0; v < rest.positions.size(); ++v)
    ASSERT_LT((now.positions[v] - rest.positions[v]).norm(), 1e-6f);
  EXPECT_EQ(simulation.resetDiverged(), 0u);
}

TEST_F(SkinRootsOfAnArm, AFarWalkersStayOnItsSkinFromAnOriginOfItsOwn) {
  const Scene scene = furry(60);
  Simulation simulation = simulated(scene);
  const std::vector<OnSkin> under = underRoots(scene);
  const Pose far{Vec3(0, 0, 40), Quat::Identity()};
  double t = 0;
  for (int step = 1; step <= 200; ++step) {  // 24 m/s, faster than walking
    t += static_cast<double>(simulation.parameters().time_step);
    const Pose head{std::min(0.005f * static_cast<float>(step), 1.0f) * far.position, far.rotation};
    moveTo(scene.skinned.get(), t, head, simulation);
    simulation.step();
    EXPECT_EQ(simulation.resetDiverged(), 0u);
  }
  EXPECT_GT(simulation.origin().z(), 30);
  const std::vector<Vec3> skin = scene.skinned->surface(t, far);
  const std::vector<Pose> roots = simulation.rootPoses();
  for (size_t s = 0; s < roots.size(); ++s)
    EXPECT_NEAR(
        (roots[s].position - under[s].place(scene, skin)).norm(),
        (simulation.model().rest_roots[s].position - under[s].place(scene, scene.body.positions)).norm(),
        1e-5f);
  EXPECT_EQ(simulation.measure().non_finite, 0u);
}

TEST_F(SkinRootsOfAnArm, OfAnotherModelAreRefused) {
  const Scene scene = furry(20);
  StrandModel model = sceneModel(scene);
  expectError([&] { scene.skinned->roots()->addTo(model); }, {"do not belong to this model"});
}

}  // namespace
}  // namespace strandcast
