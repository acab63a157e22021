#pragma once
#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "core/strand_model.h"
#include "groom/skinned_mesh.h"

namespace strandcast {

/// What the roots of hair on a skinned body move with.
enum class BodyRoots : uint8_t {
  kSkin,  ///< each with the skin under it, as that is blended
  kJoint  ///< all with the joint that hair grows on
};

/// m: roots farther than this from the skin at rest stay on the joint that hair grows on.
constexpr float kFarthestFromSkin = 0.02f;

/// Roots of strands that stay on a skin: each goes with the nearest point of the mesh at rest as that is
/// blended, keeps its way from there, and is turned as the bindings' turns since rest, blended there, are
/// nearest to a rotation. Bones of a model carry them, one a root; roots that hang wholly on one joint, which
/// carries them rigidly, share that joint's.
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
  /// Where bone 1 and on are relative to rest. `bindings`: of SkinnedMesh::bindingsAt. `poses`: bones().
  void place(std::span<const Placement> bindings, std::span<Pose> poses) const;
  /// What was found, a line each.
  const std::vector<std::string>& notes() const { return notes_; }

 private:
  /// A point of the skin: of each binding that it hangs on, what is moved, with the weight as fourth.
  struct Term {
    uint32_t binding;
    Eigen::Matrix<double, 4, 1, Eigen::DontAlign> stored;
  };
  struct Point {
    size_t first_term;                                   ///< its terms end where the next one's begin
    Eigen::Matrix<double, 3, 1, Eigen::DontAlign> rest;  ///< m
  };

  void addPoint(const SkinnedMesh& skin, std::span<const Placement> rest,
                const std::array<uint32_t, 3>& triangle, const Vec3& barycentric);

  std::vector<Point> points_;
  std::vector<Term> terms_;
  std::vector<Eigen::Matrix3d> back_;  ///< per binding, what undoes its linear part at rest
  std::vector<uint16_t> root_bones_;
  std::vector<std::string> notes_;
};

}  // namespace strandcast
