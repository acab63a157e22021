#include "core/distance_field.h"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>

#include "kernels/scalar_strands.h"

namespace strandcast {
namespace {

namespace k = kernels::f32;

k::real3 lanes(const Vec3& v) { return {v.x(), v.y(), v.z()}; }
Vec3 vector(const k::real3& v) { return {v.x, v.y, v.z}; }

/// Trilinear interpolant of the eight values `get(n)`, n from `first` with these strides per axis.
template <class Get>
float interpolate(Get get, uint32_t first, uint32_t row, uint32_t slice, const k::real3& t,
                  k::real3& gradient) {
  const uint32_t above = first + slice;
  return k::trilinear(get(first), get(first + 1), get(first + row), get(first + row + 1), get(above),
                      get(above + 1), get(above + row), get(above + row + 1), t, gradient);
}

/// Range of the differences of neighbouring samples, per axis, in sample units.
struct Steps {
  Vec3 least = Vec3::Constant(1e9f), most = -least;
  void add(int axis, float step) {
    least[axis] = std::min(least[axis], step);
    most[axis] = std::max(most[axis], step);
  }
  // Every gradient of the interpolant lies in the box of these differences. Seen from 0, the box lies in a
  // cone of half angle asin(half its diagonal / distance of its centre).
  bool even() const {
    constexpr float kWide = 0.45f;  // 27 degrees of half angle: below 60 between two normals
    return (most - least).norm() < kWide * (most + least).norm();
  }
};

/// Adds the differences in the cells `first` to `end` of a brick, per axis.
void addSteps(const uint32_t* brick, const uint32_t (&first)[3], const uint32_t (&end)[3], Steps& steps) {
  const uint32_t strides[3] = {1, kBrickSide, kBrickSide * kBrickSide};
  for (uint32_t z = first[2]; z <= end[2]; ++z)
    for (uint32_t y = first[1]; y <= end[1]; ++y)
      for (uint32_t x = first[0]; x <= end[0]; ++x) {
        const uint32_t at[3] = {x, y, z}, n = (z * kBrickSide + y) * kBrickSide + x;
        for (int axis = 0; axis < 3; ++axis)
          if (at[axis] < end[axis])
            steps.add(axis,
                      static_cast<float>(fieldSample(brick, n + strides[axis]) - fieldSample(brick, n)));
      }
}

}  // namespace

bool DistanceField::hasInside() const {
  const auto is_inside = [](uint32_t words) {
    return (words & 0x80008000u) != 0;
  };  // sign bits of both samples
  const float deep =
      -0.5f * grid.quantum;  // corners on a sheet without volume are rounded to either side of it
  return std::any_of(corners.begin(), corners.end(), [&](float distance) { return distance < deep; }) ||
         std::any_of(samples.begin(), samples.end(), is_inside);
}

std::vector<uint32_t> DistanceField::evenness() const {
  constexpr int kMaxCells = 2;
  std::vector<uint32_t> words((storedBricks() + kEvennessesPerWord - 1) / kEvennessesPerWord);
  const auto brickAt = [&](const int(&at)[3]) -> const uint32_t* {
    for (int axis = 0; axis < 3; ++axis)
      if (at[axis] < 0 || at[axis] >= static_cast<int>(grid.bricks[axis])) return nullptr;
    const uint32_t entry =
        index[(static_cast<size_t>(at[2]) * grid.bricks[1] + at[1]) * grid.bricks[0] + at[0]];
    return entry < kInsideBrick ? samples.data() + size_t{entry} * kBrickWords : nullptr;
  };
  // Whether a brick with this many cells around it is even.
  const auto isEven = [&](const int(&at)[3], int cells) {
    Steps steps;
    for (int n = 0; n < 27; ++n) {
      const int side[3] = {n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1};
      if (cells == 0 && n != 13) continue;
      const int other[3] = {at[0] + side[0], at[1] + side[1], at[2] + side[2]};
      const uint32_t* brick = brickAt(other);
      if (brick == nullptr) return false;
      uint32_t first[3], end[3];
      for (int axis = 0; axis < 3; ++axis) {
        first[axis] = side[axis] < 0 ? kBrickCells - cells : 0;
        end[axis] = side[axis] > 0 ? cells : kBrickCells;
      }
      addSteps(brick, first, end, steps);
      if (!steps.even()) return false;
    }
    return true;
  };
  int at[3];
  for (at[2] = 0; at[2] < static_cast<int>(grid.bricks[2]); ++at[2])
    for (at[1] = 0; at[1] < static_cast<int>(grid.bricks[1]); ++at[1])
      for (at[0] = 0; at[0] < static_cast<int>(grid.bricks[0]); ++at[0]) {
        const uint32_t* brick = brickAt(at);
        if (brick == nullptr) continue;
        uint32_t even = 0;
        while (static_cast<int>(even) <= kMaxCells && isEven(at, static_cast<int>(even))) ++even;
        const auto entry = static_cast<uint32_t>((brick - samples.data()) / kBrickWords);
        words[entry / kEvennessesPerWord] |= even << (2 * (entry % kEvennessesPerWord));
      }
  return words;
}

size_t DistanceField::bytes() const {
  return sizeof(grid) + sizeof(uint32_t) * (index.size() + samples.size()) + sizeof(float) * corners.size();
}

FieldSample DistanceField::at(const Vec3& point) const {
  const k::real3 counts{static_cast<float>(grid.bricks[0]), static_cast<float>(grid.bricks[1]),
                        static_cast<float>(grid.bricks[2])};
  const k::FieldPlace place =
      k::fieldPlace(lanes(point), {grid.origin[0], grid.origin[1], grid.origin[2]}, grid.cell, counts);
  FieldSample out;
  k::real3 gradient;
  if (k::dot(place.outside, place.outside) > 0) {
    out.distance = k::distanceOutsideGrid(place.outside, grid.band, gradient);
    out.gradient = vector(gradient);
    return out;
  }
  const uint32_t entry = index[static_cast<uint32_t>(place.brick)];
  if (entry < kInsideBrick) {
    const uint32_t* brick = samples.data() + size_t{entry} * kBrickWords;
    const float value = interpolate([&](uint32_t n) { return static_cast<float>(fieldSample(brick, n)); },
                                    static_cast<uint32_t>(place.first_sample), kBrickSide,
                                    kBrickSide * kBrickSide, place.in_cell, gradient);
    out.distance = value * grid.quantum;
    out.gradient = vector(gradient) * (grid.quantum / grid.cell);
    return out;
  }
  const uint32_t row = grid.bricks[0] + 1;
  const float at_corners =
      interpolate([&](uint32_t n) { return corners[n]; }, static_cast<uint32_t>(place.corner), row,
                  row * (grid.bricks[1] + 1), place.in_brick, gradient);
  const float edge = grid.cell * kBrickCells;
  out.distance =
      k::farDistance(at_corners, place.in_brick, edge, entry == kOutsideBrick ? 1.0f : -1.0f, grid.band);
  out.gradient = vector(gradient) / edge;
  return out;
}

Vec3 samplePosition(const FieldGrid& grid, uint32_t i, uint32_t j, uint32_t k) {
  return {grid.origin[0] + grid.cell * static_cast<float>(i),
          grid.origin[1] + grid.cell * static_cast<float>(j),
          grid.origin[2] + grid.cell * static_cast<float>(k)};
}

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
  constexpr int kMaxRounds = 8, kMaxHalvings = 4;
  constexpr float kNear = 1e-6f;  // m, residual
  const kernels::f32::Bend bend = kernelBend(terms);
  const Vec3 from_middle = rest - middle;
  const auto offAt = [&](const Vec3& x) {
    return Vec3(x + fromKernel(kernels::f32::bendShift(bend, toKernel(x))) - from_middle);
  };
  // The fixed-point iteration x = rest - w(x) diverges where skin is compressed so much that w changes faster
  // than x. Newton steps with halving never increase the residual.
  Vec3 x = from_middle, off = offAt(x);
  for (int round = 0; round < kMaxRounds && off.norm() > kNear; ++round) {
    real3 by_x, by_y, by_z;
    kernels::f32::bendRates(bend, toKernel(x), by_x, by_y, by_z);
    Eigen::Matrix3f rates = Eigen::Matrix3f::Identity();
    rates.col(0) += fromKernel(by_x);
    rates.col(1) += fromKernel(by_y);
    rates.col(2) += fromKernel(by_z);
    Vec3 step = -(rates.inverse() * off);
    Vec3 next = x + step, next_off = offAt(next);
    for (int half = 0; half < kMaxHalvings && !(next_off.norm() < off.norm()); ++half) {
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
