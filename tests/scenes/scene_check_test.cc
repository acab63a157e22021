// Checks of hair on bodies that is damaged on purpose: placement, surface, roots, hair inside, clips.
#include "scenes/scene_check.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "collision/field_bake.h"
#include "tests/collision/shapes.h"
#include "tests/expect_error.h"
#include "tests/real_data.h"
#include "tests/scenes/furry_arm.h"

namespace strandcast {
namespace {

constexpr float kRadius = 0.1f;  // m, of the ball
constexpr size_t kHairs = 200, kVertices = 8;

/// Point `s` of a spiral of kHairs points on the unit sphere.
Vec3 direction(size_t s) {
  const float y = 1 - 2 * (static_cast<float>(s) + 0.5f) / static_cast<float>(kHairs);
  const float around = 2.399963f * static_cast<float>(s), out = std::sqrt(1 - y * y);
  return {out * std::cos(around), y, out * std::sin(around)};
}

/// A straight strand from one distance of the ball's centre to another, m.
std::vector<Vec3> strandOut(size_t s, float from, float to) {
  std::vector<Vec3> points;
  for (size_t i = 0; i < kVertices; ++i)
    points.push_back((from + (to - from) * static_cast<float>(i) / static_cast<float>(kVertices - 1)) *
                     direction(s));
  return points;
}

/// A ball with hair of 0.2 m standing out of it.
Scene hairyBall() {
  Scene scene;
  scene.body = shapes::sphere(kRadius, 4);
  for (size_t s = 0; s < kHairs; ++s) scene.groom.strands.append(strandOut(s, kRadius, kRadius + 0.2f));
  scene.groom.report.unit_meters = 1;
  return scene;
}

void setStrand(Scene& scene, size_t s, const std::vector<Vec3>& points) {
  std::copy(points.begin(), points.end(), scene.groom.strands.strand(s).begin());
}

CheckSeverity severityOf(const CheckReport& report, const std::string& key) {
  const CheckResult* row = report.find(key);
  EXPECT_NE(row, nullptr) << key;
  return row ? row->severity : CheckSeverity::kOk;
}
double numberOf(const CheckReport& report, const std::string& key) {
  const CheckResult* row = report.find(key);
  EXPECT_NE(row, nullptr) << key;
  return row ? row->number : -1;
}
std::string remedyOf(const CheckReport& report, const std::string& key) {
  const CheckResult* row = report.find(key);
  EXPECT_NE(row, nullptr) << key;
  return row ? row->remedy : "";
}
bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST(CheckPlacement, HairOnItsBodyIsInPlace) {
  const Scene scene = hairyBall();
  EXPECT_EQ(checkPlacement(scene, {}, MeshQuery(scene.body)).worst(), CheckSeverity::kOk);
}

TEST(CheckPlacement, AGroomInCentimetresIsAnsweredWithItsUnit) {
  Scene scene = hairyBall();
  for (Vec3& p : scene.groom.strands.positions) p *= 100;
  const CheckReport report = checkPlacement(scene, {}, MeshQuery(scene.body));
  EXPECT_EQ(severityOf(report, "scale"), CheckSeverity::kFault);
  EXPECT_EQ(severityOf(report, "placement"), CheckSeverity::kFault);
  EXPECT_TRUE(has(remedyOf(report, "scale"), "--unit-meters 0.01 --body-unit-meters 1?"))
      << remedyOf(report, "scale");
}

TEST(CheckPlacement, ABodyInMillimetresIsAnsweredWithItsUnit) {
  Scene scene = hairyBall();
  for (Vec3& p : scene.body.positions) p *= 1000;
  SceneOptions options;
  options.body = "head.glb";  // its unit does not follow the groom's
  const CheckReport report = checkPlacement(scene, options, MeshQuery(scene.body));
  EXPECT_EQ(severityOf(report, "scale"), CheckSeverity::kFault);
  EXPECT_TRUE(has(remedyOf(report, "scale"), "--body-unit-meters 0.001?")) << remedyOf(report, "scale");
}

TEST(CheckPlacement, AWrongUpAxisIsAnsweredWithTheRightOne) {
  Scene scene;
  scene.body = shapes::capsule(0.1f, 0.3f, 3);
  scene.groom.report.unit_meters = 1;
  for (size_t v = 0; v < scene.body.positions.size(); v += 3) {
    const Vec3 root = scene.body.positions[v], tip = root + 0.1f * Vec3(root.x(), 0, root.z()).normalized();
    // The file has Z up and was read as if it had Y up.
    scene.groom.strands.append(
        std::vector<Vec3>{{root.x(), -root.z(), root.y()}, {tip.x(), -tip.z(), tip.y()}});
  }
  const CheckReport report = checkPlacement(scene, {}, MeshQuery(scene.body));
  EXPECT_NE(severityOf(report, "placement"), CheckSeverity::kOk);
  EXPECT_TRUE(has(remedyOf(report, "placement"), "--up z --body-up y?")) << remedyOf(report, "placement");
}

TEST(CheckPlacement, AGroomBesideItsBodyIsAFault) {
  Scene scene = hairyBall();
  for (Vec3& p : scene.groom.strands.positions) p += Vec3(3, 0.5f, 0.2f);
  const CheckReport report = checkPlacement(scene, {}, MeshQuery(scene.body));
  EXPECT_EQ(severityOf(report, "placement"), CheckSeverity::kFault);
  EXPECT_FALSE(remedyOf(report, "placement").empty());
}

TEST(CheckPlacement, EyebrowsOnAFigureAreNoFault) {
  Scene scene = hairyBall();
  scene.groom.strands = {};
  scene.body = shapes::sphere(1, 5);
  for (size_t s = 0; s < 20; ++s)
    scene.groom.strands.append(std::vector<Vec3>{Vec3(1e-3f * static_cast<float>(s), 0, 1),
                                                 Vec3(1e-3f * static_cast<float>(s), 0.005f, 1.002f)});
  EXPECT_EQ(checkPlacement(scene, {}, MeshQuery(scene.body)).worst(), CheckSeverity::kOk);
}

TEST(CheckBodyMesh, AClosedBallIsSound) {
  const CheckReport report = checkBodyMesh(shapes::sphere(0.1f, 4));
  for (const CheckResult& row : report.results) EXPECT_EQ(row.severity, CheckSeverity::kOk) << row.what;
}

TEST(CheckBodyMesh, SizesThatNoBodyHas) {
  EXPECT_EQ(severityOf(checkBodyMesh(shapes::sphere(5, 3)), "body_size"), CheckSeverity::kWarning);
  EXPECT_EQ(severityOf(checkBodyMesh(shapes::sphere(100, 3)), "body_size"), CheckSeverity::kFault);
}

TEST(CheckBodyMesh, OpenEdgesAreCounted) {
  TriangleMesh mesh = shapes::sphere(0.1f, 4);
  mesh.triangles.pop_back();
  EXPECT_EQ(numberOf(checkBodyMesh(mesh), "body_open"), 3);
}

TEST(CheckBodyMesh, EdgesOfThreeTrianglesAreAWarning) {
  TriangleMesh mesh = shapes::sphere(0.1f, 4);
  const auto [a, b, c] = mesh.triangles.front();
  mesh.positions.push_back(1.3f * mesh.positions[a]);
  mesh.triangles.push_back({a, b, static_cast<uint32_t>(mesh.positions.size() - 1)});
  const CheckReport report = checkBodyMesh(mesh);
  EXPECT_EQ(severityOf(report, "body_manifold"), CheckSeverity::kWarning);
  EXPECT_EQ(numberOf(report, "body_manifold"), 1);
}

TEST(CheckBodyMesh, WrongWindingIsAWarning) {
  TriangleMesh mesh = shapes::sphere(0.1f, 4);
  for (size_t t = 0; t < 5; ++t) std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
  const CheckReport some = checkBodyMesh(mesh);
  EXPECT_EQ(severityOf(some, "body_winding"), CheckSeverity::kWarning);
  EXPECT_EQ(numberOf(some, "body_winding"), 5);
  mesh = shapes::sphere(0.1f, 4);
  for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
  const CheckReport all = checkBodyMesh(mesh);
  EXPECT_EQ(severityOf(all, "body_winding"), CheckSeverity::kWarning);
  EXPECT_TRUE(has(all.find("body_winding")->what, "inside out"));
}

TEST(CheckBodyMesh, AShellInsideAnotherOneIsMeasured) {
  TriangleMesh mesh = shapes::sphere(0.1f, 4);
  const TriangleMesh inner = shapes::sphere(0.09f, 4);
  const auto first = static_cast<uint32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), inner.positions.begin(), inner.positions.end());
  for (const auto& [a, b, c] : inner.triangles) mesh.triangles.push_back({first + a, first + b, first + c});
  const CheckReport report = checkBodyMesh(mesh);
  EXPECT_EQ(severityOf(report, "body_overlap"), CheckSeverity::kWarning);
  EXPECT_NEAR(numberOf(report, "body_overlap"), 100 * 0.81 / 1.81, 3);
}

TEST(CheckRoots, OffTheSkinAreCountedAndMarked) {
  Scene scene = hairyBall();
  const MeshQuery query(scene.body);
  EXPECT_EQ(checkRoots(scene, query).worst(), CheckSeverity::kOk);
  for (size_t s = 0; s < 10; ++s) setStrand(scene, s, strandOut(s, kRadius + 0.005f, 0.3f));
  for (size_t s = 10; s < 13; ++s) setStrand(scene, s, strandOut(s, kRadius + 0.015f, 0.3f));
  setStrand(scene, 13, strandOut(13, kRadius + 0.03f, 0.3f));
  setStrand(scene, 14, strandOut(14, kRadius - 0.005f, 0.3f));
  const CheckReport report = checkRoots(scene, query);
  EXPECT_EQ(severityOf(report, "roots_off_skin"), CheckSeverity::kWarning);
  EXPECT_EQ(numberOf(report, "roots_off_skin"), 4);
  EXPECT_TRUE(has(report.find("roots_off_skin")->what, "15 above 2 mm"))
      << report.find("roots_off_skin")->what;
  EXPECT_TRUE(has(report.find("roots_off_skin")->what, "1 of them below the skin"));
  EXPECT_TRUE(has(report.find("roots_off_skin")->where, "strand 13"));
  EXPECT_EQ(numberOf(report, "roots_without_skin"), 1);
  EXPECT_EQ(report.marks.size(), 15u);
}

TEST(CheckRoots, AGroomThatFloatsIsAFault) {
  Scene scene = hairyBall();
  for (size_t s = 0; s < kHairs; ++s) setStrand(scene, s, strandOut(s, kRadius + 0.025f, 0.3f));
  const CheckReport report = checkRoots(scene, MeshQuery(scene.body));
  EXPECT_EQ(severityOf(report, "roots_off_skin"), CheckSeverity::kFault);
  EXPECT_EQ(severityOf(report, "roots_without_skin"), CheckSeverity::kFault);
}

TEST(CheckHairInside, VerticesBeyondTheRootAreCountedAndMarked) {
  Scene scene = hairyBall();
  const MeshQuery query(scene.body);
  EXPECT_EQ(checkHairInside(scene, query).worst(), CheckSeverity::kOk);
  for (size_t s = 0; s < 5; ++s) scene.groom.strands.strand(s)[3] = 0.095f * direction(s);
  const CheckReport report = checkHairInside(scene, query);
  EXPECT_EQ(severityOf(report, "hair_inside"), CheckSeverity::kWarning);
  EXPECT_EQ(numberOf(report, "hair_inside"), 5);
  ASSERT_EQ(report.marks.size(), 5u);
  EXPECT_EQ(report.marks[0].kind, CheckMark::Kind::kInside);
}

TEST(CheckHairInside, WhatABuriedRootNeedsDoesNotCount) {
  Scene scene = hairyBall();
  for (size_t s = 0; s < kHairs; ++s) {
    setStrand(scene, s, strandOut(s, 0.09f, 0.3f));
    scene.groom.strands.strand(s)[1] = 0.095f * direction(s);
  }
  EXPECT_EQ(numberOf(checkHairInside(scene, MeshQuery(scene.body)), "hair_inside"), 0);
}

TEST(CheckHairInside, StrandsThatNeverLeaveTheBodyAreCounted) {
  Scene scene = hairyBall();
  const MeshQuery query(scene.body);
  setStrand(scene, 3, strandOut(3, 0.09f, 0.05f));
  EXPECT_EQ(severityOf(checkHairInside(scene, query), "strands_buried"), CheckSeverity::kWarning);
  EXPECT_EQ(numberOf(checkHairInside(scene, query), "strands_buried"), 1);
  for (size_t s = 0; s < kHairs * 3 / 5; ++s) setStrand(scene, s, strandOut(s, 0.09f, 0.05f));
  EXPECT_EQ(severityOf(checkHairInside(scene, query), "strands_buried"), CheckSeverity::kFault);
}

/// Fur on an arm whose forearm a clip bends by 60 degrees.
class CheckClipOfAnArm : public ::testing::Test {
 protected:
  CheckReport checked() {
    writeStrands(folder_ / "hair.obj", fur(200, 0.02f, 0.48f, 0.0395f, 0.05f));
    return checkScene(loadForCheck(options_), options_, 60);
  }
  void writeArm(const samples::ArmOptions& arm) { writeFileBytes(folder_ / "arm.glb", samples::armGlb(arm)); }
  /// A clip that moves one joint of this name.
  void writeBvh(const std::string& joint) {
    std::ofstream(folder_ / "clip.bvh")
        << "HIERARCHY\nROOT " << joint
        << "\n{\nOFFSET 0 0 0\nCHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\n"
           "End Site\n{\nOFFSET 0 25 0\n}\n}\nMOTION\nFrames: 3\nFrame Time: 0.1\n"
           "0 0 0 0 0 0\n0 0 0 5 0 0\n0 0 0 0 0 0\n";
    options_.skinned->clip = (folder_ / "clip.bvh").string();
    options_.clip_unit_meters = 0.01f;
  }
  const ScratchFolder folder_;
  SceneOptions options_ = bendingArm(folder_, UpAxis::kY);
};

TEST_F(CheckClipOfAnArm, RootsAreFollowedThroughTheClip) {
  const CheckReport report = checked();
  EXPECT_EQ(numberOf(report, "root_joints"), 200);
  const std::string& joints = report.find("root_joints")->what;
  EXPECT_TRUE(has(joints, "upper ") && has(joints, "lower ")) << joints;
  EXPECT_GT(numberOf(report, "skin_stretch"), 1.05);
  EXPECT_GT(numberOf(report, "root_speed"), 0.1);  // 60 degrees per second, up to 0.25 m from the elbow
  EXPECT_LT(numberOf(report, "root_speed"), 1);
  EXPECT_EQ(severityOf(report, "root_speed"), CheckSeverity::kOk);
  EXPECT_EQ(severityOf(report, "root_jump"), CheckSeverity::kOk);
  EXPECT_EQ(report.find("joints_still"), nullptr) << "only for clips of another file";
}

TEST_F(CheckClipOfAnArm, AJumpIsFoundWithItsTime) {
  samples::ArmOptions arm;
  arm.interpolation = "STEP";
  writeArm(arm);
  const CheckReport report = checked();
  EXPECT_EQ(severityOf(report, "root_jump"), CheckSeverity::kWarning);
  EXPECT_GT(numberOf(report, "root_jump"), 100);  // mm
  EXPECT_EQ(severityOf(report, "root_speed"), CheckSeverity::kWarning);
}

TEST_F(CheckClipOfAnArm, JointsThatAClipLacksStandStillOrAreCarried) {
  writeBvh("upper");
  const CheckReport whole = checked();
  EXPECT_EQ(severityOf(whole, "joints_still"), CheckSeverity::kOk);
  EXPECT_TRUE(has(whole.find("joints_carried")->what, "lower"));
  writeBvh("lower");
  const CheckReport part = checked();
  EXPECT_EQ(severityOf(part, "joints_still"), CheckSeverity::kWarning);
  EXPECT_TRUE(has(part.find("joints_still")->what, "upper"));
}

TEST_F(CheckClipOfAnArm, ReadsTheStrandsBeforeCleaningToo) {
  std::vector<std::vector<Vec3>> strands = fur(50, 0.02f, 0.48f, 0.0395f, 0.05f);
  strands[4][3] = strands[4][2];
  writeStrands(folder_ / "hair.obj", strands);
  const CheckedScene checked = loadForCheck(options_);
  EXPECT_EQ(checked.as_read.vertices(), 400u);
  EXPECT_EQ(checked.scene.groom.strands.vertices(), 399u);
  EXPECT_TRUE(checked.scene.bodies.empty()) << "nothing is baked";
  EXPECT_EQ(numberOf(checkScene(checked, options_, 60), "zero_edges"), 1);
}

TEST_F(CheckClipOfAnArm, ProgressCanStopIt) {
  writeStrands(folder_ / "hair.obj", fur(50, 0.02f, 0.48f, 0.0395f, 0.05f));
  const CheckedScene checked = loadForCheck(options_);
  EXPECT_THROW(checkScene(checked, options_, 60, [](const std::string&, double) { return false; }),
               BakeStopped);
}

TEST(LoadForCheck, NeedsAGroom) {
  expectError([] { loadForCheck({}); }, {"no groom file is given", "GROOM"});
}

/// Real heads, where they are.
TEST(CheckScene, SintelIsInPlaceAndAWrongUnitIsAnswered) {
  SceneOptions options;
  options.groom = {dataFolder() / "sintel" / "sintel_hair_16pts.tfx"};
  options.body = dataFolder() / "sintel" / "sintel.obj";
  if (!std::filesystem::exists(options.body)) GTEST_SKIP() << "no real data at " << dataFolder();
  options.units.unit_meters = 1;
  const CheckedScene right = loadForCheck(options);
  EXPECT_EQ(checkPlacement(right.scene, options, MeshQuery(right.scene.body)).count(CheckSeverity::kFault),
            0u);
  options.body_units.unit_meters = 100;
  const CheckedScene wrong = loadForCheck(options);
  const CheckReport report = checkPlacement(wrong.scene, options, MeshQuery(wrong.scene.body));
  EXPECT_EQ(severityOf(report, "scale"), CheckSeverity::kFault);
  EXPECT_TRUE(has(remedyOf(report, "scale"), "--body-unit-meters 1?")) << remedyOf(report, "scale");
}

}  // namespace
}  // namespace strandcast
