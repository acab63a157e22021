// Public API
#pragma once
#include <chrono>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "transport/messages.h"

namespace strandcast {

/// Moves a character whose hair a daemon simulates: its head, its joints, and the bodies that the hair
/// collides with. Made by makeDdsPoseSender() (transport/dds.h), makeLcmPoseSender() (transport/lcm.h) or
/// makeInProcessPoseSender() (transport/in_process.h). Name what moves, then send a sample per frame:
///
///   sender->setNames({"head", "joint:LeftArm"});
///   for (uint64_t frame = 0;; ++frame) sender->send(frame * period, {head, left_arm});
///
/// Motions. Each pose is a motion from rest, x_world = rotation * x_rest + position, in metres: for a joint
/// the engine's skinning matrix (its matrix times its inverse bind matrix). So neither joint axes nor a
/// hierarchy matter. A daemon's bodies have their own frame as rest.
///
/// Names. "head", "joint:NAME" (of the daemon's skinned body), "bone:NAME" (pinned vertices of its groom),
/// "body:NAME" (a collider). A joint without a name here follows its nearest named ancestor rigidly. One
/// sender moves each of them at a time: another one takes over half a second after its last sample.
///
/// Time. Any clock that runs evenly. Stamp samples with the time that they show (frame number times period),
/// not with the time of the call, whose jitter the hair would show. Frames name the newest sample that they
/// contain, by GuideFrame::pose_source and pose_time.
///
/// Not thread-safe.
class PoseSender {
 public:
  virtual ~PoseSender() = default;
  PoseSender(const PoseSender&) = delete;
  PoseSender& operator=(const PoseSender&) = delete;

  /// Names the poses and weights (of morph targets) of all samples that follow. Throws Error on a name that
  /// is empty, occurs twice or has control characters, and beyond kMaxPoseNames, kMaxPoseNameBytes
  /// (separators and escapes included), kMaxWeightNames, kMaxWeightNameBytes.
  void setNames(const std::vector<std::string>& names, const std::vector<std::string>& weight_names = {});
  /// Sends the sample of a time in ns. A pose per name, within 1000 m of the origin, rotations of length 0.5
  /// to 1.5; a weight per weight name, -10 to 10; a scale per name or none, 0.001 to 1000, which applies to
  /// joints. Does not wait for daemons. Throws Error on other numbers, and on a time that is not after the
  /// last sample's, unless cut() was called in between.
  void send(uint64_t time, std::span<const Pose> poses, std::span<const float> weights = {},
            std::span<const Vec3> scales = {});
  /// The motion jumps before the next sample (a teleport, another take), or its clock was set: the hair is
  /// carried to the new pose without being flung.
  void cut();
  /// Random per sender, not 0.
  uint64_t source() const { return message_.source; }

 protected:
  /// `groom_id` 0: every groom that the messages reach. Each message has up to `samples` samples, 1 to
  /// kMaxPoseSamples: more than one where the channel repairs no losses.
  PoseSender(uint32_t groom_id, size_t samples);

 private:
  struct Sample {
    uint64_t time = 0;
    std::vector<float> poses, scales, weights;
  };
  virtual void write(PoseSamples& message) = 0;  // not const: Fast DDS takes no const samples
  /// The message of the newest samples that fit it.
  void fillMessage();

  const size_t samples_;
  std::string names_, weight_names_;
  size_t name_count_ = 0, weight_count_ = 0;
  std::deque<Sample> sent_;  // newest first, of one epoch and one revision of names; at most samples_
  std::optional<uint64_t> last_time_;              // of this epoch
  std::chrono::steady_clock::time_point named_{};  // when the names were last sent
  PoseSamples message_;
};

}  // namespace strandcast
