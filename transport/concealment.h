#pragma once
#include <span>
#include <vector>

#include "transport/chunks.h"
#include "transport/codec/guide_payload.h"
#include "transport/collider_motion.h"
#include "transport/messages.h"

namespace strandcast {

/// Where lost strands probably are: carried on along their last motion relative to what carries them, at
/// their last edge lengths, as long as carriedOn() says; then they stand still on it until they are received
/// again. The head carries a strand, or else the part of a skinned body on which its root lies at rest: which
/// of the two had the root nearer to where it was received.
class Concealment {
 public:
  void setGroom(const StrandSet& guides);
  /// Of the groom's session: the parts of its body. Without them the head carries all.
  void setColliders(const ColliderSet& set);
  /// Takes note of the strands of `frame` in `received`, by their runs; those with strand_count 0 are
  /// skipped. The first run is of the chunk that tells where colliders are: without it, sets
  /// frame.colliders to where they probably are.
  void learn(GuideFrame& frame, std::span<const StrandRun> received);
  /// Fills in the strands that learn() was not told of in this frame. False when it cannot be said where one
  /// of them is: it was never received, or numbers are out of all bounds. Sets frame.strands_concealed.
  bool conceal(GuideFrame& frame);

 private:
  struct Strand {
    double last = 0, before = 0;  // s of simulation time; of a strand received `count` times
    uint32_t count = 0;           // since it has this carrier
    uint32_t part = 0;            // that its root lies on at rest: of places_; 0 = none
    uint32_t carrier = 0;         // that part, or the head, 0
    uint64_t frame = 0;
    Vec3 root = Vec3::Zero();  // m, in the carrier's frame, when a frame last told where that is
  };
  /// Of roots that a part carries: what its pose follows from.
  struct RootSums {
    double count = 0;
    Eigen::Matrix<double, 3, 1, Eigen::DontAlign> local = {0, 0, 0}, world = local;
    Eigen::Matrix<double, 3, 3, Eigen::DontAlign> products = Eigen::Matrix3d::Zero();  // of world and local
  };
  void place(const GuideFrame& frame);
  void fitParts(GuideFrame& frame, std::span<const StrandRun> received);
  void chooseCarrier(uint32_t strand, const Vec3& root);
  void hangOnHead(uint32_t strand, const HeadFrame& from);
  void extrapolate(uint32_t strand, double time, std::span<Vec3> out) const;

  std::vector<uint32_t> offsets_;
  std::vector<Vec3> roots_;          // per strand, m, at rest
  std::vector<Vec3> last_, before_;  // per vertex, m, in the carrier's frame
  std::vector<Strand> strands_;
  std::vector<uint32_t> parts_;    // ids of colliders
  std::vector<HeadFrame> places_;  // of the head, then of the parts, in the newest frame
  std::vector<RootSums> sums_;     // per place
  ColliderMotion colliders_;
};

}  // namespace strandcast
