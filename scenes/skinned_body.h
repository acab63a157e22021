#pragma once
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "collision/mesh_repair.h"
#include "collision/skin_parts.h"
#include "collision/skin_roots.h"
#include "core/simulation.h"
#include "io/skinned_mesh.h"

namespace strandcast {

/// Motion of a skinned body.
struct SkinnedMotion {
  /// Name of one of its own clips, or a .bvh file with joints of the same names; empty: none, the body stays
  /// at rest.
  std::string clip;
  /// The joint on which hair grows and which the head's motion rotates, with all its descendants. Empty: the
  /// first with "head" in its name, or the only one that carries the body.
  std::string joint;
  BodyRoots roots = BodyRoots::kSkin;
  /// Morph targets that the skin has: those that the clip plays, or all, so that programs can weigh them.
  BodyTargets targets = BodyTargets::kClip;
  float clip_unit_meters = 0;  ///< metres per unit of a .bvh clip; 0: deduced, see unitOf()
};

/// A body whose skin is blended from its joints and its clip's morph targets, with the parts that follow it.
/// A clip starts from rest within half a second and is looped: travel is removed, and the end returns to the
/// start. The head's motion is relative to the clip's pose of the joint.
class SkinnedBody {
 public:
  /// `skin`: read with motion.targets. Throws Error on an unknown clip or joint, and as cutSkin and readBvh.
  SkinnedBody(SkinnedMesh skin, const SkinnedMotion& motion);

  const SkinnedMesh& skin() const { return skin_; }
  const std::vector<SkinPart>& parts() const { return parts_; }
  const std::string& joint() const { return nameOf(joint_); }
  /// Joints whose motion carries the hair: the joint on which it grows, then its ancestors, nearest first.
  const std::vector<size_t>& carriers() const { return carriers_; }
  Vec3 pivot() const;                                 ///< m, position of the joint at rest
  double duration() const { return clip_.duration; }  ///< s, of the clip; 0 without one
  bool hasClip() const { return !clip_.isStill(); }
  /// Per vertex, the sum of weights of the joint and its descendants, 0 to 1.
  std::vector<float> jointWeights() const;
  /// Findings while making the body, one line each.
  const std::vector<std::string>& notes() const { return notes_; }
  /// Repairs of the skin's winding before the parts were cut from it; skin() has the original winding.
  const SurfaceRepair& repair() const { return repair_; }

  /// Pose of the joint in the clip, relative to rest.
  Pose carried(double seconds) const;
  /// State of the skeleton at a time of the clip or in a palette, with the head's motion at `head`.
  struct Moment {
    Pose carried;                     ///< pose of the joint relative to rest, without the head's motion
    std::vector<Placement> joints;    ///< world transforms, m
    std::vector<float> weights;       ///< per target of SkinnedMesh::targets
    std::vector<Placement> bindings;  ///< result of SkinnedMesh::bindingsAt
  };
  /// `weights`: per target of SkinnedMesh::targets, in place of the clip's; empty: the clip's.
  Moment at(double seconds, const Pose& head, std::span<const float> weights = {}) const;
  /// As at(), with a palette in place of the clip: nothing is looped or blended. `motions`: per joint of the
  /// skeleton its motion from rest, x_world = motion * x_rest, m, in the axes of skin().mesh. A joint without
  /// one moves rigidly with its nearest ancestor that has one; without such an ancestor it stays at rest.
  /// `weights`: per target of SkinnedMesh::targets; empty: as at rest. All numbers must be finite, and the
  /// linear parts of motions invertible. Roots over a joint that the clip does not scale move rigidly
  /// with it.
  Moment fromPalette(std::span<const std::optional<Placement>> motions, std::span<const float> weights,
                     const Pose& head) const;
  /// Pose of a part relative to rest, and its bend there.
  struct PlacedPart {
    Pose pose;
    SurfaceBend bend;
  };
  std::vector<PlacedPart> placedParts(const Moment& moment) const;
  /// Vertices of the skin, m, with the head's motion at `head`.
  std::vector<Vec3> surface(double seconds, const Pose& head) const;

  /// Attaches the roots of these strands to the skin, with at most `max_bones` bones. The Simulation must
  /// then be made from a model with these bones (sceneModel).
  void growOnSkin(const StrandSet& strands, size_t max_bones);
  /// Null: all roots move with the joint.
  const SkinRoots* roots() const { return roots_ ? &*roots_ : nullptr; }
  /// Poses of the bones of roots().
  std::vector<Pose> placedRoots(const Moment& moment) const;

  /// Id in the simulation of the body of the first part; those of the other parts follow.
  BodyId first_body = 0;

  /// Throws Error, which names `where`, on an unknown joint.
  void checkJoint(const std::string& joint, const std::string& where) const;
  /// Attaches a body of the simulation to a joint, relative to the joint at rest. Throws Error on an unknown
  /// joint.
  void attachToJoint(BodyId body, const std::string& joint);
  /// The joint to which a body is attached; null if none.
  const std::string* jointOf(BodyId body) const;
  struct AttachedBody {
    BodyId body;
    Pose pose;  ///< motion of its joint relative to rest
  };
  /// Poses of all bodies that are attached to joints.
  std::vector<AttachedBody> placedBodies(const Moment& moment) const;

 private:
  const std::string& nameOf(size_t joint) const { return skin_.skeleton.joints[joint].name; }
  /// `seconds`: time within the loop of the clip; `share`: its fraction of the loop; `back`: blend factor
  /// towards the loop's start, at its end; `from_rest`: blend factor from rest, at the beginning.
  struct ClipTime {
    double seconds, share, back, from_rest;
  };
  ClipTime clipTime(double seconds) const;
  std::vector<JointTransform> played(double seconds) const;
  std::vector<float> weightsAt(double seconds) const;
  /// `joints`, `weights`: as in Moment, without the head's motion.
  Moment momentOf(std::vector<Placement> joints, std::vector<float> weights, const Pose& head) const;
  void choose(const SkinnedMotion& motion);
  void noteTravel();
  std::vector<bool> rigidJoints() const;

  SkinnedMesh skin_;
  SkeletonClip clip_;
  size_t joint_ = 0;
  std::vector<bool> below_;       ///< per joint: it is the joint or a descendant
  std::vector<size_t> carriers_;  ///< joint_ and its ancestors
  std::vector<Placement> rest_;
  std::vector<JointTransform> rest_locals_, first_, last_;  ///< at rest, and at both ends of the clip
  SurfaceRepair repair_;
  std::vector<float> rest_weights_, first_weights_;
  std::vector<SkinPart> parts_;
  std::vector<std::pair<BodyId, size_t>>
      attached_bodies_;  ///< bodies with the joints to which they are attached
  std::optional<SkinRoots> roots_;
  std::vector<std::string> notes_;
};

/// Sets the poses of head, roots and body parts in the simulation for `moment`, which was made with the
/// head's motion at `head`. Attached bodies that no longer exist in the simulation are skipped. Throws Error,
/// as the setters of Simulation do, if a pose is out of range; those before it are then set.
void place(const SkinnedBody& body, const SkinnedBody::Moment& moment, const Pose& head,
           Simulation& simulation);
/// place() for the body at `seconds` of its clip. `body` may be null: `head` is then the pose of the head.
void moveTo(const SkinnedBody* body, double seconds, const Pose& head, Simulation& simulation);

}  // namespace strandcast
