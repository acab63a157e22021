// strandbench scaling as a user runs it, and the fit of its exponents.
#include <gtest/gtest.h>

#include <cmath>

#include "bench/report.h"
#include "simd/simd_backend.h"
#include "tests/bench/bench_program.h"
#include "transport/dds.h"

namespace strandcast {
namespace {

TEST(PowerLaw, IsFoundExactly) {
  const std::vector<std::pair<double, double>> points{
      {1, 3}, {10, 3 * std::pow(10, 1.25)}, {100, 3 * std::pow(100, 1.25)}};
  const PowerLaw law = fitPowerLaw(points);
  EXPECT_NEAR(law.exponent, 1.25, 1e-12);
  EXPECT_NEAR(law.factor, 3, 1e-12);
  EXPECT_NEAR(law.standard_error, 0, 1e-6);
}

// Analytic case: deviations of log y from the line of exponent 1 are +d, -d, -d, +d at log x = 0, 1, 2, 3.
TEST(PowerLaw, StatesHowFarOffThePointsAre) {
  const double d = 0.1;
  std::vector<std::pair<double, double>> points;
  for (const auto& [x, off] : {std::pair{0.0, d}, {1.0, -d}, {2.0, -d}, {3.0, d}})
    points.emplace_back(std::exp(x), std::exp(x + off));
  const PowerLaw law = fitPowerLaw(points);
  EXPECT_NEAR(law.exponent, 1, 1e-12);
  EXPECT_NEAR(law.standard_error, std::sqrt(4 * d * d / (2 * 5)), 1e-12);
}

nlohmann::json rowOf(const nlohmann::json& report, const std::string& axis, double value) {
  for (const nlohmann::json& row : report["results"])
    if (row["axis"] == axis && row["value"] == value) return row;
  return nullptr;
}

TEST(Scaling, CostGrowsAndMemoryPerVertexDoesNot) {
  const nlohmann::json report = benchJson(
      "scaling --quick --budget 300 --axes strands,vertices,substeps --strands 200 --max-strands 1000");
  ASSERT_TRUE(report.is_object());
  ASSERT_EQ(report["fits"].size(), 3u);
  for (const nlohmann::json& fit : report["fits"]) {
    // Fitted to processor time, which excludes other load on the machine.
    EXPECT_GT(fit["exponent"], 0.6) << fit;
    EXPECT_LT(fit["exponent"], 1.6) << fit;
  }
  const double few = rowOf(report, "strands", 100)["bytes_per_vertex"],
               many = rowOf(report, "strands", 1000)["bytes_per_vertex"];
  EXPECT_LT(many, few) << "what is fixed is shared by more";
  EXPECT_GT(many, 0.4 * few);
  for (const nlohmann::json& row : report["results"]) {
    EXPECT_EQ(row["allocations"], 0) << row;
    EXPECT_LT(row["max_stretch"], 1e-4) << row;
  }
}

TEST(Scaling, LanesThreadsAndGroomsKeepTheirStates) {
  const nlohmann::json report = benchJson("scaling --quick --axes threads,lanes,grooms --strands 320");
  ASSERT_TRUE(report.is_object());
  size_t lanes = 0;
  for (const nlohmann::json& row : report["results"]) {
    if (row["axis"] != "lanes")
      EXPECT_EQ(row["same_hash"], "yes") << row;
    else if (row["device"] != "float, scalar, 1 thread")
      ++lanes;
  }
  EXPECT_EQ(lanes, simdTargets().size());
  EXPECT_EQ(rowOf(report, "lanes", 1)["speedup"], 1);
  EXPECT_FALSE(rowOf(report, "grooms", 16).is_null());
}

TEST(Scaling, EveryReaderGetsTheStream) {
  if (!ddsAvailable()) GTEST_SKIP() << "this build has no DDS";
  const nlohmann::json report = benchJson("scaling --quick --axes readers --strands 50 --vertices 8");
  ASSERT_TRUE(report.is_object());
  for (const double readers : {1, 2, 4, 8}) {
    const nlohmann::json row = rowOf(report, "readers", readers);
    ASSERT_TRUE(row.is_object()) << readers;
    EXPECT_GT(row["latency_ms_p50"], 0);
    EXPECT_LT(row["frames_lost"], 45 * readers) << "of 90 each";
  }
}

TEST(Scaling, SaysWhatIsLeftOut) {
  const BenchOutput out = runBench("scaling --quick --axes strands --max-strands 1000 --budget 0.001");
  EXPECT_EQ(out.status, 0);
  EXPECT_NE(out.text.find("left out: strands 1000: it would take"), std::string::npos) << out.text;
}

}  // namespace
}  // namespace strandcast
