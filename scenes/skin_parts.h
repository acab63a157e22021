#pragma once
#include <span>
#include <string>
#include <vector>

#include "groom/skinned_mesh.h"

namespace strandcast {

struct SkinCut {
  /// Parts between two joints, where their weights go over from one to the other, beside those of the joints
  /// themselves; 0 or more.
  int between = 5;
  /// By how much of a joint's share, 0 to 1, a part reaches into its neighbours beyond where it is cut.
  float overlap = 0.05f;
};

/// A piece of a skinned mesh that moves rigidly: what has nearly the same weights.
struct SkinPart {
  std::string name;   ///< of its joint; between two of them, of both
  TriangleMesh mesh;  ///< of the mesh at rest, closed with caps where it was cut and where it is open; m
  /// What the rigid motion that fits the blended vertices best (Kabsch 1976) is made of.
  struct Moment {
    uint32_t binding;
    Eigen::Matrix<double, 4, 3, Eigen::DontAlign> spread;
    Eigen::Matrix<double, 4, 1, Eigen::DontAlign> middle;
  };
  std::vector<Moment> moments;
  Eigen::Matrix<double, 3, 1, Eigen::DontAlign> middle;  ///< at rest, m
};

/// Cuts a skinned mesh into closed parts, at most kMostSkinParts: where there would be more, with fewer
/// between joints. A triangle belongs to the two joints with the largest sum of weights over its corners, and
/// to the part for their shares. Throws Error on a joint that has no inverse at rest, and on too many joints.
std::vector<SkinPart> cutSkin(const SkinnedMesh& skin, const SkinCut& cut);
inline constexpr size_t kMostSkinParts = 100;

/// How a part is moved from rest. A part whose vertices hang on one joint moves with it, others with the
/// rigid motion that brings the cut-out vertices nearest to where they are blended, in the mean of squares.
/// `bindings`: of SkinnedMesh::bindingsAt.
Pose partPose(const SkinPart& part, std::span<const Placement> bindings);

/// The rotation nearest to a matrix.
Quat nearestRotation(const Eigen::Matrix3d& matrix);

}  // namespace strandcast
