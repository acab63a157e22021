#include "validation/oscillation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace strandcast {
namespace {

// Largest |sample| in (first, last), refined by the parabola through it and its neighbours.
double peak(std::span<const double> samples, size_t first, size_t last) {
  size_t at = first;
  for (size_t i = first; i < last; ++i)
    if (std::fabs(samples[i]) > std::fabs(samples[at])) at = i;
  if (at == 0 || at + 1 >= samples.size()) return std::fabs(samples[at]);
  const double slope = (samples[at + 1] - samples[at - 1]) / 2;
  const double bend = samples[at + 1] - 2 * samples[at] + samples[at - 1];
  return std::fabs(bend == 0 ? samples[at] : samples[at] - slope * slope / (2 * bend));
}

}  // namespace

double Oscillation::dampingRatio() const { return decrement / std::hypot(2 * std::numbers::pi, decrement); }

double Oscillation::energyLostPerCycle() const { return 1 - std::exp(-2 * decrement); }

Oscillation oscillationOf(std::span<const double> samples, double interval) {
  std::vector<double> crossings;  // in units of the interval
  for (size_t i = 1; i + 1 < samples.size(); ++i)
    if (samples[i] * samples[i + 1] < 0)
      crossings.push_back(static_cast<double>(i) + samples[i] / (samples[i] - samples[i + 1]));
  if (crossings.size() < 3) {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    return {kNone, kNone};
  }
  const auto halves = static_cast<double>(crossings.size() - 1);
  const double half_period = (crossings.back() - crossings.front()) / halves;
  auto amplitude = [&](size_t swing) {
    return peak(samples, static_cast<size_t>(std::ceil(crossings[swing])),
                static_cast<size_t>(std::floor(crossings[swing + 1])) + 1);
  };
  const double ratio = amplitude(0) / amplitude(crossings.size() - 2);
  return {std::numbers::pi / (half_period * interval), 2 * std::log(ratio) / (halves - 1)};
}

}  // namespace strandcast
