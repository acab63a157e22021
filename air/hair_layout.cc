#include "air/hair_layout.h"

#include <algorithm>

#include "kernels/scalar_double.h"

namespace strandcast {
namespace {

constexpr double kFastestWave = 1.4;  // cells in a step; with 2, hair that was pushed apart trembles
constexpr int kMargin = 6;            // cells around the groom at rest

}  // namespace

double HairLayout::largestStiffness(double seconds) const {
  const double speed = kFastestWave * static_cast<double>(cell) / seconds;
  return speed * speed;
}

Pose headAhead(const std::optional<Pose>& before, const Pose& now) {
  if (!before) return now;
  const auto part = static_cast<float>(kernels::f64::partAhead());
  const Quat turn = now.rotation * before->rotation.conjugate();
  return {now.position + part * (now.position - before->position),
          (Quat::Identity().slerp(part, turn) * now.rotation).normalized()};
}

HairLayout hairLayout(const Box& box, int cells) {
  const float cell = std::max(box.sizes().maxCoeff(), 1e-3f) / static_cast<float>(cells - 1 - 2 * kMargin);
  return {cells, cell, Vec3(box.center()) - Vec3::Constant(0.5f * cell * static_cast<float>(cells - 1))};
}

}  // namespace strandcast
