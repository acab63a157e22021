#pragma once
#include <array>
#include <span>
#include <vector>

#include "groom/skinned_mesh.h"

namespace strandcast {

/// What of a point of a skin moves with a binding.
struct SkinShare {
  uint32_t binding;  ///< of SkinnedMesh::bindingsAt
  /// As SkinnedMesh::stored, with a 1, times its weight; of a target's binding how far the target moves it,
  /// with a 0, times the weight of the joint's binding.
  Eigen::Matrix<double, 4, 1, Eigen::DontAlign> stored;
  double weight() const { return stored[3]; }
};

/// The surface of a skinned mesh in triangles over each of which weights change little. Where the mesh is
/// coarse, vertices come between its own. They stay in its flat triangles, between where the corners are
/// blended to, and are not blended from weights of their own.
struct FineSkin {
  std::vector<Vec3> positions, normals;  ///< at rest, m; no two vertices are at one place
  std::vector<std::array<uint32_t, 3>> triangles;
  std::vector<std::vector<SkinShare>> shares;  ///< per vertex, by binding
};
FineSkin fineSkin(const SkinnedMesh& skin);

/// The shares of every vertex of a skin, each by binding.
std::vector<std::vector<SkinShare>> skinShares(const SkinnedMesh& skin);

/// Where what has these shares is, by `bindings` as of SkinnedMesh::bindingsAt.
Eigen::Vector3d blended(const std::vector<SkinShare>& shares, std::span<const Placement> bindings);

}  // namespace strandcast
