#include "core/pose_check.h"

#include <fmt/format.h>

#include "core/error.h"

namespace strandcast {

void checkPose(const Pose& pose, const char* where) {
  const Vec3& x = pose.position;
  // Written so that NaN fails, too.
  if (!(x.cwiseAbs().maxCoeff<Eigen::PropagateNaN>() <= kFarthestPose))
    throw Error(
        fmt::format("the position ({:g}, {:g}, {:g}) m is not finite or too far away", x.x(), x.y(), x.z()),
        where, fmt::format("give coordinates within +-{:g} m", kFarthestPose));
  const Quat& q = pose.rotation;
  if (!(std::fabs(q.norm() - 1) <= kUnitTolerance))
    throw Error(fmt::format("the rotation ({:g}, {:g}, {:g}, {:g}) is not a unit quaternion", q.x(), q.y(),
                            q.z(), q.w()),
                where, "normalise it");
}

}  // namespace strandcast
