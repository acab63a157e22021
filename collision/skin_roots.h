#pragma once
#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "collision/skin_parts.h"
#include "core/strand_model.h"
#include "io/skinned_mesh.h"

namespace strandcast {

/// What carries the roots of hair on a skinned body.
enum class BodyRoots : uint8_t {
  kSkin,  ///< each root moves with the blended skin under it
  kJoint  ///< all roots move with the joint on which hair grows
};

/// m. Roots farther than this from the skin at rest move with the joint on which hair grows.
constexpr float kFarthestFromSkin = 0.02f;

/// Attachment of strand roots to a skin. Each root moves with the closest point of the mesh at rest, as
/// blending and morph targets move that point, at a constant offset. Its rotation is the one
/// nearest to the blended linear parts of bindings (relative to rest), applied after the rotation of the
/// triangle by targets.
///
/// Bones of the model carry the roots, one per root. Roots over skin that is weighted to a single rigid joint
/// share that joint's bone.
class SkinRoots {
 public:
  /// `rigid`: per joint, whether it moves its skin without stretch. `joint`: the joint on which hair grows;
  /// its bone is the head. `most`: limit of bones besides the head. If more were needed, roots in the same
  /// cell of space with the same dominant joint share a bone. Error if even these are too many.
  SkinRoots(const SkinnedMesh& skin, const std::vector<bool>& rigid, uint32_t joint, const StrandSet& strands,
            size_t most = std::numeric_limits<uint16_t>::max());

  size_t bones() const { return points_.size(); }  ///< besides the head
  /// Per strand, its bone in a model passed to addTo(); 0 is the head.
  std::span<const uint16_t> rootBones() const { return root_bones_; }
  /// Adds the bones to a model of these strands and attaches the roots to them. Error unless the head is the
  /// model's only bone and nothing is pinned to it yet.
  void addTo(StrandModel& model) const;
  /// Poses relative to rest of bones 1 and up. `bindings`: result of SkinnedMesh::bindingsAt for `weights`
  /// (empty: as at rest). `poses`: bones() elements.
  void place(std::span<const Placement> bindings, std::span<const float> weights,
             std::span<Pose> poses) const;
  /// Findings, one line each.
  const std::vector<std::string>& notes() const { return notes_; }

 private:
  using Columns = Eigen::Matrix<double, 3, 2, Eigen::DontAlign>;
  /// Displacement by a target, at weight 1, of two edges of the triangle at rest, m.
  struct Tilt {
    uint32_t target;
    Columns edges;
  };
  struct Point {
    std::vector<SkinShare> terms;  ///< shares that determine its position
    Columns edges;                 ///< of the triangle at rest, m; used if there are tilts
    std::vector<Tilt> tilts;
    Eigen::Matrix<double, 3, 1, Eigen::DontAlign> rest;  ///< m
  };

  void addPoint(const SkinnedMesh& skin, const std::vector<std::vector<SkinShare>>& shares,
                std::span<const Placement> rest, const std::array<uint32_t, 3>& triangle,
                const Vec3& barycentric);
  Eigen::Matrix3d rotationByTargets(const Point& point, std::span<const float> weights) const;

  std::vector<Point> points_;
  std::vector<float> rest_weights_;    ///< per target
  size_t joint_bindings_ = 0;          ///< number of joints' bindings; those of targets follow
  std::vector<Eigen::Matrix3d> back_;  ///< per binding, the inverse of its linear part at rest
  std::vector<uint16_t> root_bones_;
  std::vector<std::string> notes_;
};

}  // namespace strandcast
