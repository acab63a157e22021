// strandbench end-to-end and wire as a user runs them, with little hair.
#include <gtest/gtest.h>

#include "bench/table.h"
#include "tests/bench/bench_program.h"
#include "transport/dds.h"

namespace strandcast {
namespace {

TEST(EndToEnd, FollowsFramesIntoAnotherProcess) {
  if (!ddsAvailable()) GTEST_SKIP() << "this build has no DDS";
  const nlohmann::json report =
      benchJson("end-to-end --rates 60,120 --strands 60 --vertices 12 --hairs 0 --seconds 0.5 --threads 1");
  ASSERT_TRUE(report.is_object());
  ASSERT_EQ(report["results"].size(), 2u);
  for (const nlohmann::json& row : report["results"]) {
    EXPECT_EQ(row["frames"], row["rate_hz"] == 60 ? 30 : 60);
    EXPECT_GT(row["frames_grown"], 0) << "they arrive";
    EXPECT_EQ(row["grown_on"], "not grown");
    EXPECT_EQ(row["allocations"], 0);
    EXPECT_LT(row["max_stretch"], 1e-4);
    double last = 0;
    for (const char* key :
         {"ms_min", "ms_p10", "ms_p25", "ms_median", "ms_p75", "ms_p90", "ms_p95", "ms_p99", "ms_max"}) {
      EXPECT_GE(row[key], last) << key;
      last = row[key];
    }
    for (const char* phase : {"wake", "step", "publish", "take", "grow"})
      EXPECT_LE(row[std::string(phase) + "_ms"], row["ms_max"]) << phase;
    EXPECT_GT(row["step_ms"], 0);
    EXPECT_GT(row["encode_ms_apart"], 0);
  }
  const nlohmann::json seeded = benchJson(
      "end-to-end --rates 120 --strands 60 --vertices 12 --hairs 0 --seconds 0.5 --threads 1 --seed 2");
  ASSERT_TRUE(seeded.is_object());
  EXPECT_NE(seeded["results"][0]["state_hash"], report["results"][1]["state_hash"]) << "other hair";
}

TEST(WireBench, SaysSizesOfTheSuite) {
  if (!ddsAvailable()) GTEST_SKIP() << "this build has no DDS";
  const nlohmann::json report =
      benchJson("wire --transports dds --strands 1000 --rates 120 --codecs float32,tangent 2>/dev/null");
  ASSERT_TRUE(report.is_object());
  ASSERT_EQ(report["results"].size(), 2u);
  EXPECT_EQ(report["results"][0]["codec"], "float32");
  EXPECT_NEAR(report["results"][0]["bytes_per_vertex"].get<double>(), 12, 1e-9);
  EXPECT_LT(report["results"][1]["bytes_per_vertex"], 2.5);
  EXPECT_LE(report["results"][1]["max_error_mm"], 0.0101);
  EXPECT_GT(report["results"][1]["latency_ms_p99"], 0);
}

TEST(WireBench, RefusesWhatLeavesNothingToCast) {
  EXPECT_EQ(runBench("wire --codecs morse 2>/dev/null").status, 2);
}

}  // namespace
}  // namespace strandcast
