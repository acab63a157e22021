// strandbench accuracy as a user runs it, with a few settings.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

namespace {

namespace fs = std::filesystem;

std::string contents(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

TEST(Accuracy, TheRodConvergesAndGaussSeidelStaysFarFromIt) {
  const fs::path folder = fs::temp_directory_path() / ("strandcast_accuracy_" + std::to_string(getpid()));
  fs::create_directories(folder);
  const std::string command =
      STRANDCAST_BENCH
      " accuracy --substeps 4,8 --iterations 8 --copies 32 --rounds 1 --frames 2 --json --plot " +
      (folder / "plot.svg").string() + " >" + (folder / "out.json").string();
  ASSERT_EQ(std::system(command.c_str()), 0);
  const nlohmann::json report = nlohmann::json::parse(contents(folder / "out.json"));
  const std::string plot = contents(folder / "plot.svg");
  fs::remove_all(folder);

  ASSERT_EQ(report["results"].size(), 4u);
  for (const char* strand : {"straight", "curl"}) {
    const auto of = [&](size_t setting, const char* what) {
      return report["results"][setting][strand][what].get<double>();
    };
    EXPECT_LT(report["truth_error_mm"][strand], 0.2) << strand;
    EXPECT_LT(of(1, "tip_error_mm"), 0.6 * of(0, "tip_error_mm")) << strand << ": rod, 8 substeps for 4";
    EXPECT_LT(of(0, "rest_error_mm"), 0.1) << strand;
    EXPECT_LT(of(0, "max_stretch"), 1e-4) << strand;
    EXPECT_GT(of(2, "tip_error_mm"), 2 * of(0, "tip_error_mm")) << strand << ": gauss_seidel, 4 substeps";
    EXPECT_GT(of(2, "max_stretch"), 0.01) << strand;
  }
  EXPECT_GT(report["results"][0]["ns_per_vertex_frame"], 0);
  EXPECT_NE(plot.find("gauss_seidel, 8 substeps"), std::string::npos);
}

TEST(Accuracy, RefusesWhatLeavesNothingToMeasure) {
  const int status =
      std::system(STRANDCAST_BENCH " accuracy --solvers gauss_seidel --substeps 8 --sweeps 4 2>/dev/null");
  EXPECT_EQ(WEXITSTATUS(status), 2);
}

}  // namespace
