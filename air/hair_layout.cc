#include "air/hair_layout.h"

#include <algorithm>
#include <utility>

#include "kernels/scalar_double.h"

namespace strandcast {
namespace {

constexpr double kFastestWave = 1.4;  // cells in a step; with 2, hair that was pushed apart vibrates
constexpr int kMargin = 6;            // cells around the groom at rest

}  // namespace

double HairLayout::largestStiffness(double seconds) const {
  const double speed = kFastestWave * static_cast<double>(cell) / seconds;
  return speed * speed;
}

Pose HeadExtrapolation::ahead(const Pose& begin, const Pose& end) {
  if (std::exchange(
          retold_, false)) {  // `begin` was rounded to the new origin; the shift alone would not reproduce it
    begin_.position += begin.position - end_.position;
    end_.position = begin.position;
  }
  const bool goes_on =
      known_ && begin.position == end_.position && begin.rotation.coeffs() == end_.rotation.coeffs();
  const Pose before = goes_on ? begin_ : begin;
  known_ = true;
  begin_ = begin;
  end_ = end;
  const auto part = static_cast<float>(kernels::f64::extrapolationShare());
  const Quat turn = begin.rotation * before.rotation.conjugate();
  return {begin.position + part * (begin.position - before.position),
          (Quat::Identity().slerp(part, turn) * begin.rotation).normalized()};
}

HairLayout hairLayout(const Box& box, int cells) {
  const float cell = std::max(box.sizes().maxCoeff(), 1e-3f) / static_cast<float>(cells - 1 - 2 * kMargin);
  return {cells, cell, Vec3(box.center()) - Vec3::Constant(0.5f * cell * static_cast<float>(cells - 1))};
}

}  // namespace strandcast
