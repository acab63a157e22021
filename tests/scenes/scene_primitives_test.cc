#include "scenes/scene_primitives.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <numbers>

#include "scenes/scene.h"
#include "simd/simd_backend.h"
#include "tests/collision/shapes.h"
#include "tests/expect_error.h"
#include "tests/io/scratch_folder.h"

namespace strandcast {
namespace {

// Five hairs of 12 cm that grow sideways from the origin and fall, and further bodies.
class ScenePrimitives : public testing::Test {
 protected:
  ScenePrimitives() {
    std::ofstream hair(folder_ / "hair.obj");
    for (int s = 0; s < kStrands; ++s) {
      for (int i = 0; i < kVertices; ++i)
        hair << "v " << 0.01 * i << " 0 " << 0.002 * (s - kStrands / 2) << '\n';
      hair << 'l';
      for (int i = 0; i < kVertices; ++i) hair << ' ' << s * kVertices + i + 1;
      hair << '\n';
    }
    options_.groom = {folder_ / "hair.obj"};
    options_.units.unit_meters = 1;
    options_.units.up = UpAxis::kY;
    options_.field_cache = folder_ / "fields";
    options_.motion = "still";
  }
  std::filesystem::path write(const char* name, const TriangleMesh& mesh, float unit = 1) const {
    std::ofstream out(folder_ / name);
    for (const Vec3& p : mesh.positions)
      out << "v " << p.x() / unit << ' ' << p.y() / unit << ' ' << p.z() / unit << '\n';
    for (const auto& t : mesh.triangles)
      out << "f " << t[0] + 1 << ' ' << t[1] + 1 << ' ' << t[2] + 1 << '\n';
    return folder_ / name;
  }
  static ScenePrimitive of(PrimitiveKind kind, const std::filesystem::path& file, const Vec3& at) {
    ScenePrimitive primitive;
    primitive.shape.kind = kind;
    primitive.shape.a = at;
    primitive.file = file;
    primitive.where = "hair.toml line 9";
    return primitive;
  }
  std::string error() const {
    return errorOf([&] { makeScene(options_); });
  }
  /// Distance of a point from the surface of a shape of the scene at rest, m.
  static float distance(const ContactPrimitive& shape, const Vec3& p) {
    ShapeData data;
    const uint32_t at = data.add(shape);
    return signedDistance(moved(shape, Pose{}, Pose{}, 1, at), p, data.words);
  }
  /// Position of the tip of the middle hair after a second in which the head rises by `rise`.
  static Vec3 tipAfter(const Scene& scene, float rise) {
    Parameters parameters = scene.parameters;
    parameters.solver = SolverKind::kRod;
    Simulation simulation(sceneModel(scene), scene.bodies, parameters, makeSimdBackend());
    for (int i = 1; i <= 60; ++i) {
      simulation.setHeadPose({Vec3(0, rise * static_cast<float>(i) / 60, 0), Quat::Identity()});
      simulation.step();
    }
    EXPECT_EQ(simulation.measure().non_finite, 0u);
    return simulation.guides()[(kStrands / 2 + 1) * kVertices - 1];
  }

  static constexpr int kStrands = 5, kVertices = 13;
  ScratchFolder folder_;
  SceneOptions options_;
};

TEST_F(ScenePrimitives, ThoseThatFollowTheHeadAreOneBodyAndThoseThatStandAnother) {
  ScenePrimitive ball = of(PrimitiveKind::kSphere, {}, Vec3(0, 1, 0));
  ball.shape.radius = 0.1f;
  ball.shape.friction = 0.7f;
  options_.primitives = {ball, ball, ball};
  options_.primitives[1].follows_head = false;
  options_.primitives[1].shape.friction = 0;
  const Scene scene = makeScene(options_);
  ASSERT_EQ(scene.bodies.size(), 2u);
  EXPECT_TRUE(scene.bodies[0].follows_head);
  ASSERT_EQ(scene.bodies[0].primitives.size(), 2u);
  EXPECT_FLOAT_EQ(scene.bodies[0].primitives[1].friction, 0.7f);
  EXPECT_FALSE(scene.bodies[1].follows_head);
  ASSERT_EQ(scene.bodies[1].primitives.size(), 1u);
  EXPECT_EQ(scene.bodies[1].primitives[0].friction, 0);
}

TEST_F(ScenePrimitives, OneWithANameIsABodyOfItsOwn) {
  ScenePrimitive ball = of(PrimitiveKind::kSphere, {}, Vec3(0, 1, 0));
  ball.shape.radius = 0.1f;
  options_.primitives = {ball, ball, ball, ball};
  options_.primitives[0].name = "hat";
  options_.primitives[1].name = "a stone";
  options_.primitives[1].follows_head = false;
  const Scene scene = makeScene(options_);
  ASSERT_EQ(scene.bodies.size(), 3u);
  EXPECT_EQ(scene.bodies[0].primitives.size(), 2u) << "those without a name";
  EXPECT_EQ(scene.named_bodies, (std::map<std::string, BodyId>{{"hat", 1}, {"a stone", 2}}));
  EXPECT_TRUE(scene.bodies[1].follows_head);
  EXPECT_EQ(scene.bodies[1].primitives.at(0).a, Vec3(0, 1, 0)) << "where the head is at rest";
  EXPECT_FALSE(scene.bodies[2].follows_head);
  options_.primitives[3].name = "hat";
  options_.primitives[3].where = "hair.toml line 20";
  EXPECT_EQ(
      error(),
      "two bodies are called 'hat': hair.toml line 20; give it a unique name: the other is hair.toml line 9");
  options_.primitives[3].name = "bust";
  options_.body_name = "bust";
  EXPECT_NE(error().find("'bust': hair.toml line 20; give it a unique name: the other is [body]"),
            std::string::npos);
  options_.primitives.clear();
  EXPECT_NE(error().find("no body is given for the name 'bust'"), std::string::npos);
}

TEST_F(ScenePrimitives, OneWithANameThatStandsIsPlacedByItsPose) {
  const std::filesystem::path box = write("box.obj", shapes::box(Vec3(0.1f, 0.02f, 0.05f)));
  const Quat turn(Eigen::AngleAxisf(0.7f, Eigen::Vector3f(1, 2, 2).normalized()));
  for (const PrimitiveKind kind :
       {PrimitiveKind::kSphere, PrimitiveKind::kCapsule, PrimitiveKind::kTaperedCapsule,
        PrimitiveKind::kPlane, PrimitiveKind::kEllipsoid, PrimitiveKind::kBox, PrimitiveKind::kConvex,
        PrimitiveKind::kField}) {
    const bool has_file = kind == PrimitiveKind::kConvex || kind == PrimitiveKind::kField;
    ScenePrimitive primitive = of(kind, has_file ? box : "", Vec3(0.1f, 0.5f, -0.2f));
    primitive.follows_head = false;
    primitive.shape.b = kind == PrimitiveKind::kPlane ? Vec3(Vec3(1, 2, 0).normalized()) : Vec3(0, 0.6f, 0);
    primitive.shape.radius = 0.03f;
    primitive.shape.radius_b = 0.02f;
    primitive.shape.extent = Vec3(0.1f, 0.02f, 0.05f);
    primitive.shape.rotation = turn;
    primitive.cell = kind == PrimitiveKind::kField ? 0.004f : 0;
    options_.primitives = {primitive};
    const ContactPrimitive plain = makeScene(options_).bodies.at(0).primitives.at(0);
    options_.primitives[0].name = "it";
    const RigidBody named = makeScene(options_).bodies.at(0);
    EXPECT_EQ(named.pose.position, primitive.shape.a);
    const bool turns = kind >= PrimitiveKind::kEllipsoid;
    if (turns) {
      EXPECT_LT(named.pose.rotation.angularDistance(turn), 1e-6f);
    }
    const Pose back = named.pose.inverse();
    for (const Vec3& p : {Vec3(0.1f, 0.52f, -0.2f), Vec3(0.16f, 0.5f, -0.17f), Vec3(0.1f, 0.5f, -0.26f)})
      EXPECT_NEAR(distance(named.primitives.at(0), back.apply(p)), distance(plain, p), 4e-4f)
          << static_cast<int>(kind);
  }
}

TEST_F(ScenePrimitives, WithoutASkinThereIsNoJointToHangOn) {
  ScenePrimitive ball = of(PrimitiveKind::kSphere, {}, Vec3(0, 1, 0));
  ball.shape.radius = 0.1f;
  ball.joint = "hand";
  options_.primitives = {ball};
  const std::string told = error();
  EXPECT_NE(told.find("the body is not skinned, so it has no joint 'hand'"), std::string::npos) << told;
  EXPECT_NE(told.find("hair.toml line 9; give [body]"), std::string::npos) << told;
}

TEST_F(ScenePrimitives, TheBodysFrictionIsItsOwn) {
  ScenePrimitive ball = of(PrimitiveKind::kSphere, {}, Vec3(0, 1, 0));
  ball.shape.radius = 0.1f;
  options_.primitives = {ball};
  options_.body = write("ball.obj", shapes::sphere(0.05f, 2, Vec3(-0.05f, 0, 0)));
  options_.body_friction = 0.8f;
  options_.body_cell = 0.005f;
  for (const BodyContact contact : {BodyContact::kField, BodyContact::kSpheres}) {
    options_.body_contact = contact;
    const Scene scene = makeScene(options_);
    ASSERT_EQ(scene.bodies.size(), 2u);
    for (const ContactPrimitive& shape : scene.bodies[0].primitives) EXPECT_FLOAT_EQ(shape.friction, 0.8f);
    EXPECT_FLOAT_EQ(scene.bodies[1].primitives[0].friction, 0.3f);
  }
  options_.groom.clear();
  options_.body.clear();
  options_.strands = 20;
  EXPECT_FLOAT_EQ(makeScene(options_).bodies[0].primitives[0].friction, 0.8f) << "a procedural one's too";
}

TEST_F(ScenePrimitives, MeshesStandWhereTheyArePlaced) {
  const std::filesystem::path box = write("box.obj", shapes::box(Vec3(0.1f, 0.02f, 0.05f)));
  for (const PrimitiveKind kind : {PrimitiveKind::kConvex, PrimitiveKind::kField}) {
    ScenePrimitive primitive = of(kind, box, Vec3(0, 0.5f, 0));
    primitive.shape.rotation =
        Quat(Eigen::AngleAxisf(std::numbers::pi_v<float> / 2, Eigen::Vector3f::UnitZ()));  // x becomes y
    primitive.shape.friction = 0.6f;
    primitive.cell = kind == PrimitiveKind::kField ? 0.004f : 0;
    options_.primitives = {primitive};
    const Scene scene = makeScene(options_);
    ASSERT_EQ(scene.bodies.size(), 1u);
    const ContactPrimitive& shape = scene.bodies[0].primitives.at(0);
    EXPECT_EQ(shape.kind, kind);
    EXPECT_FLOAT_EQ(shape.friction, 0.6f);
    EXPECT_NEAR(distance(shape, Vec3(0, 0.605f, 0)), 0.005f, 2e-4f);
    EXPECT_NEAR(distance(shape, Vec3(0.025f, 0.5f, 0)), 0.005f, 2e-4f);
    EXPECT_NEAR(distance(shape, Vec3(0, 0.5f, 0.045f)), -0.005f, 2e-4f);
    if (shape.field) {
      EXPECT_FLOAT_EQ(shape.field->grid.cell, 0.004f);
    }
  }
}

TEST_F(ScenePrimitives, AMeshHasTheUnitOfTheHairAndTheCellOfTheBody) {
  options_.units.unit_meters = 0.5f;
  options_.body_cell = 0.003f;
  options_.primitives = {of(PrimitiveKind::kField, write("ball.obj", shapes::sphere(0.05f, 3), 0.5f), {})};
  options_.primitives[0].shape.a = Vec3(0, -0.2f, 0);
  const Scene scene = makeScene(options_);
  const ContactPrimitive& shape = scene.bodies.at(0).primitives.at(0);
  EXPECT_FLOAT_EQ(shape.field->grid.cell, 0.003f);
  EXPECT_NEAR(distance(shape, Vec3(0, -0.145f, 0)), 0.005f, 5e-4f);
  const auto noted = [&](const Scene& made, const std::string& text) {
    return std::any_of(made.notes.begin(), made.notes.end(), [&](const std::string& line) {
      return line.starts_with("ball.obj: ") && line.find(text) != std::string::npos;
    });
  };
  EXPECT_TRUE(noted(scene, "MiB, baked"));
  EXPECT_TRUE(noted(makeScene(options_), "MiB, found in the cache"));
}

TEST_F(ScenePrimitives, AMeshThatIsNotConvexIsRefusedAsAConvexBodyAndTakenAsAMesh) {
  const std::filesystem::path potato = write("potato.obj", shapes::potato(0.05f, 3));
  options_.primitives = {of(PrimitiveKind::kConvex, potato, Vec3(0, 0.5f, 0))};
  const std::string told = error();
  EXPECT_NE(told.find("the mesh is not convex"), std::string::npos) << told;
  EXPECT_NE(told.find("potato.obj"), std::string::npos) << told;
  EXPECT_NE(told.find("hair.toml line 9; kind = \"mesh\""), std::string::npos) << told;
  options_.primitives[0].shape.kind = PrimitiveKind::kField;
  EXPECT_EQ(error(), "");
  options_.primitives[0].file = folder_ / "none.obj";
  EXPECT_NE(error().find("none.obj"), std::string::npos);
}

TEST_F(ScenePrimitives, MeshesAreToldApartByNameWhereverTheyStand) {
  const auto hashes = [&](const Vec3& size, const Vec3& at, const std::string& name) {
    ScenePrimitive box = of(PrimitiveKind::kConvex, write("box.obj", shapes::box(size)), at);
    box.name = name;
    options_.primitives = {box};
    return makeScene(options_).mesh_hashes;
  };
  const Vec3 size(0.1f, 0.02f, 0.1f), at(0, -0.3f, 0);
  const auto first = hashes(size, at, "box");
  ASSERT_EQ(first.size(), 1u);
  EXPECT_EQ(first.count("box"), 1u);
  EXPECT_EQ(hashes(size, 2 * at, "box"), first) << "its place is the scene's";
  EXPECT_NE(hashes(1.001f * size, at, "box"), first);
  const auto unnamed = hashes(size, at, "");
  EXPECT_EQ(unnamed.count(""), 1u);
  options_.primitives.push_back(options_.primitives[0]);
  EXPECT_NE(makeScene(options_).mesh_hashes, unnamed) << "two are not one";
  options_.primitives.clear();
  EXPECT_TRUE(makeScene(options_).mesh_hashes.empty());
}

TEST_F(ScenePrimitives, HairLiesOnThem) {
  const std::filesystem::path slab = write("slab.obj", shapes::box(Vec3(0.2f, 0.01f, 0.2f)));
  const float tip = tipAfter(makeScene(options_), 0).y();
  EXPECT_LT(tip, -0.04f) << "without a body";
  for (const PrimitiveKind kind : {PrimitiveKind::kConvex, PrimitiveKind::kField}) {
    options_.primitives = {of(kind, slab, Vec3(0, -0.03f, 0))};  // its top is at -2 cm
    options_.primitives[0].cell = kind == PrimitiveKind::kField ? 0.004f : 0;
    for (const bool follows : {true, false}) {
      options_.primitives[0].follows_head = follows;
      EXPECT_NEAR(tipAfter(makeScene(options_), 0).y(), -0.02f, 5e-4f) << "at rest";
      // The head carries the slab along, or lifts the hair off it.
      EXPECT_NEAR(tipAfter(makeScene(options_), 0.03f).y(), follows ? 0.01f : -0.02f, 5e-3f);
    }
  }
}

TEST_F(ScenePrimitives, AStandingMeshThatTouchesTheBodyIsWarnedOf) {
  options_.body = write("ball.obj", shapes::sphere(0.05f, 2, Vec3(-0.05f, 0, 0)));
  options_.body_cell = 0.005f;
  options_.primitives = {of(PrimitiveKind::kField, write("box.obj", shapes::box(Vec3(0.05f, 0.02f, 0.05f))),
                            Vec3(-0.05f, -0.07f, 0))};
  const auto warned = [&] {
    const Scene scene = makeScene(options_);
    return std::any_of(scene.warnings.begin(), scene.warnings.end(), [](const std::string& line) {
      return line.find("of box.obj, which does not follow the head") != std::string::npos;
    });
  };
  EXPECT_FALSE(warned()) << "it follows the head";
  options_.primitives[0].follows_head = false;
  EXPECT_TRUE(warned());
  options_.primitives[0].shape.a.y() = -0.2f;
  EXPECT_FALSE(warned()) << "it is away from it";
}

TEST_F(ScenePrimitives, AMeshOfAnUnlikelySizeIsReportedAsItsUnit) {
  const std::filesystem::path box = write("box.obj", shapes::box(Vec3(0.1f, 0.02f, 0.05f)));
  for (const auto& [unit, size] :
       {std::pair{1000.0f, "200 m"}, {101.0f, "20.2 m"}, {1.0f, ""}, {0.004f, "0.0008 m"}}) {
    ScenePrimitive stone = of(PrimitiveKind::kConvex, box, Vec3(0, 0.5f, 0));
    stone.units.unit_meters = unit;
    options_.primitives = {stone};
    std::vector<std::string> expected;
    if (*size != 0)
      expected.push_back(box.string() +
                         fmt::format(": with a unit of {:g} m it is {} large: give its unit", unit, size));
    EXPECT_EQ(makeScene(options_).warnings, expected);
    stone.file = "box.obj";  // as for meshes named by commands
    stone.beneath = folder_.path();
    for (std::string& line : expected) line.replace(0, box.string().size(), "box.obj");
    EXPECT_EQ(primitiveBodies({stone}, {}, {}, {}).warnings, expected);
  }
}

}  // namespace
}  // namespace strandcast
