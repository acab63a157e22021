// The cost of a show: its verdicts from numbers, and a run of a small scene.
#include "service/show_cost.h"

#include <gtest/gtest.h>

namespace strandcast {
namespace {

ShowCost cheap() {
  ShowCost cost;
  cost.backend = "simd";
  cost.codec = "delta16";
  cost.strands = 100;
  cost.vertices = 3200;
  cost.steps = 240;
  cost.steps_per_frame = 4;
  cost.step_ms_median = 1;
  cost.step_ms_p95 = 1.5;
  cost.encode_ms_median = 0.5;
  cost.bytes_per_frame = 11200;
  cost.memory_bytes = 800000;
  return cost;
}

CheckSeverity severityAt(const ShowCost& cost, double rate, const char* key) {
  return checkCost(cost, rate).find(key)->severity;
}

TEST(CheckCost, AFrameHasToFitItsInterval) {
  const ShowCost cost = cheap();  // 4.5 ms per frame
  EXPECT_EQ(checkCost(cost, 60).worst(), CheckSeverity::kOk);
  EXPECT_NEAR(checkCost(cost, 60).find("frame_time")->number, 4.5, 1e-9);
  EXPECT_EQ(severityAt(cost, 200, "frame_time"), CheckSeverity::kWarning);
  EXPECT_EQ(severityAt(cost, 240, "frame_time"), CheckSeverity::kFault);
  EXPECT_FALSE(checkCost(cost, 240).find("frame_time")->remedy.empty());
  EXPECT_EQ(checkCost(cost, 60).find("wire")->number, 11200);
  EXPECT_EQ(checkCost(cost, 60).find("memory")->number, 800000);
}

TEST(CheckCost, StrandsThatBreakAreAFault) {
  ShowCost cost = cheap();
  cost.strands_reset = 1;
  EXPECT_EQ(severityAt(cost, 60, "run"), CheckSeverity::kFault);
  cost = cheap();
  cost.max_stretch = 0.05;
  EXPECT_EQ(severityAt(cost, 60, "run"), CheckSeverity::kWarning);
  cost = cheap();
  cost.max_penetration = 0.02;
  EXPECT_EQ(severityAt(cost, 60, "run"), CheckSeverity::kWarning);
}

TEST(MeasureShowCost, RunsAndEncodesASmallScene) {
  Settings settings;
  settings.scene.name = "straight";
  settings.scene.strands = 40;
  settings.backend = "simd";
  settings.rate = 30;
  const Scene scene = makeScene(settings.scene);
  double part = 0;
  const ShowCost cost = measureShowCost(scene, settings, [&](double now) { part = now; });
  EXPECT_EQ(cost.backend, "simd");
  EXPECT_EQ(cost.strands, 40u);
  EXPECT_EQ(cost.vertices, scene.groom.strands.vertices());
  EXPECT_GT(cost.steps, 20u);
  EXPECT_GT(cost.step_ms_median, 0);
  EXPECT_GE(cost.step_ms_p95, cost.step_ms_median);
  EXPECT_GE(cost.steps_per_frame, 1);
  EXPECT_GT(cost.bytes_per_frame, 2 * cost.vertices);
  EXPECT_LT(cost.bytes_per_frame, 12 * cost.vertices);
  EXPECT_GT(cost.memory_bytes, 100 * cost.vertices);
  EXPECT_EQ(cost.strands_reset, 0u);
  EXPECT_GT(part, 0.5);
}

}  // namespace
}  // namespace strandcast
