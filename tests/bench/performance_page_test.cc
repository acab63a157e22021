#include "bench/report.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "bench/table.h"
#include "core/error.h"

namespace strandcast {
namespace {

namespace fs = std::filesystem;

class ScratchResults {
 public:
  ScratchResults() : root(fs::temp_directory_path() / ("strandcast_results_" + std::to_string(getpid()))) {
    fs::create_directories(root / "machine");
  }
  ~ScratchResults() { fs::remove_all(root); }
  void write(const std::string& name, const std::string& text) { writeText(root / "machine" / name, text); }
  const fs::path root;
};

const Headline& lineOf(const std::vector<Headline>& lines, const std::string& what) {
  for (const Headline& line : lines)
    if (line.what.find(what) != std::string::npos) return line;
  throw Error("there is no such headline", what, "");
}

TEST(PerformancePage, IsWhatTheResultsThatAreKeptSay) {
  const fs::path project = STRANDCAST_SOURCE_DIR;
  const PerformancePage page = performancePage(project / "bench" / "results");
  EXPECT_TRUE(page.text == textOf(project / "docs" / "performance.md"))
      << "docs/performance.md is not what bench/results say: run strandbench report";
  EXPECT_FALSE(page.images.empty());
  for (const auto& [name, svg] : page.images)
    EXPECT_TRUE(svg == textOf(project / "docs" / "images" / name)) << name;
}

TEST(PerformancePage, HasEveryFileBesideItsCommand) {
  ScratchResults results;
  results.write(
      "step_10k.csv",
      "# strandbench step --csv\n# commit abc; A, 2 threads, AVX3\n"
      "case,device,strands,vertices,substeps,ms_median,fraction_of_peak,max_stretch,bytes_per_vertex,"
      "allocations,state_hash\nsimd,\"AVX3, 2 threads\",10000,32,6,9.5,0.31,3e-6,210.4,0,00ab\n");
  results.write("of_tomorrow.csv", "# strandbench tomorrow\na,b\n1,x|y\n");
  const std::string page = performancePage(results.root).text;
  for (const char* part : {"# machine", "`strandbench step --csv`; commit abc", "0.31", "| 00ab |",
                           "## of_tomorrow", "`strandbench tomorrow`", "x\\|y"})
    EXPECT_NE(page.find(part), std::string::npos) << part;
  EXPECT_EQ(page.find("gpu ms |"), std::string::npos) << "no column without a number";
}

TEST(PerformancePage, ResultsThatAreDamagedOrMissingAreErrors) {
  ScratchResults results;
  results.write("step.csv", "a,b\n1\n");
  EXPECT_THROW(performancePage(results.root), Error);
  EXPECT_THROW(performancePage(results.root / "nowhere"), Error);
}

TEST(Headlines, SayWhetherAGoalIsMet) {
  ScratchResults results;
  results.write("step_10k.csv",
                "# c\ncase,device,strands,vertices,substeps,ms_median,fraction_of_peak_cpu,max_stretch,"
                "bytes_per_vertex,allocations\nsimd,S,10000,32,6,9.5,0.29,3e-6,160,1\n");
  results.write(
      "scaling.csv",
      "# d\naxis,value,device,threads,ms_min,cpu_ms_min,speedup,efficiency,same_hash\n"
      "vertices,8,\"A, 1 thread\",1,9,1,,,\nvertices,64,\"A, 1 thread\",1,9,12,,,\n"
      "substeps,1,\"A, 1 thread\",1,9,1,,,\nsubsteps,8,\"A, 1 thread\",1,9,8,,,\n"
      "strands,100,\"A, 1 thread\",1,9,1,,,\nstrands,1000,\"A, 1 thread\",1,9,10,,,\n"
      "threads,2,\"A, 2 threads\",2,1,1,1.9,0.95,yes\nthreads,16,\"A, 16 threads\",16,1,1,9,0.5625,no\n"
      "lanes,16,\"AVX3, 1 thread\",1,1,1,8.1,,\nlanes,4,\"SSE4, 1 thread\",1,1,1,2,,\n");
  results.write("end_to_end.csv",
                "# e\nrate_hz,strands,vertices,hairs,ms_median,ms_p99,fps_grown\n"
                "60,5000,32,0,5,30,60\n120,5000,32,0,4,8.4,120\n");
  results.write("gpu_4k_all.csv", "# f\ndevice,gpu_ms,air_gpu_ms\nG,0.06,0.08\n");
  results.write("gpu_100k_all.csv", "# g\ndevice,gpu_ms,air_gpu_ms\nG,0.5,0.3\n");
  results.write("grid.csv",
                "# h\nstrands,vertices,cells,pass,of_strand_step,of_strand_step_cpu\n"
                "10000,32,32,splat,,\n10000,32,32,all,0.4,0.2\n10000,32,64,all,2,1\n");
  results.write(
      "gpu_grid.csv",
      "# m\ndevice,strands,vertices,cells,pass,ms\nG,100000,32,64,splat,0.1\nG,100000,32,64,all,0.2\n");
  results.write("render.csv", "# i\ndevice,hairs,vertices,growth_ms\nG,10000,64,0.1\nG,100000,64,0.4\n");
  results.write("gpu_4k_alone.csv",
                "# j\ncase,device,scene,bodies,air_cells,strands,vertices,bytes_per_vertex\n"
                "gpu,G,curly,none,0,4000,32,149\ngpu,G,curly,sphere,0,4000,32,263\n"
                "gpu,G,curly,mesh,64,4000,32,335\n");
  results.write("step_rod.csv",
                "# k\ncase,device,scene,bodies,air_cells,strands,vertices,bytes_per_vertex\n"
                "gpu,G,curly,mesh,64,100,32,890\ngpu,G,curly,none,0,100000,32,148\n");
  results.write("contact.csv",
                "# l\ncase,device,scene,strands,vertices,bytes_per_vertex,ratio\n"
                "no body,S,straight,2000,32,155,\nmesh and five primitives,S,straight,2000,32,201,1.2\n");
  const std::vector<Headline> lines = headlinesOf(readResults(results.root / "machine"));
  EXPECT_EQ(lineOf(lines, "grids of 32^3").holds, true) << "by processor time where it is known";
  EXPECT_EQ(lineOf(lines, "grids of 64^3 of 100000 x 32 alone, G").holds, true);
  EXPECT_EQ(lineOf(lines, "growth of 100000").holds, false);
  EXPECT_EQ(lineOf(lines, "air alone").holds, false);
  EXPECT_EQ(lineOf(lines, "measured peak").holds, false);
  EXPECT_EQ(lineOf(lines, "stretch").holds, true);
  EXPECT_EQ(lineOf(lines, "memory per vertex, S, simd, 10000 x 32").holds, true);
  EXPECT_EQ(lineOf(lines, "memory per vertex, G, curly, 4000 x 32").holds, true);
  EXPECT_EQ(lineOf(lines, "memory per vertex, G, curly, bodies: sphere").holds, false);
  EXPECT_EQ(lineOf(lines, "memory per vertex, G, curly, bodies: mesh, air of 64^3").measured, "890 B");
  EXPECT_EQ(lineOf(lines, "memory per vertex, G, curly, bodies: mesh, air of 64^3").command, "k")
      << "of the row that takes most";
  EXPECT_EQ(lineOf(lines, "memory per vertex, S, no body").holds, true);
  EXPECT_EQ(lineOf(lines, "memory per vertex, S, mesh and five primitives").holds, false);
  EXPECT_EQ(lineOf(lines, "allocations").holds, false);
  EXPECT_EQ(lineOf(lines, "2 threads over").holds, true);
  EXPECT_EQ(lineOf(lines, "efficiency of 16").holds, false);
  EXPECT_EQ(lineOf(lines, "16 threads give").holds, false);
  EXPECT_EQ(lineOf(lines, "AVX3").holds, true);
  EXPECT_FALSE(lineOf(lines, "SSE4").holds) << "nothing is promised of it";
  EXPECT_FALSE(lineOf(lines, "60 Hz").holds);
  EXPECT_EQ(lineOf(lines, "120 Hz").holds, false);
  EXPECT_EQ(lineOf(lines, "4,000 x 32 with").holds, true);
  EXPECT_EQ(lineOf(lines, "4,000 x 32 with").measured, "0.140 ms");
  EXPECT_EQ(lineOf(lines, "time in strands").measured, "1.00 ± 0.00") << "of processor time";
  EXPECT_EQ(lineOf(lines, "time in strands").command, "d");
  EXPECT_EQ(lineOf(lines, "time in strands").holds, true);
  EXPECT_EQ(lineOf(lines, "time in vertices").holds, false) << "1.19";
  EXPECT_FALSE(lineOf(lines, "time in substeps").holds) << "what a step does once makes it less";
}

}  // namespace
}  // namespace strandcast
