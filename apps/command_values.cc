#include "apps/command_values.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apps/command_limits.h"
#include "core/error.h"

namespace strandcast {

std::string commandText(uint64_t id) { return fmt::format("command {}", id); }

Pose commandedPose(const std::vector<double>& values, size_t first, const std::string& where) {
  const double* const v = values.data() + first;
  if (!std::all_of(v, v + 3, [](double x) { return std::fabs(x) <= kFarthestPlace; }))
    throw Error("a pose is too far away", where,
                fmt::format("give x y z in metres, each within {}", kFarthestPlace));
  const Quat rotation(Eigen::Quaterniond(v[6], v[3], v[4], v[5]).cast<float>());
  if (!(std::fabs(rotation.norm() - 1) < 0.5f))
    throw Error("a rotation is not a unit quaternion", where, "give x y z w, with squares that add up to 1");
  return {Vec3(Eigen::Vector3d(v[0], v[1], v[2]).cast<float>()), rotation.normalized()};
}

}  // namespace strandcast
