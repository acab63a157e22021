#include "validation/vibrations.h"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "validation/shooting.h"

namespace strandcast {

double beamRoot(int n) {
  // cos(b) + 1 / cosh(b) changes its sign once within a quarter turn of (n - 1/2) pi.
  auto f = [](double b) { return std::cos(b) + 1 / std::cosh(b); };
  const double around = (n - 0.5) * std::numbers::pi;
  double low = around - 0.8, high = around + 0.8;
  const bool rises = f(high) > 0;
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    ((f(middle) > 0) == rises ? high : low) = middle;
  }
  return low;
}

double beamShape(int n, double s) {
  const double b = beamRoot(n);
  const double ratio = (std::cosh(b) + std::cos(b)) / (std::sinh(b) + std::sin(b));
  return std::cosh(b * s) - std::cos(b * s) - ratio * (std::sinh(b * s) - std::sin(b * s));
}

namespace {

// State over the distance u from the tip: y, and tension x y'. The mass per length, relative to that at the
// clamp, is tip + (1 - tip) u; the tension is the weight beyond.
Eigen::Vector2d followed(double tip, double square, double from_tip) {
  Eigen::Vector2d at(1, 0);
  const int steps = static_cast<int>(std::ceil(4000 * from_tip));
  const double h = from_tip / steps;
  for (int i = 0; i < steps; ++i)
    at = rungeKuttaStep(i * h, at, h, [&](double u, const Eigen::Vector2d& y) {
      const double tension = u * (tip + 0.5 * (1 - tip) * u);
      return Eigen::Vector2d(u > 0 ? y[1] / tension : -square, -square * (tip + (1 - tip) * u) * y[0]);
    });
  return at;
}

}  // namespace

double chainRoot(int n) {
  double x = (n - 0.25) * std::numbers::pi;  // McMahon's first term; Newton's method does the rest
  for (int i = 0; i < 20; ++i) x += std::cyl_bessel_j(0, x) / std::cyl_bessel_j(1, x);
  return x;
}

double chainShape(int n, double s) {
  return std::cyl_bessel_j(0, chainRoot(n) * std::sqrt(std::fmax(0.0, 1 - s)));
}

UnevenChain::UnevenChain(int n, double tip) : tip_(tip) {
  constexpr double kApart = 0.02;  // bracket of frequencies; modes are farther apart
  auto at_clamp = [&](double frequency) { return followed(tip, frequency * frequency, 1)[0]; };
  double high = 0;
  for (int mode = 0; mode < n; ++mode) {
    const bool side = at_clamp(high) > 0;
    do high += kApart;
    while ((at_clamp(high) > 0) == side);
  }
  double low = high - kApart;
  const bool side = at_clamp(low) > 0;
  for (int i = 0; i < 50; ++i) {
    const double middle = (low + high) / 2;
    ((at_clamp(middle) > 0) == side ? low : high) = middle;
  }
  square_ = low * low;
}

double UnevenChain::shape(double s) const { return s < 1 ? followed(tip_, square_, 1 - s)[0] : 1; }

double pendulumPeriod(double angle) {
  double a = 1, g = std::cos(angle / 2);
  for (int i = 0; i < 8; ++i) {
    const double mean = (a + g) / 2;
    g = std::sqrt(a * g);
    a = mean;
  }
  return 1 / a;
}

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
