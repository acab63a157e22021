#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <map>
#include <string>
#include <utility>

#include "core/backend.h"
#include "scenes/scene.h"

namespace strandcast {
namespace {

using Golden = std::map<std::pair<std::string, std::string>, uint64_t>;  // by scene and solver

// A change of a hash is a change of the physics or of a scene: note it in the change log. To renew the table,
// run golden_hashes_test and copy the lines that it prints.
const Golden& goldenHashes() {
  static const Golden table = {
      {{"straight", "rod"}, 12164754414526500347ull}, {{"straight", "gauss_seidel"}, 7103694705039075236ull},
      {{"wavy", "rod"}, 8344408203616958258ull},      {{"wavy", "gauss_seidel"}, 12063307036479198475ull},
      {{"curly", "rod"}, 5555431453430724462ull},     {{"curly", "gauss_seidel"}, 14465357970474829017ull},
      {{"ponytail", "rod"}, 5174762016745500400ull},  {{"ponytail", "gauss_seidel"}, 7318235554445229329ull},
  };
  return table;
}

// Functions of the C library may differ in the last digit from machine to machine, and with them the grown
// hair and the shapes of the body. Rounding to multiples of 15 um removes these differences.
float snapped(float meters) { return std::round(meters * 65536) / 65536; }
Vec3 snapped(const Vec3& place) {
  return place.unaryExpr([](float x) { return snapped(x); });
}

Scene snappedScene(const std::string& name) {
  SceneOptions options;
  options.name = name;
  options.strands = 40;
  Scene scene = makeScene(options);
  for (Vec3& position : scene.groom.strands.positions) position = snapped(position);
  for (RigidBody& body : scene.bodies)
    for (ContactPrimitive& primitive : body.primitives) {
      primitive.a = snapped(primitive.a);
      primitive.b = snapped(primitive.b);
      primitive.radius = snapped(primitive.radius);
      primitive.radius_b = snapped(primitive.radius_b);
    }
  return scene;
}

uint64_t hashAfterAShake(const std::string& name, SolverKind solver) {
  Scene scene = snappedScene(name);
  Parameters parameters = scene.parameters;
  parameters.solver = solver;
  Simulation simulation(sceneModel(scene), scene.bodies, parameters, makeReferenceBackend());
  for (int i = 1; i <= 30; ++i) {
    // A parabola back and forth, and a rotation about y whose quaternion needs only products and a square
    // root.
    const float t = static_cast<float>(i) / 30, y = 0.3f * t * (1 - t);
    simulation.setHeadPose({Vec3(0.2f * t * (1 - t), 0, 0.05f * t), Quat(std::sqrt(1 - y * y), 0, y, 0)});
    simulation.step();
  }
  EXPECT_EQ(simulation.measure().non_finite, 0u) << name;
  return stateHash(simulation.state());
}

TEST(GoldenHashes, EveryNamedSceneMovesAsItDidWithEitherSolver) {
  for (const SceneInfo& info : sceneList())
    for (const SolverKind solver : {SolverKind::kRod, SolverKind::kGaussSeidel}) {
      const std::string name = solverName(solver);
      const uint64_t hash = hashAfterAShake(info.name, solver);
      const auto known = goldenHashes().find({info.name, name});
      EXPECT_TRUE(known != goldenHashes().end() && known->second == hash)
          << fmt::format("      {{{{\"{}\", \"{}\"}}, {}ull}},", info.name, name, hash);
    }
}

}  // namespace
}  // namespace strandcast
