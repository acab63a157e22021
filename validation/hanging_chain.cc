#include "validation/hanging_chain.h"

#include <Eigen/Core>
#include <cmath>
#include <numbers>

#include "validation/runge_kutta.h"

namespace strandcast {
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

}  // namespace strandcast
