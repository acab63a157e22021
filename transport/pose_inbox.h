// Poses from other programs: names and checks of their messages, and the queue from which a daemon takes
// them.
#pragma once
#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "transport/messages.h"

namespace strandcast {

enum class PosedKind {
  kHead,   ///< "head": the motion of the head and of all that follows it
  kJoint,  ///< "joint:NAME", of a skinned body
  kBone,   ///< "bone:NAME": pinned vertices of the groom
  kBody,   ///< "body:NAME": a collider
  kOther   ///< of a later version; receivers ignore it
};

/// What one pose of a message moves.
struct PosedName {
  PosedKind kind = PosedKind::kOther;
  std::string name;  ///< unescaped, without the kind; empty for kHead
  bool operator==(const PosedName&) const = default;
};

/// The names of a sound message, in the order of its poses.
std::vector<PosedName> posedNames(const PoseSamples& samples);
/// Those of its weights, unescaped.
std::vector<std::string> weightNames(const PoseSamples& samples);

/// Numbers of one sample; 0 poses where the message has none.
inline size_t posesPerSample(const PoseSamples& samples) {
  return samples.ages.empty() ? 0 : samples.poses.size() / (7 * samples.ages.size());
}
inline size_t weightsPerSample(const PoseSamples& samples) {
  return samples.ages.empty() ? 0 : samples.weights.size() / samples.ages.size();
}

inline constexpr float kFarthestPosed = 1000;                   ///< m, on each axis
inline constexpr float kLeastScale = 1e-3f, kMostScale = 1e3f;  ///< of a joint
inline constexpr float kMostWeight = 10;                        ///< on the magnitude

/// Whether a message can be used: a source, 1 to 16 samples whose ages start at 0 and ascend, arrays of
/// fitting lengths, names that are distinct and as many as the poses and weights (or both lists empty), all
/// numbers in range, at most kMaxChunkBytes in all. Quaternions of length 0.5 to 1.5 are sound.
bool isSound(const PoseSamples& samples);

inline constexpr size_t kMaxQueuedPoses = 256;

/// Messages that a daemon has yet to take, in the order of arrival. Thread-safe.
class PoseInbox {
 public:
  /// Takes messages for `groom_id` and for 0.
  explicit PoseInbox(uint32_t groom_id) : groom_id_(groom_id) {}
  /// Called by the receiving thread: sets the arrival time, normalises the rotations and appends the message.
  /// Beyond kMaxQueuedPoses the oldest are dropped. False on one that is not sound or for another groom.
  bool push(PoseSamples samples);
  /// The oldest message, or nothing.
  std::optional<PoseSamples> take();

 private:
  const uint32_t groom_id_;
  std::mutex mutex_;
  std::deque<PoseSamples> waiting_;
};

}  // namespace strandcast
