// Real grooms on their own bodies, under a head that is shaken and then keeps still.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "core/sag_free.h"
#include "core/simulation.h"
#include "groom/groom.h"
#include "groom/groom_operations.h"
#include "scenes/scene.h"
#include "service/shake_trial.h"
#include "simd/simd_backend.h"
#include "tests/real_data.h"

namespace strandcast {
namespace {

struct Head {
  const char* name;
  std::vector<std::string> groom;
  std::string body;
  float unit_meters;
};

class RealHeads : public testing::TestWithParam<Head> {};

TEST_P(RealHeads, RestAfterBeingShaken) {
  Settings settings;
  settings.backend = "simd";
  for (const std::string& file : GetParam().groom) settings.scene.groom.push_back(dataFolder() / file);
  settings.scene.body = dataFolder() / GetParam().body;
  settings.scene.units.unit_meters = GetParam().unit_meters;
  settings.scene.motion = "shake";
  settings.scene.body_cell = 0.005f;  // m, coarse, so that it is baked in seconds
  for (const auto& file : settings.scene.groom)
    if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is not there";

  const Scene scene = makeScene(settings.scene);
  ShakeTrial trial(scene, settings, 2, 3);
  for (size_t i = 0; i < trial.steps(); ++i) trial.step();
  const ShakeResult result = trial.result();
  EXPECT_LT(result.rest_speed, kRestingSpeed);
  EXPECT_LT(result.max_penetration, 1e-3);
  EXPECT_EQ(result.strands_reset, 0u);
  EXPECT_EQ(trial.simulation().measure().non_finite, 0u);
}

INSTANTIATE_TEST_SUITE_P(Heads, RealHeads,
                         testing::Values(Head{"ponytail",
                                              {"ponytail/tail.tfx", "ponytail/side.tfx",
                                               "ponytail/front_top.tfx", "ponytail/back.tfx"},
                                              "ponytail/ponytail_body.obj",
                                              0.0025f}),
                         [](const auto& head) { return head.param.name; });

// Resampling a groom of few vertices to many leaves a kink at each original vertex, between edges far stiffer
// than the original ones.
struct Part {
  const char* name;
  std::string file;
  float unit_meters;
};

class RealParts : public testing::TestWithParam<Part> {};

TEST_P(RealParts, RestWithManyVertices) {
  constexpr int kSteps = 400;
  constexpr float kResting = 0.01f;  // m/s
  const std::filesystem::path file = dataFolder() / GetParam().file;
  if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is not there";
  GroomReadOptions options;
  options.unit_meters = GetParam().unit_meters;
  const StrandSet strands = loadGroom({file}, options).strands;
  for (const uint32_t vertices : {48, 64}) {
    StrandModel model = makeStrandModel(resample(subset(strands, chooseGuides(strands, 16)), vertices));
    Parameters parameters;
    parameters.air_drag = 5;
    parameters.damping_time = 0.002f;
    makeSagFree(model, parameters.gravity);
    Simulation simulation(model, {}, parameters, makeSimdBackend(1));
    for (int i = 0; i < kSteps; ++i) simulation.step();
    const StrandState state = simulation.state();
    float fastest = 0;
    for (const Vec3& velocity : state.velocities) fastest = std::max(fastest, velocity.norm());
    EXPECT_LT(fastest, kResting) << vertices << " vertices";
  }
}

INSTANTIATE_TEST_SUITE_P(Parts, RealParts,
                         testing::Values(Part{"tail", "ponytail/tail.tfx", 0.0025f},
                                         Part{"side", "ponytail/side.tfx", 0.0025f},
                                         Part{"sintel", "sintel/sintel_hair_16pts.tfx", 1},
                                         Part{"bear", "bear/bear.tfx", 0.01f}),
                         [](const auto& part) { return part.param.name; });

}  // namespace
}  // namespace strandcast
