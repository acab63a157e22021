// Concealment of lost chunks: positions of strands and poses of colliders are extrapolated along their last
// motion.
#pragma once
#include <algorithm>
#include <span>
#include <vector>

#include "transport/chunks.h"
#include "transport/codec/guide_payload.h"
#include "transport/messages.h"

namespace strandcast {

/// Longest time over which the motion of a lost object is extrapolated; then it stays at rest.
inline constexpr double kMaxExtrapolation = 0.1;  // s

/// Factor of the motion from time `before` to time `last` (s) that is added to the last position to estimate
/// the position at `now`. 0 where the motion spans more than kMaxExtrapolation.
inline double extrapolation(double before, double last, double now) {
  const double between = last - before;
  const bool tells = between > 0 && between <= kMaxExtrapolation;
  return tells ? std::clamp(now - last, 0.0, kMaxExtrapolation) / between : 0.0;
}

/// Extrapolates poses of colliders for a frame that lacks them: along their last motion in the world, with
/// their last bends.
class ColliderMotion {
 public:
  void clear();
  /// Forgets how they moved, not where they are.
  void stop() { before_.clear(); }
  /// Records the colliders of a frame; time: simulation time, s.
  void record(std::span<const PlacedCollider> placed, double time);
  /// `out`: all colliders of the last frame that had poses.
  void extrapolate(double time, std::vector<PlacedCollider>& out) const;

 private:
  std::vector<PlacedCollider> last_, before_;
  double last_time_ = 0, before_time_ = 0;  // s
};

/// Estimates positions of lost strands. A strand is extrapolated along its last motion in the frame of its
/// carrier, with its last edge lengths, for as long as extrapolation() says; then it stays at rest in that
/// frame until it is received again. No motion goes across a cut (GuideFrame::continuity). The carrier is the
/// head or the part of a skinned body on which the strand's root lies at rest, whichever predicted the
/// received root better.
class Concealment {
 public:
  /// Resets all motion. `guides`: rest shape, m, groom frame.
  void setGroom(const StrandSet& guides);
  /// Sets the parts of the body of the groom's session. Without them the head carries all strands.
  void setColliders(const ColliderSet& set);
  /// Records the strands of `frame` that are in `received`; runs with strand_count 0 are skipped.
  /// received.front() is the run of chunk 0, which has the poses of colliders: if it is missing, sets
  /// frame.colliders to extrapolated poses.
  void record(GuideFrame& frame, std::span<const StrandRun> received);
  /// Sets the positions of the strands that record() did not get in this frame, and frame.strands_concealed.
  /// False when a strand was never received or a position is not finite.
  bool conceal(GuideFrame& frame);

 private:
  struct Strand {
    double last = 0, before = 0;  // simulation times of the last two receptions, s; valid up to `count`
    uint32_t count = 0;           // receptions since it has this carrier
    uint32_t part = 0;            // on which its root lies at rest: index into places_; 0 = none
    uint32_t carrier = 0;         // the part, or 0 for the head
    uint64_t frame = 0;
    uint32_t continuity = 0;   // of that frame
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
  void extrapolate(uint32_t strand, const GuideFrame& frame, std::span<Vec3> out) const;

  std::vector<uint32_t> offsets_;
  std::vector<Vec3> roots_;          // per strand, m, at rest
  std::vector<Vec3> last_, before_;  // per vertex, m, in the carrier's frame
  std::vector<Strand> strands_;
  std::vector<uint32_t> parts_;    // ids of colliders
  std::vector<HeadFrame> places_;  // pose of the head, then of the parts, in the newest frame
  std::vector<RootSums> sums_;     // per entry of places_
  ColliderMotion colliders_;
  uint32_t continuity_ = 0;  // of colliders_
};

}  // namespace strandcast
