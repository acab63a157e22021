#pragma once
#include <array>
#include <span>
#include <vector>

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

}  // namespace strandcast
