#include "validation/shaken_root.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace strandcast {

Pose shakenRoot(double time, const Shake& shake) {
  const double u = shake.ramp > 0 ? std::clamp(time / shake.ramp, 0.0, 1.0) : 1;
  const double grown = u * u * u * (10 - 15 * u + 6 * u * u);
  auto swing = [&](double hertz) { return grown * std::sin(2 * std::numbers::pi * hertz * time); };
  const double x = shake.reach * swing(shake.shakes), angle = std::numbers::pi / 4 * swing(shake.turns);
  return {Vec3(static_cast<float>(x), 0, 0),
          Quat(Eigen::AngleAxisf(static_cast<float>(angle), Eigen::Vector3f::UnitZ()))};
}

}  // namespace strandcast
