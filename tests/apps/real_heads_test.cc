// Real grooms on their own bodies, under a head that is shaken and then keeps still.
#include <gtest/gtest.h>

#include "apps/shake_trial.h"
#include "scenes/scene.h"
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

}  // namespace
}  // namespace strandcast
