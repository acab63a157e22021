// Pieces of a skinned mesh that move nearly rigidly, cut from the skin after refinement.
#pragma once
#include <array>
#include <span>
#include <string>
#include <vector>

#include "core/distance_field.h"
#include "io/skinned_mesh.h"

namespace strandcast {

/// Contribution of a binding to a point of a skin.
struct SkinShare {
  uint32_t binding;  ///< index into the result of SkinnedMesh::bindingsAt
  /// Homogeneous stored position (SkinnedMesh::stored, with a 1) times the weight. For a target's binding:
  /// the target's displacement (with a 0) times the weight of the joint's binding.
  Eigen::Matrix<double, 4, 1, Eigen::DontAlign> stored;
  double weight() const { return stored[3]; }
};

/// The surface of a skinned mesh, refined so that weights change little over each triangle. Added vertices
/// lie in the flat triangles of the mesh: they are interpolated between the blended corners, not blended from
/// interpolated weights.
struct FineSkin {
  std::vector<Vec3> positions, normals;  ///< at rest, m; positions are unique
  std::vector<std::array<uint32_t, 3>> triangles;
  std::vector<std::vector<SkinShare>> shares;  ///< per vertex, by binding
};
/// Refines the surface of a skin. Joints and targets are at rest.
FineSkin fineSkin(const SkinnedMesh& skin);

/// The shares of each vertex of a skin, sorted by binding.
std::vector<std::vector<SkinShare>> skinShares(const SkinnedMesh& skin);

/// Blended position of a point with these shares, m. `bindings`: result of SkinnedMesh::bindingsAt.
Eigen::Vector3d blended(const std::vector<SkinShare>& shares, std::span<const Placement> bindings);

/// A piece of a skinned mesh with nearly uniform weights, which therefore moves nearly rigidly.
struct SkinPart {
  std::string name;   ///< name of its joint; of a part between two joints, the names of both
  TriangleMesh mesh;  ///< the mesh at rest, with caps that close cuts and openings; m
  /// One binding's terms of the least-squares rigid motion of the blended vertices (Kabsch 1976).
  struct Moment {
    uint32_t binding;
    Eigen::Matrix<double, 4, 3, Eigen::DontAlign> spread;
    Eigen::Matrix<double, 4, 1, Eigen::DontAlign> middle;
  };
  std::vector<Moment> moments;
  Eigen::Matrix<double, 3, 1, Eigen::DontAlign> middle;  ///< at rest, m
  /// Points spread over a part that bends, to which its bend is fitted.
  struct Sample {
    Vec3 rest, normal;  ///< m, at rest
    std::vector<SkinShare> shares;
  };
  std::vector<Sample> samples;
};

/// Cuts a skinned mesh, refined as FineSkin, into at most kMaxSkinParts closed parts.
///
/// A triangle belongs to the two joints with the largest sums of weights over its corners, and to a part by
/// the ratio of these sums. Each joint has a rigid part of its own. Between two joints there are `between` (0
/// or more) parts, which bend. Too many parts are reduced first between the joints with the smallest ones.
///
/// The triangles of a joint's own part that morph targets move form up to eight further parts, which bend. If
/// these are too many, the joint's own part bends as a whole.
///
/// Throws Error on a joint whose matrix at rest has no inverse, and on too many joints.
std::vector<SkinPart> cutSkin(const SkinnedMesh& skin, int between = 5);
inline constexpr size_t kMaxSkinParts = 100;

/// Motion of a part from rest. A part whose vertices are weighted to one joint moves with that joint. Other
/// parts have the rigid motion that fits their blended vertices best in the least-squares sense. `bindings`:
/// result of SkinnedMesh::bindingsAt.
Pose partPose(const SkinPart& part, std::span<const Placement> bindings);

/// Bend of a part relative to `pose`, fitted to its samples by least squares. `bindings`: as in partPose().
/// No bend if all displacements are below 10 um.
SurfaceBend partBend(const SkinPart& part, std::span<const Placement> bindings, const Pose& pose);

}  // namespace strandcast
