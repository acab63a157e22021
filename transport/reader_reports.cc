#include "transport/reader_reports.h"

#include <algorithm>
#include <cmath>

namespace strandcast {
namespace {
constexpr size_t kMaxReaders = 4096;
constexpr std::chrono::milliseconds kSilence{3000}, kOverdue{1000};
}  // namespace

bool isSound(const ReaderReport& report) {
  const auto is_finite = [](auto... numbers) { return (std::isfinite(numbers) && ...); };
  return report.reader != 0 && (report.pixels == -1 || (report.pixels >= 0 && report.pixels <= 1e6f)) &&
         report.rate >= 0 && is_finite(report.rate, report.latency_ms_p50, report.latency_ms_p99);
}

void ReaderReports::add(const ReaderReport& report, Clock::time_point now) {
  if (!isSound(report)) return;
  const std::lock_guard lock(mutex_);
  if (readers_.size() >= kMaxReaders && !readers_.contains(report.reader)) return;
  Entry& entry = readers_[report.reader];
  if (entry.report.wants == 0) entry.lacks_since = now;
  entry.report = report;
  entry.heard = now;
}

void ReaderReports::forgetSilent(Clock::time_point now) const {
  std::erase_if(readers_, [&](const auto& reader) { return now - reader.second.heard > kSilence; });
}

size_t ReaderReports::count(Clock::time_point now) const {
  const std::lock_guard lock(mutex_);
  forgetSilent(now);
  return readers_.size();
}

ReaderSummary ReaderReports::summary(Clock::time_point now) const {
  const std::lock_guard lock(mutex_);
  forgetSilent(now);
  ReaderSummary summary;
  if (!readers_.empty()) summary.largest_pixels = 0;
  for (const auto& [id, entry] : readers_) {
    const float pixels = entry.report.pixels;
    const bool is_known = pixels >= 0 && summary.largest_pixels >= 0;
    summary.largest_pixels = is_known ? std::max(summary.largest_pixels, pixels) : -1;
    summary.frames_lost += entry.report.frames_lost;
  }
  return summary;
}

uint32_t ReaderReports::takeOverdue(Clock::time_point now) {
  const std::lock_guard lock(mutex_);
  forgetSilent(now);
  uint32_t overdue = 0;
  for (auto& [id, entry] : readers_) {
    if (entry.report.wants == 0 || now - entry.lacks_since <= kOverdue) continue;
    overdue |= entry.report.wants;
    entry.lacks_since = now;
  }
  return overdue;
}

}  // namespace strandcast
