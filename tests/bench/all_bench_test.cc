// strandbench all and report as a user runs them.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "tests/bench/bench_program.h"

namespace strandcast {
namespace {

namespace fs = std::filesystem;

TEST(AllBench, KeepsWhatItRanAndReportWritesThePageOfIt) {
  const fs::path root = fs::temp_directory_path() / ("strandcast_all_" + std::to_string(getpid()));
  const nlohmann::json report =
      benchJson("all --only step_10k --out " + (root / "results/here").string() + " 2>/dev/null");
  ASSERT_TRUE(report.is_object());
  EXPECT_TRUE(report["failed"].empty());
  ASSERT_FALSE(report["results"].empty());
  EXPECT_NE(report["results"][0]["command"].get<std::string>().find("strandbench step"), std::string::npos);
  EXPECT_TRUE(fs::exists(root / "results/here/step_10k.csv"));

  fs::create_directories(root / "images");
  const std::string call = "report --results " + (root / "results").string() + " --page " +
                           (root / "page.md").string() + " --images " + (root / "images").string();
  EXPECT_EQ(runBench(call + " --check").status, 1) << "there is no page yet";
  EXPECT_FALSE(fs::exists(root / "page.md"));
  EXPECT_EQ(runBench(call).status, 0);
  EXPECT_EQ(runBench(call + " --check").status, 0);
  fs::remove_all(root);
}

TEST(AllBench, RefusesWhatItDoesNotKnow) {
  const fs::path out = fs::temp_directory_path() / ("strandcast_none_" + std::to_string(getpid()));
  const BenchOutput unknown = runBench("all --only step_10k,everything --out " + out.string() + " 2>&1");
  EXPECT_EQ(unknown.status, 2);
  EXPECT_NE(unknown.text.find("'everything': --only; choose among step, step_10k, scaling, "),
            std::string::npos)
      << unknown.text;
  EXPECT_FALSE(fs::exists(out));
  const BenchOutput nowhere = runBench("all --only step_10k --out /proc/absent 2>&1");
  EXPECT_EQ(nowhere.status, 2);
  EXPECT_NE(nowhere.text.find("the folder cannot be made: /proc/absent"), std::string::npos) << nowhere.text;
}

}  // namespace
}  // namespace strandcast
