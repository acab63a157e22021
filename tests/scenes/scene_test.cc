#include "scenes/scene.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "collision/field_bake.h"
#include "core/error.h"
#include "core/sag_free.h"
#include "io/file_bytes.h"
#include "io/mesh_file.h"
#include "simd/simd_backend.h"
#include "tests/collision/shapes.h"
#include "tests/io/gltf_builder.h"
#include "tests/io/sample_files.h"
#include "tests/io/scratch_folder.h"
#include "tests/real_data.h"

namespace strandcast {
namespace {

/// Runs `steps` steps of a scene and returns the worst of the measurements, taken every ten steps.
Measurement run(const Scene& scene, int steps) {
  Parameters parameters = scene.parameters;
  parameters.solver = SolverKind::kRod;
  Simulation simulation(sceneModel(scene), scene.bodies, parameters, makeSimdBackend());
  Measurement worst;
  for (int i = 0; i < steps; ++i) {
    simulation.setHeadPose(scene.motion(simulation.time() + parameters.time_step));
    simulation.step();
    if (i % 10 != 9) continue;
    const Measurement now = simulation.measure();
    worst.max_stretch = std::max(worst.max_stretch, now.max_stretch);
    worst.max_penetration = std::max(worst.max_penetration, now.max_penetration);
    worst.non_finite += now.non_finite;
  }
  return worst;
}

TEST(Scenes, EveryNamedSceneKeepsItsLengthAndStaysOutOfTheBody) {
  for (const SceneInfo& info : sceneList()) {
    SceneOptions options;
    options.name = info.name;
    options.strands = 150;
    const Measurement worst = run(makeScene(options), 120);
    EXPECT_EQ(worst.non_finite, 0u) << info.name;
    EXPECT_LT(worst.max_penetration, 1e-3) << info.name;
    // The ponytail is pinned at its tie as well: the edge before a pin takes up the remaining length error.
    EXPECT_LT(worst.max_stretch, info.name == "ponytail" ? 0.05 : 1e-4) << info.name;
  }
}

TEST(Scenes, PinsTieTheirPartsToBones) {
  SceneOptions options;
  options.strands = 50;
  options.pins = {{{"straight"}, "ribbon", 0.5f, 0.6f, "hair.toml line 1"},
                  {{}, "head", 1, 1, "hair.toml line 2"}};
  const Scene scene = makeScene(options);
  const StrandModel model = sceneModel(scene);
  EXPECT_EQ(model.bones, (std::vector<std::string>{"head", "ribbon"}));
  for (size_t s = 0; s < model.strands(); ++s) {
    size_t tied = 0;
    for (uint32_t v = model.offsets[s]; v < model.offsets[s + 1]; ++v) tied += model.isBonePinned(s, v);
    EXPECT_GE(tied, 2u) << "a tenth of 27 edges";
    EXPECT_LE(tied, 4u);
    EXPECT_TRUE(model.isPinned(s, model.offsets[s + 1] - 1)) << "the tip, to the head";
  }
  options.pins = {{{"curly"}, "ribbon", 0, 1, "hair.toml line 5"}};
  try {
    sceneModel(makeScene(options));
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("no part 'curly': hair.toml line 5"), std::string::npos)
        << error.what();
  }
}

TEST(Scenes, TheSameSeedGivesTheSameHair) {
  SceneOptions options;
  options.strands = 50;
  const Scene a = makeScene(options), b = makeScene(options);
  EXPECT_EQ(a.groom.strands.positions, b.groom.strands.positions);
  options.seed = 2;
  EXPECT_NE(makeScene(options).groom.strands.positions, a.groom.strands.positions);
}

TEST(Scenes, UnknownNamesAreErrorsThatListTheKnownOnes) {
  SceneOptions options;
  options.name = "bald";
  try {
    makeScene(options);
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("curly"), std::string::npos);
  }
}

// A ball of 10 cm, and hair that starts 4 mm inside and stands out. One strand passes through the ball and
// out again.
class BallScene : public testing::Test {
 protected:
  BallScene() {
    const TriangleMesh ball = shapes::sphere(0.1f, 3);
    std::ofstream body(folder_ / "ball.obj");
    for (const Vec3& p : ball.positions) body << "v " << p.x() << ' ' << p.y() << ' ' << p.z() << '\n';
    for (const auto& t : ball.triangles)
      body << "f " << t[0] + 1 << ' ' << t[1] + 1 << ' ' << t[2] + 1 << '\n';
    std::ofstream hair(folder_ / "hair.obj");
    for (int s = 0; s < kStrands; ++s) {
      const float turn = 2.4f * static_cast<float>(s), up = 0.02f * static_cast<float>(s);
      const Vec3 out = Vec3(std::cos(turn), up, std::sin(turn)).normalized();
      for (int i = 0; i < kVertices; ++i) {
        const float along = 0.01f * static_cast<float>(i);
        const Vec3 p = s == 0 ? Vec3(0.11f - along, 0.09f, 0) : Vec3((0.096f + along) * out);
        hair << "v " << p.x() << ' ' << p.y() << ' ' << p.z() << '\n';
      }
      hair << 'l';
      for (int i = 0; i < kVertices; ++i) hair << ' ' << s * kVertices + i + 1;
      hair << '\n';
    }
    options_.groom = {folder_ / "hair.obj"};
    options_.body = folder_ / "ball.obj";
    options_.units.unit_meters = 1;
    options_.units.up = UpAxis::kY;
    options_.body_cell = 0.004f;
    options_.field_cache = folder_ / "fields";
  }

  static bool isIn(const std::vector<std::string>& lines, const std::string& text) {
    return std::any_of(lines.begin(), lines.end(),
                       [&](const std::string& line) { return line.find(text) != std::string::npos; });
  }
  static bool noted(const Scene& scene, const std::string& text) { return isIn(scene.notes, text); }

  static constexpr int kStrands = 60, kVertices = 12;
  ScratchFolder folder_;
  SceneOptions options_;
};

TEST_F(BallScene, HairThatStartsInTheBodyNeitherPopsNorSinksIn) {
  const Scene scene = makeScene(options_);
  ASSERT_EQ(scene.bodies.size(), 1u);
  EXPECT_EQ(scene.bodies[0].primitives[0].kind, PrimitiveKind::kField);
  EXPECT_TRUE(noted(scene, "may stay that deep"));
  StrandModel model = sceneModel(scene);
  Parameters parameters = scene.parameters;
  parameters.solver = SolverKind::kRod;
  makeSagFree(model, parameters.gravity);
  Simulation simulation(std::move(model), scene.bodies, parameters, makeSimdBackend());
  const StrandState start = simulation.state();
  size_t in_body = 0;
  for (const float distance : simulation.model().rest_distance) in_body += distance < 0;
  EXPECT_GE(in_body, size_t{kStrands}) << "all roots";
  double moved = 0;
  for (int i = 0; i < 60; ++i) {
    simulation.step();
    for (size_t v = 0; v < start.positions.size(); ++v)
      moved = std::max<double>(moved, (simulation.guides()[v] - start.positions[v]).norm());
  }
  EXPECT_LT(moved, 1e-4) << "nothing pops";
  Measurement worst;
  double swung = 0;
  const HeadMotion shake = headMotion("shake", scene.head_pivot);
  for (int i = 0; i < 180; ++i) {
    simulation.setHeadPose(shake((i + 1) * parameters.time_step));
    simulation.step();
    worst.max_penetration = std::max(worst.max_penetration, simulation.measure().max_penetration);
    const Pose back = simulation.headPose().inverse();
    for (size_t v = 0; v < start.positions.size(); ++v)
      swung = std::max<double>(swung, (back.apply(simulation.guides()[v]) - start.positions[v]).norm());
  }
  EXPECT_GT(swung, 0.02) << "the hair is thrown about";
  EXPECT_LT(worst.max_penetration, 1e-3);
}

TEST_F(BallScene, ADamagedFieldIsWarnedOf) {
  EXPECT_TRUE(makeScene(options_).warnings.empty());
  const std::filesystem::path file = std::filesystem::directory_iterator(folder_ / "fields")->path();
  std::filesystem::resize_file(file, std::filesystem::file_size(file) / 2);
  const Scene again = makeScene(options_);
  ASSERT_EQ(again.warnings.size(), 1u);
  EXPECT_NE(again.warnings[0].find(file.filename().string()), std::string::npos) << again.warnings[0];
  EXPECT_EQ(again.bodies[0].primitives[0].kind, PrimitiveKind::kField) << "baked anew";
}

TEST_F(BallScene, TheFieldIsBakedOnceAndSpheresStandInForIt) {
  EXPECT_TRUE(noted(makeScene(options_), "MiB, baked"));
  EXPECT_TRUE(noted(makeScene(options_), "MiB, found in the cache"));
  options_.body_cell = 0.005f;
  EXPECT_TRUE(noted(makeScene(options_), "MiB, baked")) << "another field";
  options_.body_contact = BodyContact::kSpheres;
  const Scene scene = makeScene(options_);
  ASSERT_EQ(scene.bodies.size(), 1u);
  for (const ContactPrimitive& sphere : scene.bodies[0].primitives)
    EXPECT_EQ(sphere.kind, PrimitiveKind::kSphere);
  EXPECT_FALSE(scene.bodies[0].holds_roots);
}

TEST_F(BallScene, ABodyThatEnclosesNothingIsWarnedOf) {
  EXPECT_TRUE(makeScene(options_).warnings.empty());
  std::ofstream(folder_ / "quad.obj") << "v 0 0 0\nv 0.1 0 0\nv 0.1 0.1 0\nv 0 0.1 0\nf 1 2 3 4\n";
  std::ofstream(folder_ / "sliver.obj") << "v 0 0 0\nv 0.1 0 0\nv 0.1 1e-7 0\nf 1 2 3\n";
  options_.body_cell = 0;
  for (const char* body : {"quad.obj", "sliver.obj"}) {
    options_.body = folder_ / body;
    EXPECT_TRUE(isIn(makeScene(options_).warnings, "hair passes through the body")) << body;
  }
}

/// The ball with the triangles on one side of it reversed.
void writeMirroredBall(const std::filesystem::path& file) {
  const TriangleMesh ball = shapes::sphere(0.1f, 3);
  std::ofstream body(file);
  for (const Vec3& p : ball.positions) body << "v " << p.x() << ' ' << p.y() << ' ' << p.z() << '\n';
  for (const auto& [a, b, c] : ball.triangles) {
    const bool turned = ball.positions[a].x() > 0.02f;
    body << "f " << a + 1 << ' ' << (turned ? c : b) + 1 << ' ' << (turned ? b : c) + 1 << '\n';
  }
}

TEST_F(BallScene, AMirroredHalfIsMendedAndWarnedOfAlsoFromTheCache) {
  writeMirroredBall(folder_ / "mirrored.obj");
  options_.body_cell = 0.01f;
  const Scene right = makeScene(options_);
  EXPECT_TRUE(right.warnings.empty());
  options_.body = folder_ / "mirrored.obj";
  for (int times = 0; times < 2; ++times) {
    const Scene mended = makeScene(options_);
    ASSERT_EQ(mended.warnings.size(), 1u);
    EXPECT_TRUE(isIn(mended.warnings, "triangles are wound against their neighbours")) << mended.warnings[0];
    EXPECT_EQ(mended.bodies[0].primitives[0].field->samples, right.bodies[0].primitives[0].field->samples);
  }
}

TEST_F(BallScene, BodiesKeepThickHairOffByItsRadius) {
  options_.body_cell = 0.01f;
  const Scene fine = makeScene(options_);
  EXPECT_EQ(fine.parameters.hair_radius, Parameters().hair_radius);
  EXPECT_FALSE(noted(fine, "hair_radius"));
  options_.materials = {{{}, {{"radius", {30e-6}, "a"}}, "a"}};
  EXPECT_EQ(makeScene(options_).parameters.hair_radius, Parameters().hair_radius) << "of thin hair as ever";
  options_.materials = {{{}, {{"radius", {1e-3}, "a"}, {"radius_curve", {0, 2, 1, 0.5}, "a"}}, "a"}};
  const Scene thick = makeScene(options_);
  EXPECT_FLOAT_EQ(thick.parameters.hair_radius, 2e-3f) << "at its thickest";
  EXPECT_TRUE(noted(thick, "hair_radius is 2 mm"));
  options_.hair_radius_is_set = true;
  EXPECT_FALSE(noted(makeScene(options_), "hair_radius is")) << "the user says what it is";
  const FieldGrid &thin_grid = fine.bodies[0].primitives[0].field->grid,
                  &grid = thick.bodies[0].primitives[0].field->grid;
  EXPECT_EQ(grid.cell, thin_grid.cell) << "the body is no coarser";
  EXPECT_FLOAT_EQ(grid.band, 4 * grid.cell + 2e-3f);
  Simulation simulation(sceneModel(thick), thick.bodies, thick.parameters, makeSimdBackend());
  for (int i = 0; i < 30; ++i) simulation.step();
  float nearest = 1;
  for (size_t s = 1; s < simulation.model().strands(); ++s)
    for (uint32_t v = simulation.model().offsets[s] + 3; v < simulation.model().offsets[s + 1]; ++v)
      nearest = std::min(nearest, thick.bodies[0].primitives[0].field->at(simulation.guides()[v]).distance);
  EXPECT_GT(nearest, 1.9e-3f) << "of what stands free of the ball at rest";
}

TEST_F(BallScene, SpheresThatAreNotThereAreReportedAsItIs) {
  options_.body_contact = BodyContact::kSpheres;
  options_.body_primitives = 0;
  const Scene none = makeScene(options_);
  EXPECT_TRUE(noted(none, "fitted_spheres = 0"));
  EXPECT_TRUE(none.warnings.empty()) << none.warnings[0];
  options_.body_primitives = 1;
  std::ofstream(folder_ / "hair.obj") << "v 0.1 0 0\nv 0 0 0\nv -0.1 0 0\nl 1 2 3\n";
  EXPECT_TRUE(isIn(makeScene(options_).warnings, "hair at rest lies in each of the 1 spheres"));
}

// Hair of 30 cm, in centimetres. `root`: position of the roots in metres.
void writeHair(const std::filesystem::path& file, const Vec3& root) {
  std::ofstream hair(file);
  for (int s = 0; s < 4; ++s) {
    for (int i = 0; i < 4; ++i)
      hair << "v " << 100 * root.x() + s << ' ' << 100 * root.y() + 10 * i << ' ' << 100 * root.z() << '\n';
    hair << "l -4 -3 -2 -1\n";
  }
}

TEST_F(BallScene, AGltfBodyIsInMetresWhateverTheUnitOfItsHair) {
  writeFileBytes(folder_ / "quad.glb", samples::glb());
  const TriangleMesh quad = loadMesh(folder_ / "quad.glb", {}).mesh;
  options_.body = folder_ / "quad.glb";
  options_.body_cell = 0.05f;
  options_.units.unit_meters = 0;
  writeHair(options_.groom[0], quad.positions[0]);
  const Scene scene = makeScene(options_);
  EXPECT_FLOAT_EQ(scene.groom.report.unit_meters, 0.01f);
  EXPECT_EQ(scene.body.positions, quad.positions);
  EXPECT_FALSE(isIn(scene.warnings, "and the same place?"));
  options_.units = {0.01f, UpAxis::kX};
  EXPECT_EQ(makeScene(options_).body.positions, quad.positions) << "unit and axis given are the groom's";
  options_.body_units = {0.5f, UpAxis::kZ};
  const Scene small = makeScene(options_);
  EXPECT_EQ(small.body.positions[0],
            Vec3(0.5f * quad.positions[0].x(), 0.5f * quad.positions[0].z(), -0.5f * quad.positions[0].y()));
  EXPECT_TRUE(isIn(small.warnings, "glTF is in metres, a unit of 0.5 m is taken as given"));
  EXPECT_TRUE(isIn(small.warnings, "in glTF Y is up, Z is taken as given"));
  options_.body_units = {};
  options_.units = {0, UpAxis::kY};
  writeHair(options_.groom[0], quad.positions[0] + Vec3(3, 4, 5));
  EXPECT_TRUE(isIn(makeScene(options_).warnings, "and the same place?"));
  options_.body = folder_ / "ball.obj";
  options_.body_cell = 0;
  EXPECT_NEAR(makeScene(options_).body.bounds().max().x(), 0.001f, 1e-5f) << "the guess is its own too";
}

TEST_F(BallScene, AGuessedUnitFitsTheRootsToABodyInMetres) {
  samples::GltfBuilder builder;  // a body to which the roots are near in one unit only
  std::vector<Vec3> corners = samples::tetrahedron();
  for (Vec3& corner : corners) corner += Vec3(1, 1, 1);
  const size_t position = builder.points(corners), indices = builder.indices(samples::tetrahedronTriangles());
  options_.body = folder_ / "body.gltf";
  writeFileBytes(options_.body, builder.body(fmt::format(R"("attributes":{{"POSITION":{}}},"indices":{})",
                                                         position, indices)));
  options_.body_cell = 0.05f;
  options_.units.unit_meters = 0;
  for (const float unit : {1.0f, 0.1f, 0.01f, 0.0025f, 0.001f, 0.0254f, 0.3048f}) {
    std::ofstream hair(options_.groom[0]);
    for (const Vec3& root : corners)
      for (int i = 0; i < 3; ++i)
        hair << "v " << root.x() / unit << ' ' << root.y() / unit << ' '
             << (root.z() + 0.1f * static_cast<float>(i)) / unit << '\n';
    for (size_t s = 0; s < corners.size(); ++s)
      hair << "l " << 3 * s + 1 << ' ' << 3 * s + 2 << ' ' << 3 * s + 3 << '\n';
    hair.close();
    const Scene scene = makeScene(options_);
    EXPECT_FLOAT_EQ(scene.groom.report.unit_meters, unit) << "hair of 2 m and more looks like a smaller unit";
    EXPECT_TRUE(isIn(scene.warnings, "the unit is guessed")) << unit;
    EXPECT_FALSE(isIn(scene.warnings, "and the same place?")) << unit;
  }
}

TEST_F(BallScene, AGuessedUnitStaysWhereRootsLieOnTheBodyInAnother) {
  writeFileBytes(folder_ / "quad.glb", samples::glb());  // flat, through the origin
  const TriangleMesh quad = loadMesh(folder_ / "quad.glb", {}).mesh;
  options_.body = folder_ / "quad.glb";
  options_.body_cell = 0.05f;
  options_.units.unit_meters = 0;
  for (const auto& [unit, by_size] : {std::pair{1.0f, 0.1f}, {0.1f, 0.01f}, {0.01f, 0.001f}}) {
    std::ofstream hair(options_.groom[0]);
    for (const Vec3& root : quad.positions)
      hair << "v " << root.x() / unit << ' ' << root.y() / unit << ' ' << root.z() / unit << "\nv "
           << root.x() / unit << ' ' << root.y() / unit << ' ' << (root.z() + 0.2f) / unit << '\n';
    for (size_t s = 0; s < quad.positions.size(); ++s) hair << "l " << 2 * s + 1 << ' ' << 2 * s + 2 << '\n';
    hair.close();
    EXPECT_FLOAT_EQ(makeScene(options_).groom.report.unit_meters, by_size) << "roundings are no evidence";
  }
}

TEST_F(BallScene, HairAndBodyOfOtherSizesAreReportedAsUnits) {
  EXPECT_FALSE(isIn(makeScene(options_).warnings, "m large and the body"));
  for (const auto& [unit, cell] : {std::pair{1e-3f, 5e-5f}, {1000.0f, 20.0f}}) {
    options_.body_units.unit_meters = unit;
    options_.body_cell = cell;
    EXPECT_TRUE(isIn(makeScene(options_).warnings, "(--unit-meters, --body-unit-meters)")) << unit;
  }
}

TEST_F(BallScene, UnitsOfWhatIsNotThereAreRefused) {
  const auto refusal = [&] {
    try {
      makeScene(options_);
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  options_.clip_unit_meters = 0.01f;
  EXPECT_NE(refusal().find("there is no .bvh clip"), std::string::npos);
  options_.clip_unit_meters = 0;
  options_.body_units.up = UpAxis::kZ;
  options_.body.clear();
  EXPECT_NE(refusal().find("there is no body file"), std::string::npos);
}

TEST_F(BallScene, AStrandThatRunsBackAlongItselfIsCleanedAfterResampling) {
  std::ofstream hair(options_.groom[0]);
  hair << "v 0 0 0\nv 0 0.1 0\nv 0 0.001 0\nv 0.1 0 0\nv 0.2 0 0\nv 0.3 0 0\nl 1 2 3\nl 4 5 6\n";
  hair << "v 0 0.3 0\nv 0 0.2 0\nv 0 0.3 0\nl 7 8 9\n";
  hair.close();
  options_.body.clear();
  for (const int vertices : {2, 3, 4, 16, 100, 128}) {
    options_.vertices = vertices;
    const StrandModel model = sceneModel(makeScene(options_));
    for (size_t s = 0; s < model.strands(); ++s)
      for (uint32_t v = model.offsets[s] + 1; v < model.offsets[s + 1]; ++v)
        EXPECT_GT((model.rest_local[v] - model.rest_local[v - 1]).norm(), 1e-7f) << vertices;
  }
}

TEST_F(BallScene, ProgressGoesForwardAndStopsTheBake) {
  double last = 0;
  std::string all;
  makeScene(options_, [&](const std::string& what, double part) {
    EXPECT_GE(part, last) << what;
    last = part;
    all += what + "\n";
    return true;
  });
  EXPECT_EQ(last, 1);
  EXPECT_NE(all.find("the body's distance field: "), std::string::npos) << all;
  options_.body_cell = 0.003f;
  EXPECT_THROW(makeScene(options_, [](const std::string&, double part) { return part < 0.6; }), BakeStopped);
}

struct RealGroom {
  const char* name;
  std::vector<const char*> files;
  const char* body;
  float unit;
  float body_cell;  ///< m: coarse, for a bake within seconds
  /// m, allowed depth below the surface, or below the depth at rest. The bear has short hair that lies
  /// centimetres inside the skin, where normals change within a cell.
  double deepest;
  size_t strands;
};

TEST(Scenes, RealGroomsRun120StepsAndStayFinite) {
  const std::vector<RealGroom> grooms = {
      {"ponytail",
       {"tail.tfx", "side.tfx", "front_top.tfx", "back.tfx"},
       "ponytail_body.obj",
       0.0025f,
       0.008f,
       1e-3,
       4933},
      {"sintel", {"sintel_hair_16pts.tfx"}, "sintel-collider.obj", 1, 0.006f, 1e-3, 11400},
      {"bear", {"bear.tfx"}, "bear_body.obj", 0.01f, 0.02f, 6e-3, 48113 - 270},
      {"curls", {"frame_00.obj"}, nullptr, 0.01f, 0, 1e-3, 98}};
  for (const RealGroom& real : grooms) {
    const std::filesystem::path folder = dataFolder() / real.name;
    if (!std::filesystem::exists(folder)) {
      std::printf("[ skipped  ] %s: no folder %s (set STRANDCAST_DATA)\n", real.name, folder.c_str());
      continue;
    }
    SceneOptions options;
    for (const char* file : real.files) options.groom.push_back(folder / file);
    if (real.body != nullptr) options.body = folder / real.body;
    options.units.unit_meters = real.unit;
    options.body_cell = real.body_cell;
    const Scene scene = makeScene(options);
    EXPECT_EQ(scene.groom.strands.strands(), real.strands) << real.name;
    const Measurement worst = run(scene, 120);
    EXPECT_EQ(worst.non_finite, 0u) << real.name;
    EXPECT_LT(worst.max_penetration, real.deepest) << real.name;
    std::printf("             %s: stretch at most %.1e, penetration at most %.2e m\n", real.name,
                worst.max_stretch, worst.max_penetration);
  }
}

}  // namespace
}  // namespace strandcast
