#include "core/surface_bend.h"

#include <algorithm>

namespace strandcast {
namespace {

using Matrix3 = Eigen::Matrix3f;
using Terms = std::array<Vec3, 10>;

std::array<float, 10> products(const Vec3& p) {
  return {1,
          p.x(),
          p.y(),
          p.z(),
          p.x() * p.x(),
          p.y() * p.y(),
          p.z() * p.z(),
          p.x() * p.y(),
          p.y() * p.z(),
          p.z() * p.x()};
}

Vec3 shiftBy(const Terms& terms, const Vec3& p) {
  const std::array<float, 10> of = products(p);
  Vec3 sum = Vec3::Zero();
  for (size_t i = 0; i < of.size(); ++i) sum += of[i] * terms[i];
  return sum;
}

Matrix3 gradient(const Terms& t, const Vec3& p) {
  Matrix3 columns;
  columns.col(0) = t[1] + 2 * p.x() * t[4] + p.y() * t[7] + p.z() * t[9];
  columns.col(1) = t[2] + 2 * p.y() * t[5] + p.z() * t[8] + p.x() * t[7];
  columns.col(2) = t[3] + 2 * p.z() * t[6] + p.x() * t[9] + p.y() * t[8];
  return columns;
}

/// Of what has these terms, in a box that reaches so far from its middle, by its terms one by one.
float most(const Terms& terms, const Vec3& reach) {
  const std::array<float, 10> of = products(reach);
  float sum = 0;
  for (size_t i = 0; i < of.size(); ++i) sum += of[i] * terms[i].norm();
  return sum;
}

/// The largest gradient is at a corner: it is linear, and a norm of that convex.
float steepest(const Terms& terms, const Vec3& reach) {
  float found = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 sign(corner & 1 ? 1.0f : -1.0f, corner & 2 ? 1.0f : -1.0f, corner & 4 ? 1.0f : -1.0f);
    found = std::max(found, gradient(terms, reach.cwiseProduct(sign)).norm());
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

Vec3 SurfaceBend::shift(const Vec3& p) const { return shiftBy(terms, p - middle); }

SurfaceBend SurfaceBend::about(const Vec3& other) const {
  const Vec3 d = other - middle;
  SurfaceBend out = *this;
  out.middle = other;
  out.terms[0] = shiftBy(terms, d);
  const Matrix3 linear = gradient(terms, d);
  for (int c = 0; c < 3; ++c) out.terms[static_cast<size_t>(1 + c)] = linear.col(c);
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
