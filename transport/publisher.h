#pragma once
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "transport/guide_source.h"
#include "transport/messages.h"
#include "transport/show.h"

namespace strandcast {

/// How long a new daemon listens for the status of a rival where a participant is present that may be one. Of
/// 500 starts half heard it within 35 ms, 99 % within 1 s, and the slowest after 1.1 s.
inline constexpr std::chrono::milliseconds kConflictListenTime{3000};
/// How long it listens where no such participant has been discovered.
inline constexpr std::chrono::milliseconds kShortListenTime{400};
/// Over LCM: every daemon sends its status twice a second and answers the status of one that starts.
inline constexpr std::chrono::milliseconds kLcmListenTime{700};
/// With keys: Fast DDS 2.9.1 repeats a lost handshake message only after a second. Of 25 starts on a busy
/// machine 19 heard the status within 0.7 s, and 6 after 1.3 to 1.5 s. This bound covers three losses in a
/// row.
inline constexpr std::chrono::milliseconds kSecureConflictListenTime{4500};

/// Period of the status of a daemon or a replay.
inline constexpr double kStatusInterval = 0.5;  // s

/// Factor of the listen time for daemons that share a groom: a participant that is heard may still turn out
/// to share it.
inline constexpr int kSharedListenFactor = 2;

/// Another live daemon of the same groom id.
struct ConflictingDaemon {
  uint64_t session = 0;
  bool casts = false;   ///< casts, or is about to: its status has strands
  uint64_t frames = 0;  ///< published so far

  static ConflictingDaemon of(const Status& status) {
    return {status.session, status.strands > 0, status.frames};
  }
  bool operator==(const ConflictingDaemon&) const = default;
};

/// The poses that live sources gave to a step.
struct StepPoses {
  uint64_t step = 0;    ///< steps of the simulation before it
  bool is_cut = false;  ///< the motion jumps: Simulation::jumpToPoses()
  /// One sample, as taken: all that was posed, with its names. `source` and `time`: of the newest sample in
  /// it.
  PoseSamples poses;
};

/// What the readers of a groom reported.
struct ReaderSummary {
  /// Diameter of the hair's bounding sphere in the largest picture of all readers; 0: in no picture; -1: some
  /// reader did not tell, or none reports
  float largest_pixels = -1;
  uint64_t frames_lost = 0;  ///< sum over the present readers, since the start of each
};

/// Among daemons that share a groom: which one casts.
enum class CastingState {
  kUnshared,   ///< the daemon does not share its groom
  kUnknown,    ///< others are present that may cast and have not been heard yet
  kUnclaimed,  ///< no daemon claims the groom
  kOther,      ///< another daemon casts
  kOwn         ///< this daemon casts
};

/// The daemon's end of a channel. Not thread-safe.
class Publisher {
 public:
  virtual ~Publisher() = default;
  /// Describes the groom and its body to all present and later readers. Precondition of publish(); call
  /// again, with a higher revision, when the topology changes. The channel sets `groom_id`, the body's
  /// revision and, over DDS, `session`. Throws Error on what a receiver would refuse: no strands, counts that
  /// do not match, non-finite numbers, a strand of more than kMaxWireVertices vertices.
  virtual void announce(const GroomDescription& groom, const BodyDescription& body) = 0;
  /// Describes hairs that follow the guides of the groom announced last to all present and later readers,
  /// until the next announce(). Readers wait for them where the groom's growth has kHairs. The channel sets
  /// `groom_id`, `revision` and `session`. Decoded positions are within CodecOptions::hair_error. Throws
  /// Error as checkHairs() and encodeHairs() (transport/codec/hair_codec.h), and where no groom was
  /// announced.
  virtual void announceHairs(const HairDescription&) {}
  /// Describes the colliders to all present and later readers. Call again, with a higher revision, when they
  /// change. Poses of colliders that do not follow the head are in the frames. The channel sets `groom_id`
  /// and, over DDS and LCM, `session`. Throws Error on what a receiver would refuse: invalid shapes, two
  /// colliders of one id, more than kMaxColliderShapes shapes.
  virtual void announceColliders(const ColliderSet& colliders) = 0;
  /// Neither blocks on slow readers nor throws. Precondition: `frame` fits the groom last announced; with
  /// another vertex count or revision nothing is sent. The channel sets its `groom_id` and, over DDS,
  /// `session`.
  virtual void publish(const GuideFrame& frame) = 0;
  /// As publish(), with `guides` in place of frame.positions, which it may fill. Throws what `guides` throws.
  virtual void publishFrom(GuideFrame& frame, GuideSource& guides) {
    copyGuides(guides, frame);
    publish(frame);
  }
  /// The destructor waits up to a second for live readers that lack the last status: it may hold the answer
  /// to the command that ended the daemon.
  virtual void publishStatus(const Status& status) = 0;
  /// The next command for this groom, in the order of arrival; a repeated one is returned once. Up to
  /// kMaxQueuedCommands wait; beyond that the oldest are dropped.
  virtual std::optional<Command> takeCommand() = 0;
  /// The next poses for this groom, in the order of arrival, with their time of arrival: sound, but from any
  /// source, late ones and repeated samples included. Up to kMaxQueuedPoses messages wait; beyond that the
  /// oldest are dropped.
  virtual std::optional<PoseSamples> takePoses() { return std::nullopt; }
  /// Records the poses of a step before the step is taken.
  virtual void recordPoses(const StepPoses&) {}
  /// Number of readers of the guides: matched (DDS), or heard within 3 s (LCM).
  virtual uint32_t matchedReaders() const = 0;
  virtual ReaderSummary readers() const { return {}; }
  /// Size and error of the newest frame as encoded; empty in-process, where nothing is encoded.
  virtual EncodingReport encoding() const = 0;
  /// A rival, if one was heard. Of several, one that casts; else the one of the lowest session. A publisher
  /// sends its session from its creation on. Ask repeatedly for listenTime(), before announce(), which would
  /// take the readers over. Two daemons started at once hear each other: the one with the higher session must
  /// end, and the other waits until it has ended. A rival that was killed is never heard by a daemon started
  /// after its end; one that ran before forgets it after its lease of 3 s. In-process: always empty.
  virtual std::optional<ConflictingDaemon> conflict() const = 0;
  /// How long after its creation a rival may still be heard for the first time, as known now. Over DDS:
  /// kShortListenTime where no participant is present that may be a rival, and no discovery server is used.
  /// Else kConflictListenTime (with keys kSecureConflictListenTime), kSharedListenFactor times as long where
  /// the groom is shared. With profile `local`, 3.9 s where a daemon of the groom is known and none of its
  /// writers. Over LCM: kLcmListenTime. In-process: 0.
  virtual std::chrono::milliseconds listenTime() const { return std::chrono::milliseconds(0); }
  /// Number of participants that may be rivals (DDS): daemons of the groom, without those that share it where
  /// this one does, and participants without a role. Otherwise 0.
  virtual size_t possibleConflicts() const { return 0; }
  /// For a daemon that shares its groom: which daemon casts. What this one publishes is sent only while it
  /// holds the claim. Its first frame is its claim: by then it has taken the show, or there is none.
  virtual CastingState castingState() const { return CastingState::kUnshared; }
  /// For a daemon that shares its groom: true, once, after it stood still so long (a suspended machine, a
  /// debugger, a hung GPU) that another daemon took the claim. It sends nothing from then on. It joins as a
  /// standby and must take the show before it publishes again.
  virtual bool pollClaimLoss() { return false; }
  /// For a daemon that shares its groom and has published no frame: whether the daemon that casts claims it
  /// with the same strength. That one came first, and this one must publish no frame as long as that one
  /// casts.
  virtual bool yields() const { return false; }
  /// For a daemon that shares its groom, while another one casts: withdraws its claim until it publishes
  /// again.
  virtual void withdrawClaim() {}
  /// Whether a daemon of this groom has been known for longer than discovery of its writers takes, and none
  /// was discovered: for example through shared memory of another user (DDS, profile `local`).
  virtual bool hasUnreachableDaemonOfGroom() const { return false; }
  /// Number of other daemons that share the groom.
  virtual size_t sharers() const { return 0; }
  /// Whether a daemon has joined since the last show with hair.
  virtual bool wantsHair() const { return false; }
  /// While this daemon casts: sends the show to the standbys. The channel sets `session` and `revision`. Hair
  /// is sent in parts with the frames that follow.
  virtual void publishShow(const Show&) {}
  /// The newest show of the daemon that casts, each once: first the newest with hair, then the newest
  /// without.
  virtual std::optional<Show> takeShow() { return std::nullopt; }
  /// A program of another version of the wire that wants this groom, if one is known.
  virtual std::optional<OtherVersion> otherVersion() const { return std::nullopt; }
  /// Why published data could not be written to an LCM log; empty while nothing failed. The failure was
  /// logged once.
  virtual std::string failure() const { return {}; }
};

}  // namespace strandcast
