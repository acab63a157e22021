#include "core/surface_bend.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "kernels/scalar_float.h"

namespace strandcast {
namespace {

using Terms = std::array<Vec3, 10>;
using kernels::f32::real3;

real3 toKernel(const Vec3& v) { return {v.x(), v.y(), v.z()}; }
Vec3 fromKernel(const real3& v) { return {v.x, v.y, v.z}; }

/// Kernel form of a bend, in a box that contains all points.
kernels::f32::Bend kernelBend(const Terms& t) {
  constexpr float kEndless = 1e30f;
  return {toKernel(t[0]),
          toKernel(t[1]),
          toKernel(t[2]),
          toKernel(t[3]),
          toKernel(t[4]),
          toKernel(t[5]),
          toKernel(t[6]),
          toKernel(t[7]),
          toKernel(t[8]),
          toKernel(t[9]),
          {kEndless, kEndless, kEndless}};
}

/// Derivatives of the shift along each axis.
std::array<Vec3, 3> rates(const Terms& terms, const Vec3& p) {
  real3 by_x, by_y, by_z;
  kernels::f32::bendRates(kernelBend(terms), toKernel(p), by_x, by_y, by_z);
  return {fromKernel(by_x), fromKernel(by_y), fromKernel(by_z)};
}

/// Upper bound of the norm of the polynomial with these terms in a box of half extents `reach`: the sum over
/// its terms.
float most(const Terms& terms, const Vec3& reach) {
  const float x = reach.x(), y = reach.y(), z = reach.z();
  const std::array<float, 10> products = {1, x, y, z, x * x, y * y, z * z, x * y, y * z, z * x};
  float sum = 0;
  for (size_t i = 0; i < products.size(); ++i) sum += products[i] * terms[i].norm();
  return sum;
}

/// The greatest gradient norm is at a corner of the box: the gradient is linear and its norm convex.
float steepest(const Terms& terms, const Vec3& reach) {
  float found = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 sign(corner & 1 ? 1.0f : -1.0f, corner & 2 ? 1.0f : -1.0f, corner & 4 ? 1.0f : -1.0f);
    float squared = 0;
    for (const Vec3& rate : rates(terms, reach.cwiseProduct(sign))) squared += rate.squaredNorm();
    found = std::max(found, std::sqrt(squared));
  }
  return found;
}

void put(const Terms& terms, float (&out)[10][3]) {
  for (size_t i = 0; i < terms.size(); ++i)
    for (int c = 0; c < 3; ++c) out[i][c] = terms[i][c];
}
Terms take(const float (&in)[10][3]) {
  Terms terms;
  for (size_t i = 0; i < terms.size(); ++i) terms[i] = Vec3(in[i]);
  return terms;
}

}  // namespace

bool SurfaceBend::isNone() const {
  return std::all_of(terms.begin(), terms.end(), [](const Vec3& term) { return term.isZero(0); });
}

Vec3 SurfaceBend::shift(const Vec3& p) const {
  return fromKernel(kernels::f32::bendShift(kernelBend(terms), toKernel(p - middle)));
}

Vec3 SurfaceBend::placed(const Vec3& rest) const {
  constexpr int kMostRounds = 8, kMostHalvings = 4;
  constexpr float kNear = 1e-6f;  // m, residual
  const kernels::f32::Bend bend = kernelBend(terms);
  const Vec3 from_middle = rest - middle;
  const auto offAt = [&](const Vec3& x) {
    return Vec3(x + fromKernel(kernels::f32::bendShift(bend, toKernel(x))) - from_middle);
  };
  // The fixed-point iteration x = rest - w(x) diverges where skin is compressed so much that w changes faster
  // than x. Newton steps with halving never increase the residual.
  Vec3 x = from_middle, off = offAt(x);
  for (int round = 0; round < kMostRounds && off.norm() > kNear; ++round) {
    real3 by_x, by_y, by_z;
    kernels::f32::bendRates(bend, toKernel(x), by_x, by_y, by_z);
    Eigen::Matrix3f rates = Eigen::Matrix3f::Identity();
    rates.col(0) += fromKernel(by_x);
    rates.col(1) += fromKernel(by_y);
    rates.col(2) += fromKernel(by_z);
    Vec3 step = -(rates.inverse() * off);
    Vec3 next = x + step, next_off = offAt(next);
    for (int half = 0; half < kMostHalvings && !(next_off.norm() < off.norm()); ++half) {
      step *= 0.5f;
      next = x + step;
      next_off = offAt(next);
    }
    if (!(next_off.norm() < off.norm())) break;
    x = next;
    off = next_off;
  }
  return middle + x;
}

Vec3 SurfaceBend::normal(const Vec3& p, const Vec3& rest) const {
  return fromKernel(kernels::f32::bentGradient(kernelBend(terms), toKernel(p - middle), toKernel(rest)));
}

SurfaceBend SurfaceBend::about(const Vec3& other) const {
  SurfaceBend out = *this;
  out.middle = other;
  out.terms[0] = shift(other);
  const std::array<Vec3, 3> linear = rates(terms, other - middle);
  std::copy(linear.begin(), linear.end(), out.terms.begin() + 1);
  return out;
}

SurfaceBend interpolate(const SurfaceBend& a, const SurfaceBend& b, float t) {
  SurfaceBend out = a.about(b.middle);
  for (size_t i = 0; i < out.terms.size(); ++i) out.terms[i] += t * (b.terms[i] - out.terms[i]);
  return out;
}

MovingBend movingBend(const SurfaceBend& begin, const SurfaceBend& end, const Vec3& middle,
                      const Vec3& reach) {
  MovingBend out{};
  if (begin.isNone() && end.isNone()) return out;
  const Terms from = begin.about(middle).terms, to = end.about(middle).terms;
  put(from, out.begin);
  put(to, out.end);
  for (int c = 0; c < 3; ++c) out.reach[c] = reach[c];
  out.stretch = 1 + std::max(steepest(from, reach), steepest(to, reach));
  Terms change;
  for (size_t i = 0; i < change.size(); ++i) change[i] = to[i] - from[i];
  out.shift = most(change, reach) * out.stretch;
  return out;
}

float farthestShift(const MovingBend& bend) {
  return std::max(most(take(bend.begin), Vec3(bend.reach)), most(take(bend.end), Vec3(bend.reach)));
}

}  // namespace strandcast
