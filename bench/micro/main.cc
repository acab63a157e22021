// Accepts Google Benchmark's options, e.g. --benchmark_filter=codec --benchmark_format=csv. Each result is of
// one thread and counts vertices, samples or points per second.
#include <benchmark/benchmark.h>

#include "bench/build_commit.h"
#include "bench/machine.h"

int main(int argc, char** argv) {
  benchmark::AddCustomContext("commit", strandcast::buildCommit());
  benchmark::AddCustomContext("machine", strandcast::describe(strandcast::thisMachine()));
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
}
