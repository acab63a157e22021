// strandbench step, encode, grid and contact as a user runs them, with little hair.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "bench/table.h"
#include "gpu_compute/gpu_backend.h"
#include "simd/simd_backend.h"
#include "tests/bench/bench_program.h"
#include "tests/thorough.h"

namespace strandcast {
namespace {

void expectOrigin(const nlohmann::json& report) {
  for (const char* key : {"commit", "machine", "instruction_set", "command"})
    EXPECT_FALSE(report.value(key, "").empty()) << key;
}

void expectRun(const nlohmann::json& run) {
  EXPECT_GT(run["ms_min"], 0);
  EXPECT_LE(run["ms_min"], run["ms_median"]);
  EXPECT_LE(run["ms_median"], run["ms_p95"]);
  EXPECT_GT(run["bytes_per_vertex"], 50) << "positions, velocities and rest shape alone take more";
  EXPECT_EQ(run["allocations"], 0);
  EXPECT_LT(run["max_stretch"], 1e-4);
  EXPECT_EQ(run["non_finite"], 0);
  EXPECT_EQ(run["state_hash"].get<std::string>().size(), 16u);
}

/// Checks the machine's limits and the fractions of them; `ms` is the key of the time.
void expectLimits(const nlohmann::json& run, const char* ms) {
  const auto of = [&](const char* key) { return run[key].is_number() ? run[key].get<double>() : -1; };
  const double vertices = of("strands") * of("vertices"), seconds = 1e-3 * of(ms);
  EXPECT_GT(of("peak_operations_per_s"), 1e8);
  EXPECT_LT(of("peak_operations_per_s"), 1e15);
  EXPECT_GT(of("copied_bytes_per_s"), 1e7);
  EXPECT_LT(of("copied_bytes_per_s"), 1e14);
  EXPECT_EQ(of("state_bytes_moved"), vertices * 48) << "three floats of place and of velocity, twice";
  EXPECT_NEAR(of("fraction_of_copy") * seconds * of("copied_bytes_per_s") / of("state_bytes_moved"), 1, 1e-6);
  const double operations = of("operations_per_vertex_substep") * vertices * of("substeps");
  EXPECT_NEAR(of("fraction_of_peak") * seconds * of("peak_operations_per_s") / operations, 1, 1e-6);
}

TEST(StepBench, EveryRunSaysWhereItRanWhatItTookAndWhatItComputed) {
  const nlohmann::json report =
      benchJson("step --backend simd --threads 1 --strands 60 --vertices 12 --steps 4 --shake 2");
  ASSERT_TRUE(report.is_object());
  expectOrigin(report);
  ASSERT_EQ(report["results"].size(), 1u);
  const nlohmann::json& run = report["results"][0];
  expectRun(run);
  EXPECT_GT(run["fraction_of_peak"], 0);
  EXPECT_GT(run["fraction_of_peak_cpu"], 0);
  expectLimits(run, "ms_median");
  EXPECT_GE(run["damping_s"], 0) << "the rod damps";
  EXPECT_TRUE(run["iterations"].is_null()) << "of gauss_seidel";
  EXPECT_NEAR(run["ns_per_vertex_substep"].get<double>() * 1e-6 * 60 * 12 * 4, run["ms_median"].get<double>(),
              1e-6);
}

TEST(StepBench, GaussSeidelHasIterationsAndNoInternalDamping) {
  const nlohmann::json report =
      benchJson("step --backend reference --solver gauss_seidel --strands 20 --vertices 8 --steps 1");
  ASSERT_TRUE(report.is_object());
  const nlohmann::json& run = report["results"][0];
  EXPECT_GT(run["iterations"], 0);
  EXPECT_TRUE(run["damping_s"].is_null());
  EXPECT_FALSE(report.contains("operations")) << "they are to be asked for";
}

/// Operations of a part of a step, per vertex and substep; 0 where the step lacks it.
double operationsOf(const nlohmann::json& report, const char* part) {
  for (const nlohmann::json& row : report["operations"])
    if (row["part"] == part) return row["per_vertex_substep"];
  return 0;
}

TEST(StepBench, OperationsArePartedAndAddUp) {
  const std::string some = "step --backend reference --strands 40 --vertices 12 --steps 2 --operations";
  const nlohmann::json free = benchJson(some), touching = benchJson(some + " --bodies sphere"),
                       other = benchJson(some + " --solver gauss_seidel");
  for (const nlohmann::json& report : {free, touching, other}) {
    ASSERT_TRUE(report.is_object());
    double sum = 0;
    for (const nlohmann::json& row : report["operations"]) sum += row["per_vertex_substep"].get<double>();
    const double all = report["results"][0]["operations_per_vertex_substep"];
    EXPECT_NEAR(sum, all, 1e-9 * all);
    for (const char* part : {"predict", "bend", "move", "velocities"})
      EXPECT_GT(operationsOf(report, part), 0) << part;
  }
  // Operations of one part are not counted in another.
  EXPECT_EQ(operationsOf(free, "contact"), 0) << "there is no body";
  EXPECT_GT(operationsOf(touching, "contact"), 0);
  for (const char* part : {"predict", "twist"})
    EXPECT_EQ(operationsOf(free, part), operationsOf(touching, part))
        << part << ": bodies change nothing of it";
  EXPECT_GT(operationsOf(free, "twist"), 0);
  EXPECT_EQ(operationsOf(other, "twist"), 0) << "the rod's";
  EXPECT_NEAR(operationsOf(other, "velocities"), 6, 1e-9)
      << "three subtractions and multiplications a vertex";
}

TEST(StepBench, AGpuIsHeldAgainstItsOwnLimits) {
  if (!gpuBackendInfo().available) GTEST_SKIP() << "there is no OpenGL 4.5";
  const nlohmann::json report = benchJson("step --backend gpu --strands 60 --vertices 12 --steps 4");
  ASSERT_TRUE(report.is_object());
  const nlohmann::json& run = report["results"][0];
  EXPECT_GT(run["fraction_of_peak"], 0);
  expectLimits(run, run["gpu_ms"].is_null() ? "ms_median" : "gpu_ms");
}

// Each kind of hair has a row, so that rows of one run show its cost.
TEST(StepBench, EveryKindOfHairIsARowOfItsOwn) {
  const nlohmann::json report = benchJson(
      "step --backend simd --threads 1 --strands 60 --vertices 12 --steps 4 --hair "
      "plain,undamped,tapered,uneven,curves");
  ASSERT_TRUE(report.is_object());
  ASSERT_EQ(report["results"].size(), 5u);
  std::set<std::string> hashes;
  for (const nlohmann::json& run : report["results"]) {
    expectRun(run);
    hashes.insert(run["state_hash"].get<std::string>());
  }
  EXPECT_EQ(hashes.size(), 5u) << "no two move alike";
  EXPECT_EQ(report["results"][1]["hair"], "undamped");
  EXPECT_EQ(report["results"][1]["damping_s"], 0);
  EXPECT_GT(report["results"][0]["damping_s"], 0);
  const auto bytes = [&](int row) { return report["results"][row]["bytes_per_vertex"].get<double>(); };
  // Mass data: three numbers per vertex. Plain hair of 12 vertices stores three rows of them, tapered hair
  // twelve.
  EXPECT_NEAR(bytes(2), bytes(0) + 3 * sizeof(float) * 9 / 12, 1) << "of a taper they differ";
  EXPECT_NEAR(bytes(3), bytes(2), 1) << "uneven edges take no more";
  EXPECT_GT(bytes(4), bytes(0) + 20) << "curves of factors do";
  EXPECT_EQ(runBench("step --strands 20 --hair plain,frizzy 2>/dev/null").status, 2);
}

TEST(StepBench, CsvHoldsTheSameAsJson) {
  const std::string arguments = "step --backend reference --strands 20 --vertices 8 --steps 2";
  const BenchOutput csv = runBench(arguments + " --csv");
  ASSERT_EQ(csv.status, 0);
  const CsvFile file = parseCsv(csv.text, "csv");
  ASSERT_EQ(file.comments.size(), 2u);
  EXPECT_EQ(file.comments[0], "strandbench " + arguments + " --csv");
  EXPECT_EQ(file.comments[1].rfind("commit ", 0), 0u);
  const nlohmann::json report = benchJson(arguments);
  ASSERT_EQ(file.rows.size(), report["results"].size());
  EXPECT_EQ(file.columns.size(), report["results"][0].size());
  EXPECT_EQ(file.rows[0]["state_hash"], report["results"][0]["state_hash"]) << "the same steps";
}

TEST(StepBench, AForcedInstructionSetIsTheOneThatRuns) {
  for (const std::string& target : simdTargets()) {
    const nlohmann::json report =
        benchJson("step --backend simd --threads 1 --strands 20 --steps 1 --target " + target);
    ASSERT_TRUE(report.is_object()) << target;
    EXPECT_EQ(report["results"][0]["device"], target + ", 1 thread");
  }
  EXPECT_EQ(runBench("step --backend simd --target MMX 2>/dev/null").status, 2);
  EXPECT_EQ(runBench("step --backend reference --target AVX2 2>/dev/null").status, 2);
}

// Memory on the heap and in GPU buffers, against the goal of docs/performance.md.
TEST(StepBench, AVertexTakesNoMoreMemoryThanItNeeds) {
  auto bytes = [&](const std::string& backend) {
    const nlohmann::json report =
        benchJson("step --backend " + backend + " --strands 10000 --scene curly --substeps 1 --steps 1");
    return report.is_object() ? report["results"][0]["bytes_per_vertex"].get<double>() : 1e9;
  };
  EXPECT_LE(bytes("simd --threads 1"), 155) << "each thread has room of its own";
  EXPECT_LE(bytes("reference"), 156);
  if (!gpuBackendInfo().available || !thorough()) return;
  bytes("gpu");  // fills llvmpipe's disk cache; compiling takes 23 bytes per vertex more
  EXPECT_LE(bytes("gpu"), 160) << "some of it is the driver's";
}

// The timers of the air's passes have preallocated memory.
TEST(StepBench, AGpuStepInAirAllocatesNothing) {
  if (!gpuBackendInfo().available) GTEST_SKIP() << "there is no OpenGL 4.5";
  const nlohmann::json report =
      benchJson("step --backend gpu --strands 60 --vertices 12 --substeps 1 --steps 12 --air 16");
  ASSERT_TRUE(report.is_object());
  EXPECT_EQ(report["results"][0]["allocations"], 0);
  EXPECT_GT(report["results"][0]["air_gpu_ms"], 0);
}

TEST(EncodeBench, TheGpuReadsLessBackAndWritesTheBytesOfTheCpu) {
  if (!gpuBackendInfo().available) GTEST_SKIP() << "there is no OpenGL 4.5";
  const std::string few = "encode --strands 200 --vertices 12 --substeps 1 --warmup 1 --steps 3";
  const nlohmann::json report = benchJson(few);
  ASSERT_TRUE(report.is_object());
  expectOrigin(report);
  EXPECT_TRUE(report["failures"].empty());
  ASSERT_EQ(report["results"].size(), 2u);
  const nlohmann::json &gpu = report["results"][0], &cpu = report["results"][1];
  EXPECT_EQ(gpu["case"], "gpu");
  EXPECT_EQ(cpu["read_bytes_per_vertex"], 12);
  EXPECT_LT(gpu["read_bytes_per_vertex"], 6);
  EXPECT_EQ(gpu["bytes_per_vertex"], cpu["bytes_per_vertex"]);
  for (const nlohmann::json& run : report["results"]) {
    EXPECT_EQ(run["frames_different"], 0);
    EXPECT_GT(run["ms_min"], 0);
    EXPECT_LE(run["max_error_mm"], 0.01);
  }
  const BenchOutput judged = runBench(few + " --most-over-gpu 0");
  EXPECT_EQ(judged.status, 1);
  EXPECT_NE(judged.text.find("FAILED"), std::string::npos) << judged.text;
}

TEST(EncodeBench, EncodesOnACpuToo) {
  const nlohmann::json report =
      benchJson("encode --backend simd --threads 1 --strands 200 --vertices 12 --warmup 1 --steps 3");
  ASSERT_TRUE(report.is_object());
  ASSERT_EQ(report["results"].size(), 1u);
  EXPECT_EQ(report["results"][0]["frames_different"], 0);
  EXPECT_TRUE(report["results"][0]["read_bytes_per_vertex"].is_null());
}

TEST(GridBench, SaysWhatItsStepsComputed) {
  const nlohmann::json report = benchJson("grid --strands 60 --vertices 12 --steps 2 --cells 16 --threads 1");
  ASSERT_TRUE(report.is_object());
  expectOrigin(report);
  expectRun(report["step"]);
  expectRun(report["step_with_grids_32"]);
  EXPECT_NE(report["step"]["state_hash"], report["step_with_grids_32"]["state_hash"]);
  EXPECT_GT(report["results"][0]["ms_passes"]["splat"], 0);
  std::set<std::string> passes;
  for (const nlohmann::json& pass : report["results"][0]["passes"]) {
    passes.insert(pass["pass"]);
    EXPECT_GT(pass["ms_min"], 0) << pass;
    EXPECT_LE(pass["ms_min"], pass["ms_median"]) << pass;
    EXPECT_LE(pass["ms_median"], pass["ms_p95"]) << pass;
  }
  EXPECT_TRUE(passes.contains("all") && passes.contains("project")) << report["results"][0]["passes"];
}

/// State hash of the steps that `grid` takes without grids.
std::string gridHash(const std::string& options) {
  const nlohmann::json report =
      benchJson("grid --cells 16 --strands 40 --vertices 8 --steps 1 --threads 1" + options);
  return report.is_object() ? report["step"]["state_hash"].get<std::string>() : "none";
}

TEST(BenchOptions, HairIsThatOfTheSceneAndTheSeed) {
  std::set<std::string> hashes;
  for (const char* hair : {"", " --scene curly", " --seed 2", " --substeps 2"}) hashes.insert(gridHash(hair));
  EXPECT_EQ(hashes.size(), 4u);
  EXPECT_EQ(hashes.count("none"), 0u);
  EXPECT_EQ(hashes.count(gridHash(" --scene straight --seed 1 --substeps 4")), 1u) << "as without";

  const std::string hair =
      " --backend simd --scene curly --seed 2 --strands 40 --vertices 8 --steps 1 --threads 1";
  const nlohmann::json contact = benchJson("contact --cell 0.02" + hair), step = benchJson("step" + hair);
  ASSERT_TRUE(contact.is_object() && step.is_object());
  EXPECT_EQ(contact["results"][0]["state_hash"], step["results"][0]["state_hash"]) << "hair without a body";
  EXPECT_EQ(runBench("contact --scene bald --strands 20 2>/dev/null").status, 2);
#ifdef STRANDCAST_HAS_RENDER
  EXPECT_NE(runBench("render --help").text.find("--seed"), std::string::npos);
#endif
}

TEST(GridBench, RefusesCellsThatNoSimulationTakes) {
  EXPECT_EQ(runBench("grid --strands 60 --steps 1 --cells 33 2>/dev/null").status, 2);
  EXPECT_EQ(runBench("grid --strands 60 --steps 1 --cells 16,144 2>/dev/null").status, 2);
  EXPECT_NE(runBench("grid --help").text.find("a multiple of 16"), std::string::npos);
}

TEST(ContactBench, CsvSaysHowEveryBodyWasBaked) {
  const std::filesystem::path body =
      std::filesystem::temp_directory_path() / ("strandcast_body_" + std::to_string(getpid()) + ".obj");
  writeText(body, "v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nv 0 0 0.1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
  const BenchOutput csv =
      runBench("contact --strands 20 --vertices 8 --steps 1 --threads 1 --cell 0.01 --body " + body.string() +
               " --csv");
  std::filesystem::remove(body);
  ASSERT_EQ(csv.status, 0);
  const CsvFile file = parseCsv(csv.text, "csv");
  ASSERT_EQ(file.comments.size(), 4u);
  EXPECT_EQ(file.comments[2].rfind("field of procedural body: ", 0), 0u) << file.comments[2];
  EXPECT_EQ(file.comments[3].rfind("field of " + body.filename().string() + ": 4 triangles", 0), 0u)
      << file.comments[3];
  EXPECT_EQ(file.rows.size(), 2u);
}

TEST(ContactBench, SaysWhatContactChanged) {
  const nlohmann::json report =
      benchJson("contact --strands 200 --vertices 16 --steps 3 --threads 1 --cell 0.008");
  ASSERT_TRUE(report.is_object());
  expectOrigin(report);
  ASSERT_EQ(report["results"].size(), 2u);
  for (const nlohmann::json& run : report["results"]) expectRun(run);
  EXPECT_EQ(report["results"][0]["vertices_pressed"], 0);
  EXPECT_GT(report["results"][1]["vertices_pressed"], 0);
  EXPECT_GT(report["bakes"][0]["seconds"], 0);
}

}  // namespace
}  // namespace strandcast
