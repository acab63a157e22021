#include "core/nearest_rotation.h"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <cmath>

namespace strandcast {

Quat nearestRotation(const Eigen::Matrix3d& matrix) {
  // Newton's iteration for the polar decomposition (Higham 1986), if the matrix is nearly a multiple of a
  // rotation: a tenth of the time of the singular value decomposition below.
  constexpr double kNear = 0.2,
                   kRounding =
                       1e-8;  // of the determinant, after scaling to the norm of a rotation; of entries
  constexpr int kMostRounds = 20;
  Eigen::Matrix3d near = matrix * (std::sqrt(3.0) / matrix.norm());
  double change = near.determinant() > kNear ? 1 : 0;
  for (int round = 0; round < kMostRounds && change > 0; ++round) {
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
