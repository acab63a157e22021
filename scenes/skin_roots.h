#pragma once
#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "core/strand_model.h"
#include "groom/skinned_mesh.h"
#include "scenes/fine_skin.h"

namespace strandcast {

/// What the roots of hair on a skinned body move with.
enum class BodyRoots : uint8_t {
  kSkin,  ///< each with the skin under it, as that is blended
  kJoint  ///< all with the joint that hair grows on
};

/// m: roots farther than this from the skin at rest stay on the joint that hair grows on.
constexpr float kFarthestFromSkin = 0.02f;

/// Roots of strands that stay on a skin: each goes with the nearest point of the mesh at rest as that is
/// blended and morph targets move it, keeps its way from there, and is turned as the bindings' turns since
/// rest, blended there, are nearest to a rotation, after targets have turned the triangle that it is on.
/// Bones of a model carry them, one a root; roots that hang wholly on one joint, which carries them rigidly,
/// share that joint's.
class SkinRoots {
 public:
  /// `rigid`: per joint, whether it never stretches what hangs on it. `joint`: the one that hair grows on,
  /// whose bone is the head. More than `most` bones beside it there are not: where roots would need them,
  /// those that lie within a cell of space and hang on the same joint most share one. Error where even so
  /// there are too few.
  SkinRoots(const SkinnedMesh& skin, const std::vector<bool>& rigid, uint32_t joint, const StrandSet& strands,
            size_t most = std::numeric_limits<uint16_t>::max());

  size_t bones() const { return points_.size(); }  ///< beside the head
  /// Per strand, the bone of a model that addTo() has added to; 0 is the head.
  std::span<const uint16_t> rootBones() const { return root_bones_; }
  /// Adds the bones and ties the strands' roots to them. Of a model of these strands that has no bone but the
  /// head and pins nothing to it yet, else Error.
  void addTo(StrandModel& model) const;
  /// Where bone 1 and on are relative to rest. `bindings`: of SkinnedMesh::bindingsAt, made with `weights`
  /// (empty = as at rest). `poses`: bones().
  void place(std::span<const Placement> bindings, std::span<const float> weights,
             std::span<Pose> poses) const;
  /// What was found, a line each.
  const std::vector<std::string>& notes() const { return notes_; }

 private:
  using Columns = Eigen::Matrix<double, 3, 2, Eigen::DontAlign>;
  /// What a target does, at weight 1, to two edges of the triangle at rest, m.
  struct Tilt {
    uint32_t target;
    Columns edges;
  };
  struct Point {
    std::vector<SkinShare> terms;  ///< of its place
    Columns edges;                 ///< of the triangle at rest, m; used where there are tilts
    std::vector<Tilt> tilts;
    Eigen::Matrix<double, 3, 1, Eigen::DontAlign> rest;  ///< m
  };

  void addPoint(const SkinnedMesh& skin, const std::vector<std::vector<SkinShare>>& shares,
                std::span<const Placement> rest, const std::array<uint32_t, 3>& triangle,
                const Vec3& barycentric);
  Eigen::Matrix3d turnByTargets(const Point& point, std::span<const float> weights) const;

  std::vector<Point> points_;
  std::vector<float> rest_weights_;    ///< of the targets
  size_t joint_bindings_ = 0;          ///< those of targets follow
  std::vector<Eigen::Matrix3d> back_;  ///< per binding, what undoes its linear part at rest
  std::vector<uint16_t> root_bones_;
  std::vector<std::string> notes_;
};

}  // namespace strandcast
