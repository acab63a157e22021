#pragma once
#include <span>
#include <string>
#include <vector>

#include "core/surface_bend.h"
#include "groom/skinned_mesh.h"
#include "scenes/fine_skin.h"

namespace strandcast {

/// A piece of a skinned mesh that moves nearly rigidly: what has nearly the same weights.
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
  /// Points all over a part that bends, by which its bend is found.
  struct Sample {
    Vec3 rest, normal;  ///< m, at rest
    std::vector<SkinShare> shares;
  };
  std::vector<Sample> samples;
};

/// Cuts a skinned mesh, as FineSkin has it, into closed parts, at most kMostSkinParts: where there would be
/// more, with fewer between the joints that have the smallest. A triangle belongs to the two joints with the
/// largest sum of weights over its corners, and to the part for their shares: a joint's own, which is rigid,
/// or one of `between`, 0 or more, parts where their weights go over from one to the other, which bend. What
/// morph targets move of a joint's own is up to eight parts beside it, which bend; where these would be too
/// many, the joint's own bends as a whole. Throws Error on a joint that has no inverse at rest, and on too
/// many joints.
std::vector<SkinPart> cutSkin(const SkinnedMesh& skin, int between = 5);
inline constexpr size_t kMostSkinParts = 100;

/// How a part is moved from rest. A part whose vertices hang on one joint moves with it, others with the
/// rigid motion that brings the cut-out vertices nearest to where they are blended, in the mean of squares.
/// `bindings`: of SkinnedMesh::bindingsAt.
Pose partPose(const SkinPart& part, std::span<const Placement> bindings);

/// How the part at `pose` is bent on top of it, in the mean of squares over its samples, by `bindings` as of
/// partPose(). None where that is less than 10 um.
SurfaceBend partBend(const SkinPart& part, std::span<const Placement> bindings, const Pose& pose);

/// How a joint is turned; where it is a mirror image, how the image through its middle is. From one such to
/// another the rotation is the joint's own.
Quat turnOf(const Placement& joint);

}  // namespace strandcast
