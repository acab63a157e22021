#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/strand_model.h"
#include "transport/chunks.h"

namespace strandcast {

/// The state that a daemon which casts a shared groom sends to its standbys (DdsOptions::claim), so that each
/// of them can take over: docs/wire.md, "ShowChunk".

/// Numbers on the wire: docs/wire.md, "ShowChunk", has the name and the values of each kind.
enum class ShowKind : uint32_t {
  kFingerprint = 0,
  kParameter = 1,
  kWindSource = 2,
  kWindRamp = 3,
  kCollider = 4,
  kColliderFile = 5,
  kSceneCollider = 6,
  kColliderMotion = 7,
  kHead = 8,
  kPaused = 9,
  kSteps = 10,
  kPull = 11,
  kResets = 12,
  kAnswered = 13,
  kPoseSource = 14,
  kHeldPose = 15
};
inline constexpr uint32_t kShowKinds = 16;

/// The present state of one thing that commands steer.
struct ShowEntry {
  ShowKind kind = ShowKind::kParameter;
  std::string name;            ///< at most kMaxTextBytes
  std::vector<double> values;  ///< at most kMaxShowValues, finite

  bool operator==(const ShowEntry&) const = default;
};

/// A snapshot of the casting daemon's state.
struct Show {
  uint64_t session = 0;        ///< of the daemon that casts
  uint32_t revision = 0;       ///< counts up within a session
  double simulation_time = 0;  ///< s
  std::vector<ShowEntry> entries;
  /// World, m; as Simulation::state(). Without positions the show has no hair.
  StrandState hair;

  bool hasHair() const { return !hair.positions.empty(); }
};

inline constexpr size_t kMaxShowValues = 64, kMaxShowEntries = 8192;

/// A part of a Show's bytes. Shows with hair and shows without are different parts: a chunk replaces only
/// chunks of its part.
struct ShowChunk {
  enum Part : uint32_t { kState = 0, kStateAndHair = 1 };
  uint64_t session = 0;
  uint32_t groom_id = 0, part = kState, chunk_index = 0, chunk_count = 0, revision = 0;
  std::vector<uint8_t> payload;
};

/// The payload bytes of all chunks of a show, concatenated.
std::vector<uint8_t> showBytes(const Show& show);
/// Inverse of showBytes(), without session and revision; nothing where the bytes are no valid show.
std::optional<Show> showOf(std::span<const uint8_t> bytes);

/// Empty where the show would take more than kMaxChunks chunks.
std::vector<ShowChunk> splitShow(const Show& show, uint32_t groom_id);

/// Assembles shows of one part from chunks in any order. Not thread-safe.
class ShowAssembler {
 public:
  ShowAssembler(uint32_t groom_id, ShowChunk::Part part) : groom_id_(groom_id), part_(part) {}
  /// The show that this chunk completed, or nothing.
  std::optional<Show> add(ShowChunk&& chunk);
  uint64_t chunksRejected() const { return chunks_rejected_; }

 private:
  const uint32_t groom_id_;
  const ShowChunk::Part part_;
  std::map<uint32_t, ShowChunk> chunks_;  // of the newest revision of one session
  uint64_t chunks_rejected_ = 0;
};

}  // namespace strandcast
