// strandbench peers as a user runs it, and the conclusions from its rows.
#include <gtest/gtest.h>

#include <unistd.h>

#include <filesystem>

#include "bench/bullet_ropes.h"
#include "bench/report.h"
#include "tests/bench/bench_program.h"

namespace strandcast {
namespace {

nlohmann::json row(const char* solver, int substeps, double cost, double stretch) {
  return {
      {"solver", solver}, {"substeps", substeps}, {"ns_per_vertex_frame", cost}, {"max_stretch", stretch}};
}

TEST(PeerRatio, IsOfTheCheapestThatStretchesNoMore) {
  const std::vector<nlohmann::json> rows{row("rod", 4, 10, 1e-3), row("bullet", 1, 100, 1e-1),
                                         row("bullet", 4, 900, 1e-3), row("bullet", 4, 500, 5e-4)};
  const auto ratio = bulletOverRod(rows, 4);
  ASSERT_TRUE(ratio);
  EXPECT_TRUE(ratio->reached);
  EXPECT_EQ(ratio->ratio, 50);
  EXPECT_FALSE(bulletOverRod(rows, 8)) << "there is no such rod";
}

TEST(PeerRatio, SaysWhereNoSettingStretchesAsLittle) {
  std::vector<nlohmann::json> rows{row("rod", 4, 10, 1e-6), row("bullet", 1, 100, 1e-1),
                                   row("bullet", 4, 700, 1e-4)};
  rows.push_back({{"solver", "bullet"}, {"substeps", 1}, {"ns_per_vertex_frame", 1}});  // diverged
  const auto ratio = bulletOverRod(rows, 4);
  ASSERT_TRUE(ratio);
  EXPECT_FALSE(ratio->reached);
  EXPECT_EQ(ratio->ratio, 70);
  EXPECT_FALSE(cheapestWithin(rows, "bullet", 1e-5));
  EXPECT_FALSE(bulletOverRod({rows[0]}, 4)) << "no Bullet at all";
}

TEST(BulletRopes, HangFromTheirRootsAndFollowThem) {
  std::string reason;
  if (!bulletAvailable(&reason)) GTEST_SKIP() << reason;
  const StrandPoints points = straightStrand(0.25, 16, -Vec3::UnitY());
  BulletRopes ropes({points, points}, 6e-6);
  ropes.configure(1 / 60., 4, 64, 2);
  const Pose there{Vec3(0.02f, 0, 0), Quat::Identity()};
  ropes.step({}, there);
  for (int frame = 0; frame < 600; ++frame) ropes.step(there, there);
  const std::vector<Vec3> positions = ropes.positions();
  ASSERT_EQ(positions.size(), 34u);
  for (size_t v = 0; v < 34; ++v) {
    EXPECT_NEAR(positions[v].x(), 0.02, 1e-4) << v;
    EXPECT_NEAR(positions[v].y(), points[v % 17].y(), 3e-3) << v << ": it stretches, but little";
  }
  EXPECT_LT(positions[16].y(), -0.25) << "it stretches";
}

TEST(Peers, TheRodStretchesLeastAndBulletLessTheMoreItIterates) {
  const std::filesystem::path plot =
      std::filesystem::temp_directory_path() / ("strandcast_peers_" + std::to_string(getpid()) + ".svg");
  const nlohmann::json report =
      benchJson("peers --quick --substeps 4 --sweeps 256 --copies 16 --plot " + plot.string());
  ASSERT_TRUE(report.is_object());
  EXPECT_TRUE(std::filesystem::remove(plot));
  EXPECT_LT(report["truth_error_mm"], 0.5);
  const std::vector<nlohmann::json> rows = report["results"];
  double rod = 0, bullet_before = 0;
  for (const nlohmann::json& r : rows) {
    EXPECT_GT(r["ns_per_vertex_frame"], 0) << r;
    if (r["substeps"] != 4) continue;
    if (r["solver"] == "rod") {
      rod = r["max_stretch"];
      EXPECT_LT(rod, 1e-4);
      EXPECT_EQ(r["allocations"], 0);
    } else {
      EXPECT_GT(r["max_stretch"], 10 * rod) << r;
    }
    if (r["solver"] != "bullet") continue;
    if (bullet_before > 0) {
      EXPECT_LT(r["max_stretch"], 0.7 * bullet_before) << r;
    }
    bullet_before = r["max_stretch"];
  }
  EXPECT_EQ(bullet_before > 0, bulletAvailable());
  EXPECT_EQ(bulletOverRod(rows, 4).has_value(), bulletAvailable());
}

}  // namespace
}  // namespace strandcast
