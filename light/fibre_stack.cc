#include "light/fibre_stack.h"

#include <algorithm>
#include <cmath>
#include <complex>

namespace strandcast {
namespace {

constexpr double kMostForward = 0.9999;

double square(double x) { return x * x; }

using Complex = std::complex<double>;

/// Of R = b + f^2 R / (1 - b R), the whole light that an endless stack returns, the part beyond b, divided by
/// b. R / b is 2 / (s + root) with s = 1 + b^2 - f^2 and root^2 = s^2 - 4 b^2.
template <class Number>
Number beyondFirst(Number f, Number b, Number root) {
  const Number whole = 2.0 / (1.0 + b * b - f * f + root);
  return f * f * whole / (1.0 - b * b * whole);
}

}  // namespace

Backscattering paperBackscattering(const LayerScattering& layer) {
  const double f2 = square(std::min(layer.forward, kMostForward)), b = layer.backward, b2 = square(b);
  const double rest = 1 - f2;
  const double forward_width = std::sqrt(layer.forward_variance),
               backward_width = std::sqrt(layer.backward_variance);
  Backscattering out;
  out.attenuation = b * f2 / rest + b * b2 * f2 / (rest * rest * rest);
  out.shift = layer.backward_shift * (1 - 2 * b2 / square(rest)) +
              layer.forward_shift * (2 * square(rest) + 4 * f2 * b2) / (rest * rest * rest);
  // Divided by b, so that fibres that scatter nothing back have a limit.
  out.variance = square((1 + 0.7 * f2) *
                        (std::sqrt(2 * layer.forward_variance + layer.backward_variance) +
                         b2 * std::sqrt(2 * layer.forward_variance + 3 * layer.backward_variance)) /
                        (1 + b2 * (2 * forward_width + 3 * backward_width)));
  return out;
}

Backscattering fullBackscattering(const LayerScattering& layer) {
  const auto moment = [](double share, double shift, double variance) {
    return std::polar(share * std::exp(-2 * variance), 2 * shift);
  };
  const Complex forward = moment(layer.forward, layer.forward_shift, layer.forward_variance),
                backward = moment(layer.backward, layer.backward_shift, layer.backward_variance);
  // The share is real: its root is taken of factors, of which the last vanishes without absorption.
  const double f = layer.forward, b = layer.backward, s = 1 + b * b - f * f;
  const double share = beyondFirst(f, b, std::sqrt((s + 2 * b) * (1 - b + f) * std::max(0.0, 1 - b - f)));
  Backscattering out;
  out.attenuation = b * share;
  if (share <= 0) return out;
  const Complex moment_s = 1.0 + backward * backward - forward * forward;
  Complex moment_root = std::sqrt(moment_s * moment_s - 4.0 * backward * backward);
  if (std::real(moment_root * std::conj(moment_s)) < 0) moment_root = -moment_root;  // R vanishes with b
  const Complex ratio = beyondFirst(forward, backward, moment_root) / share *
                        moment(1, layer.backward_shift, layer.backward_variance);
  out.shift = std::arg(ratio) / 2;
  out.variance = std::max(0.0, -std::log(std::abs(ratio)) / 2);
  return out;
}

}  // namespace strandcast
