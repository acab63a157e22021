#pragma once
#include <span>
#include <vector>

#include "transport/chunks.h"
#include "transport/codec/guide_payload.h"
#include "transport/collider_motion.h"
#include "transport/messages.h"

namespace strandcast {

/// Estimates positions of lost strands. A strand is extrapolated along its last motion in the frame of its
/// carrier, with its last edge lengths, for as long as extrapolation() says; then it stays at rest in that
/// frame until it is received again. The carrier is the head or the part of a skinned body on which the
/// strand's root lies at rest, whichever predicted the received root better.
class Concealment {
 public:
  /// Resets all motion. `guides`: rest shape, m, groom frame.
  void setGroom(const StrandSet& guides);
  /// Sets the parts of the body of the groom's session. Without them the head carries all strands.
  void setColliders(const ColliderSet& set);
  /// Records the strands of `frame` that are in `received`; runs with strand_count 0 are skipped.
  /// received.front() is the run of chunk 0, which has the poses of colliders: if it is missing, sets
  /// frame.colliders to extrapolated poses.
  void learn(GuideFrame& frame, std::span<const StrandRun> received);
  /// Sets the positions of the strands that learn() did not get in this frame, and frame.strands_concealed.
  /// False when a strand was never received or a position is not finite.
  bool conceal(GuideFrame& frame);

 private:
  struct Strand {
    double last = 0, before = 0;  // simulation times of the last two receptions, s; valid up to `count`
    uint32_t count = 0;           // receptions since it has this carrier
    uint32_t part = 0;            // on which its root lies at rest: index into places_; 0 = none
    uint32_t carrier = 0;         // the part, or 0 for the head
    uint64_t frame = 0;
    Vec3 root = Vec3::Zero();  // m, in the carrier's frame, from the newest frame that had the carrier's pose
  };
  /// Sums over the received roots of a part, for the fit of its pose.
  struct RootSums {
    double count = 0;
    Eigen::Matrix<double, 3, 1, Eigen::DontAlign> local = {0, 0, 0}, world = local;
    Eigen::Matrix<double, 3, 3, Eigen::DontAlign> products = Eigen::Matrix3d::Zero();  // of world and local
  };
  void place(const GuideFrame& frame);
  void fitParts(GuideFrame& frame, std::span<const StrandRun> received);
  void chooseCarrier(uint32_t strand, const Vec3& root);
  void attachToHead(uint32_t strand, const HeadFrame& from);
  void extrapolate(uint32_t strand, double time, std::span<Vec3> out) const;

  std::vector<uint32_t> offsets_;
  std::vector<Vec3> roots_;          // per strand, m, at rest
  std::vector<Vec3> last_, before_;  // per vertex, m, in the carrier's frame
  std::vector<Strand> strands_;
  std::vector<uint32_t> parts_;    // ids of colliders
  std::vector<HeadFrame> places_;  // pose of the head, then of the parts, in the newest frame
  std::vector<RootSums> sums_;     // per entry of places_
  ColliderMotion colliders_;
};

}  // namespace strandcast
