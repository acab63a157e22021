#include "scenes/scene.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "core/error.h"
#include "simd/simd_backend.h"
#include "tests/real_data.h"

namespace strandcast {
namespace {

/// Runs `steps` steps of a scene and gives the worst of what was measured after each.
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
    // The ponytail is pinned at its tie too: the edge before a pin takes what the others leave over.
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
    EXPECT_EQ(model.inverse_mass[model.offsets[s + 1] - 1], 0) << "the tip, to the head";
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

struct RealGroom {
  const char* name;
  std::vector<const char*> files;
  const char* body;
  float unit;
  size_t strands;
};

TEST(Scenes, RealGroomsRun300StepsAndStayFinite) {
  const std::vector<RealGroom> grooms = {
      {"ponytail", {"tail.tfx", "side.tfx", "front_top.tfx", "back.tfx"}, "ponytail_body.obj", 0.0025f, 4933},
      {"sintel", {"sintel_hair_16pts.tfx"}, "sintel-collider.obj", 1, 11400},
      {"bear", {"bear.tfx"}, "bear_body.obj", 0.01f, 48113 - 270},
      {"curls", {"frame_00.obj"}, nullptr, 0.01f, 98}};
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
    const Scene scene = makeScene(options);
    EXPECT_EQ(scene.groom.strands.strands(), real.strands) << real.name;
    const Measurement worst = run(scene, 300);
    EXPECT_EQ(worst.non_finite, 0u) << real.name;
    EXPECT_LT(worst.max_penetration, 1e-3) << real.name;
    std::printf("             %s: stretch at most %.1e, penetration at most %.2e m\n", real.name,
                worst.max_stretch, worst.max_penetration);
  }
}

}  // namespace
}  // namespace strandcast
