#include "service/rate_budget.h"

#include <algorithm>
#include <numeric>

namespace strandcast {

void StagePressure::addLateFrame(Clock::time_point now) { last_late_ = now.time_since_epoch().count(); }

double StagePressure::at(Clock::time_point now) const {
  const Clock::rep last_late = last_late_;
  if (last_late == 0) return 0;
  const std::chrono::duration<double> calm = now.time_since_epoch() - Clock::duration(last_late) - kHeld;
  return std::clamp(1 - calm / std::chrono::duration<double>(kFading), 0.0, 1.0);
}

double RateBudget::cost() const {
  const size_t counted = std::min(frames_, kFrames);
  if (counted == 0) return 0;
  return std::accumulate(costs_.begin(), costs_.begin() + static_cast<ptrdiff_t>(counted), 0.0) /
         static_cast<double>(counted);
}

double RateBudget::addFrame(double cost_ms, bool is_late, Clock::time_point now) {
  costs_[frames_++ % kFrames] = cost_ms;
  const double mean = cost();
  if (is_late && mean <= std::min(budget_ms_, interval_ms_)) pressure_.addLateFrame(now);
  const double excess = std::max(mean / budget_ms_, 1.0);
  const double longest = std::max(kLongestInterval / interval_ms_, 1.0);
  return std::min(1 + (excess - 1) * pressure_.at(now), longest);
}

}  // namespace strandcast
