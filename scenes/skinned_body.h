#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "collision/surface_orientation.h"
#include "core/simulation.h"
#include "groom/skinned_mesh.h"
#include "scenes/skin_parts.h"
#include "scenes/skin_roots.h"

namespace strandcast {

/// How a skinned body is moved.
struct SkinnedMotion {
  /// Of its own clips, by name, or a .bvh file whose joints have the same names; empty = none, it stands as
  /// it is at rest.
  std::string clip;
  /// The joint that hair grows on and that the head's motion turns, with all that hangs on it; empty = the
  /// first with "head" in its name, or the only one that carries the body.
  std::string joint;
  BodyRoots roots = BodyRoots::kSkin;
  float clip_unit_meters = 0;  ///< metres per unit of a .bvh clip; 0 = found, see unitOf()
};

/// A body whose skin is blended from its joints and its clip's morph targets, and its parts, which follow it.
/// A clip starts from rest within half a second and is played in a loop: travel is taken out and the end
/// returns to the start. The
/// head's motion is relative to where the clip has the joint.
class SkinnedBody {
 public:
  /// Throws Error on an unknown clip or joint, and as cutSkin and readBvh.
  SkinnedBody(SkinnedMesh skin, const SkinnedMotion& motion);

  const SkinnedMesh& skin() const { return skin_; }
  const std::vector<SkinPart>& parts() const { return parts_; }
  const std::string& joint() const { return nameOf(joint_); }
  Vec3 pivot() const;                                 ///< m, where the joint is at rest
  double duration() const { return clip_.duration; }  ///< s, of the clip; 0 without one
  bool hasClip() const { return !clip_.isStill(); }
  /// How much of each vertex hangs on the joint and what hangs on it, 0 to 1.
  std::vector<float> jointWeights() const;
  /// What was found while making it, a line each.
  const std::vector<std::string>& notes() const { return notes_; }
  /// What the skin's winding was mended by before the parts were cut from it; skin() is as it was read.
  const SurfaceRepair& repair() const { return repair_; }

  /// Where the clip has the joint, relative to rest.
  Pose carried(double seconds) const;
  /// Where the skeleton is at a time of the clip, when the head's motion is at `head`.
  struct Moment {
    Pose carried;                     ///< see carried()
    std::vector<Placement> joints;    ///< m
    std::vector<float> weights;       ///< of SkinnedMesh::targets
    std::vector<Placement> bindings;  ///< SkinnedMesh::bindingsAt
  };
  Moment at(double seconds, const Pose& head) const;
  /// Where a part is, relative to rest, and how it is bent there.
  struct PlacedPart {
    Pose pose;
    SurfaceBend bend;
  };
  std::vector<PlacedPart> placedParts(const Moment& moment) const;
  /// The skin, m, when the head's motion is at `head`.
  std::vector<Vec3> surface(double seconds, const Pose& head) const;

  /// From now on these strands grow on the skin, by `most_bones` at most. A Simulation is then to be made of
  /// a model that knows it (sceneModel).
  void growOnSkin(const StrandSet& strands, size_t most_bones);
  const SkinRoots* roots() const { return roots_ ? &*roots_ : nullptr; }  ///< null = all go with the joint
  /// Of the bones of roots().
  std::vector<Pose> placedRoots(const Moment& moment) const;

  /// The first of the parts' bodies in the simulation; the others follow it.
  BodyId first_body = 0;

  /// Throws Error, naming `where`, on an unknown joint.
  void checkJoint(const std::string& joint, const std::string& where) const;
  /// From now on this body of the simulation goes with the joint, from where that is at rest. Throws Error on
  /// an unknown joint.
  void hang(BodyId body, const std::string& joint);
  /// The joint that a body hangs on; null where it hangs on none.
  const std::string* jointOf(BodyId body) const;
  struct HangingBody {
    BodyId body;
    Pose pose;  ///< of its joint, relative to rest
  };
  /// Those that hang on joints.
  std::vector<HangingBody> placedBodies(const Moment& moment) const;

 private:
  const std::string& nameOf(size_t joint) const { return skin_.skeleton.joints[joint].name; }
  /// Where in the clip a time is: within a loop, and how much of the start is blended in towards its end.
  struct ClipTime {
    double seconds, share, back, from_rest;
  };
  ClipTime clipTime(double seconds) const;
  std::vector<JointTransform> played(double seconds) const;
  std::vector<float> weightsAt(double seconds) const;
  void choose(const SkinnedMotion& motion);
  void tellOfTravel();
  std::vector<bool> rigidJoints() const;

  SkinnedMesh skin_;
  SkeletonClip clip_;
  size_t joint_ = 0;
  std::vector<bool> below_;  ///< per joint: it is the joint or hangs on it
  std::vector<Placement> rest_;
  std::vector<JointTransform> rest_locals_, first_, last_;  ///< at rest, and the clip's ends
  SurfaceRepair repair_;
  std::vector<float> rest_weights_, first_weights_;
  std::vector<SkinPart> parts_;
  std::vector<std::pair<BodyId, size_t>> hanging_;  ///< bodies, and the joints that they hang on
  std::optional<SkinRoots> roots_;
  std::vector<std::string> notes_;
};

/// Tells the simulation where head, roots and body are to be at `seconds`, when the head's motion is at
/// `head`. `body` may be null: then `head` is where the head is. Of bodies that hang on joints the simulation
/// may have lost some.
void moveTo(const SkinnedBody* body, double seconds, const Pose& head, Simulation& simulation);

}  // namespace strandcast
