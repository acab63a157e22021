#include "bench/table.h"

#include <gtest/gtest.h>

#include "bench/bench_simulation.h"
#include "bench/counted_memory.h"
#include "bench/machine.h"
#include "core/error.h"
#include "core/quantile.h"

namespace strandcast {
namespace {

Table sample() {
  Table table({{"name", "name"}, {"ms", "ms", "{:.2f}"}, {"state_hash"}, {"count", "count"}});
  table.add({{"name", "a, \"quoted\""}, {"ms", 1.2345}, {"state_hash", "0000000000000012"}});
  table.add({{"name", "b"}, {"count", 7}});
  return table;
}

TEST(Table, CsvComesBackAsItWas) {
  const CsvFile read = parseCsv("# strandbench x\n# commit 1\n" + sample().csv(), "sample");
  EXPECT_EQ(read.comments, (std::vector<std::string>{"strandbench x", "commit 1"}));
  EXPECT_EQ(read.columns, (std::vector<std::string>{"name", "ms", "state_hash", "count"}));
  ASSERT_EQ(read.rows.size(), 2u);
  EXPECT_EQ(read.rows[0]["name"], "a, \"quoted\"");
  EXPECT_EQ(read.rows[0]["ms"], 1.2345);
  EXPECT_EQ(read.rows[0]["state_hash"], "0000000000000012") << "digits alone, and yet no number";
  EXPECT_TRUE(read.rows[0]["count"].is_null());
  EXPECT_EQ(read.rows[1]["count"], 7);
}

TEST(Table, ARowOfAnotherLengthIsRefusedByItsLine) {
  try {
    parseCsv("a,b\n1,2\n3\n", "file.csv");
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("file.csv:3"), std::string::npos) << error.what();
  }
}

TEST(Table, PeopleSeeHeadingsAndADashForWhatDoesNotApply) {
  EXPECT_EQ(sample().text(),
            "  name          ms count\n"
            "  a, \"quoted\" 1.23     -\n"
            "  b              -     7\n");
}

TEST(Table, JsonHasEveryKeyInEveryRow) {
  const nlohmann::json json = sample().json();
  ASSERT_EQ(json.size(), 2u);
  for (const nlohmann::json& row : json) EXPECT_EQ(row.size(), 4u);
  EXPECT_TRUE(json[1]["ms"].is_null());
}

TEST(Origin, SaysWhatWasBuiltAndWhereItRuns) {
  const nlohmann::json said = origin();
  EXPECT_FALSE(said["commit"].get<std::string>().empty());
  EXPECT_FALSE(said["machine"].get<std::string>().empty());
  EXPECT_GT(said["hardware_threads"], 0);
  EXPECT_NE(originComment().find(buildCommit()), std::string::npos);
}

TEST(Machine, FoldersHaveTheNameOfAProcessor) {
  EXPECT_EQ(folderNameOf("AMD EPYC"), "amd-epyc");
  EXPECT_EQ(folderNameOf("Intel(R) Xeon(R) CPU @ 2.20GHz"), "intel-r-xeon-r-cpu-2-20ghz");
  EXPECT_EQ(folderNameOf("//"), "unknown");
}

TEST(CountedMemory, CountsWhatIsInUseAndEveryCall) {
  const size_t before = heapBytes();
  const uint64_t calls = allocations(), own = allocationsOfThisThread();
  {
    std::vector<char> memory(100000);
    EXPECT_GE(heapBytes() - before, 100000u);
    EXPECT_LT(heapBytes() - before, 110000u);
    EXPECT_EQ(allocations() - calls, 1u);
    EXPECT_EQ(allocationsOfThisThread() - own, 1u);
  }
  EXPECT_EQ(heapBytes(), before);
}

TEST(Spread, IsOfTheSortedValues) {
  std::vector<double> values;
  for (int i = 100; i > 0; --i) values.push_back(i);
  const Spread spread = spreadOf(values);
  EXPECT_EQ(spread.min, 1);
  EXPECT_EQ(spread.median, 51);
  EXPECT_EQ(spread.p95, 96);
  EXPECT_EQ(quantileOf(values, 0.99), 100);
  EXPECT_EQ(spreadOf({3}).p95, 3);
}

}  // namespace
}  // namespace strandcast
