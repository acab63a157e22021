#include "air/wind.h"

#include <algorithm>

namespace strandcast {
namespace {

constexpr float kWindBox = 2;  // edge of the wind's box over the largest edge of the groom's box

}  // namespace

Vec3 Wind::placeOf(int axis, int i, int j, int k) const {
  Vec3 place(static_cast<float>(i), static_cast<float>(j), static_cast<float>(k));
  for (int a = 0; a < 3; ++a)
    if (a != axis) place[a] += 0.5f;
  return origin() + place * cell();
}

void Wind::setVelocity(const std::function<Vec3(const Vec3&)>& velocity) {
  setComponents([&](int axis, int i, int j, int k) { return velocity(placeOf(axis, i, j, k))[axis]; });
}

double Wind::flowOut() const {
  const int n = cells();
  double sum = 0;
  for (int a = 0; a < n; ++a)
    for (int b = 0; b < n; ++b)
      sum += component(0, n, a, b) - component(0, 0, a, b) + component(1, a, n, b) - component(1, a, 0, b) +
             component(2, a, b, n) - component(2, a, b, 0);
  return sum * static_cast<double>(cell()) * static_cast<double>(cell());
}

float windCell(const Box& box, int cells) {
  return kWindBox * std::max(box.sizes().maxCoeff(), 1e-3f) / static_cast<float>(cells);
}

}  // namespace strandcast
