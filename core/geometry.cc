#include "core/geometry.h"

#include <fmt/format.h>
#include <Eigen/LU>
#include <Eigen/SVD>

#include <cmath>

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

void computeNormals(TriangleMesh& mesh) {
  mesh.normals.assign(mesh.positions.size(), Vec3::Zero());
  for (const auto& triangle : mesh.triangles) {
    for (int corner = 0; corner < 3; ++corner) {
      const uint32_t here = triangle[corner];
      const Vec3 a = mesh.positions[triangle[(corner + 1) % 3]] - mesh.positions[here];
      const Vec3 b = mesh.positions[triangle[(corner + 2) % 3]] - mesh.positions[here];
      const Vec3 normal = a.cross(b);
      const float doubled_area = normal.norm();
      if (doubled_area <= 0) continue;
      const float angle = std::atan2(doubled_area, a.dot(b));
      mesh.normals[here] += normal * (angle / doubled_area);
    }
  }
  for (Vec3& normal : mesh.normals) {
    const float length = normal.norm();
    normal = length > 0 ? Vec3(normal / length) : Vec3(0, 1, 0);
  }
}

Quat nearestRotation(const Eigen::Matrix3d& matrix) {
  // Newton's iteration for the polar decomposition (Higham 1986), if the matrix is nearly a multiple of a
  // rotation: a tenth of the time of the singular value decomposition below.
  constexpr double kNear = 0.2,
                   kRounding =
                       1e-8;  // of the determinant, after scaling to the norm of a rotation; of entries
  constexpr int kMaxRounds = 20;
  Eigen::Matrix3d near = matrix * (std::sqrt(3.0) / matrix.norm());
  double change = near.determinant() > kNear ? 1 : 0;
  for (int round = 0; round < kMaxRounds && change > 0; ++round) {
    const Eigen::Matrix3d next = 0.5 * (near + near.inverse().transpose());
    change = (next - near).cwiseAbs().maxCoeff();
    near = next;
    if (change < kRounding) return Eigen::Quaterniond(near).normalized().cast<float>();
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d u = svd.matrixU();
  if ((u * svd.matrixV().transpose()).determinant() < 0) u.col(2) *= -1;
  return Eigen::Quaterniond(u * svd.matrixV().transpose()).normalized().cast<float>();
}

}  // namespace strandcast
