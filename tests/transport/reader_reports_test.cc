#include "transport/reader_reports.h"

#include <gtest/gtest.h>

#include <cmath>

#include "transport/metrics.h"

namespace strandcast {
namespace {

using Clock = ReaderReports::Clock;
const Clock::time_point kStart{std::chrono::hours(1)};
Clock::time_point after(int milliseconds) { return kStart + std::chrono::milliseconds(milliseconds); }

ReaderReport reportOf(uint64_t reader, float pixels, uint32_t wants = 0) {
  ReaderReport report;
  report.reader = reader;
  report.pixels = pixels;
  report.wants = wants;
  report.frames_lost = reader;
  return report;
}

TEST(ReaderReports, TheLargestPictureCountsAndAnUnknownOneMore) {
  ReaderReports reports;
  EXPECT_EQ(reports.summary(kStart).largest_pixels, -1) << "none reports";
  reports.add(reportOf(1, 0), kStart);
  EXPECT_EQ(reports.summary(kStart).largest_pixels, 0);
  reports.add(reportOf(2, 500), kStart);
  reports.add(reportOf(3, 40), kStart);
  EXPECT_EQ(reports.summary(kStart).largest_pixels, 500);
  EXPECT_EQ(reports.summary(kStart).frames_lost, 6u);
  reports.add(reportOf(4, -1), after(2000));
  reports.add(reportOf(2, 400), after(2000));
  EXPECT_EQ(reports.summary(after(2000)).largest_pixels, -1);
  EXPECT_EQ(reports.count(after(2000)), 4u);
  EXPECT_EQ(reports.count(after(3001)), 2u) << "two were silent for 3 s";
  EXPECT_EQ(reports.count(after(5001)), 0u);
}

TEST(ReaderReports, WhatIsLackedForLongIsTakenOnceASecond) {
  ReaderReports reports;
  reports.add(reportOf(1, -1, ReaderReport::kColliders), kStart);
  EXPECT_EQ(reports.takeOverdue(after(1000)), 0u);
  reports.add(reportOf(1, -1, ReaderReport::kColliders), after(1000));
  EXPECT_EQ(reports.takeOverdue(after(1001)), ReaderReport::kColliders);
  EXPECT_EQ(reports.takeOverdue(after(1002)), 0u);
  reports.add(reportOf(1, -1, 0), after(1500));
  EXPECT_EQ(reports.takeOverdue(after(2500)), 0u) << "it has come";
  reports.add(reportOf(1, -1, ReaderReport::kGroomAndBody), after(2500));
  EXPECT_EQ(reports.takeOverdue(after(3400)), 0u);
  EXPECT_EQ(reports.takeOverdue(after(3600)), ReaderReport::kGroomAndBody);
}

TEST(ReaderReports, ThoseThatAreNotSoundAreDropped) {
  ReaderReports reports;
  for (const ReaderReport& bad : {reportOf(0, 1), reportOf(1, -2), reportOf(1, 2e6f), reportOf(1, NAN)})
    reports.add(bad, kStart);
  ReaderReport late = reportOf(1, 1);
  late.latency_ms_p99 = INFINITY;
  reports.add(late, kStart);
  EXPECT_EQ(reports.count(kStart), 0u);
}

TEST(Metrics, AreReadByName) {
  Metrics metrics;
  metrics.rate = 60;
  metrics.frames_late = 3;
  const MetricTable table = metricTable(metrics);
  ASSERT_TRUE(isSound(table));
  const auto values = namedValues(table);
  EXPECT_EQ(values.size(), metricList().size()) << "each name once";
  EXPECT_EQ(values.at("rate"), 60);
  EXPECT_EQ(values.at("frames_late"), 3);
}

TEST(Metrics, TablesThatDoNotFitAreUnsound) {
  EXPECT_TRUE(isSound(MetricTable{}));
  EXPECT_FALSE(isSound(MetricTable{"a b", {1}}));
  EXPECT_FALSE(isSound(MetricTable{"a", {1, 2}}));
  EXPECT_FALSE(isSound(MetricTable{"a", {NAN}}));
  MetricTable large;
  for (size_t i = 0; i <= kMaxMetrics; ++i) large.names += "m ", large.values.push_back(0);
  EXPECT_FALSE(isSound(large));
}

}  // namespace
}  // namespace strandcast
