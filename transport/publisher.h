#pragma once
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "transport/messages.h"
#include "transport/show.h"

namespace strandcast {

/// How long a new daemon listens for the status of a rival where programs are there that may be one. Of 500
/// starts, half heard it within 35 ms, 99 % within 1 s, and the slowest after 1.1 s.
inline constexpr std::chrono::milliseconds kRivalListenTime{3000};
/// How long it listens where no such program has shown itself.
inline constexpr std::chrono::milliseconds kQuietListenTime{400};
/// Over LCM, where every daemon tells its status twice a second and answers that of one that starts.
inline constexpr std::chrono::milliseconds kLcmListenTime{700};
/// With keys: Fast DDS 2.9.1 repeats a message of a handshake that was lost only after a second. Of 25 starts
/// on a busy machine 19 heard it within 0.7 s, 6 after 1.3 to 1.5 s; four losses in a row would be needed.
inline constexpr std::chrono::milliseconds kSecureRivalListenTime{4500};

/// How often a daemon, or a replay, tells its status.
inline constexpr double kStatusInterval = 0.5;  // s

/// Daemons that share a groom listen so many times as long: who is heard may yet turn out to share it too.
inline constexpr int kSharedListens = 2;

/// Another live daemon of the same groom id.
struct Rival {
  uint64_t session = 0;
  bool casts = false;   ///< or is about to: it has told what it simulates
  uint64_t frames = 0;  ///< that it has cast

  static Rival of(const Status& status) { return {status.session, status.strands > 0, status.frames}; }
  bool operator==(const Rival&) const = default;
};

/// Of daemons that share a groom: whose turn it is to cast.
enum class SharedTurn {
  kUnshared,  ///< the daemon does not share its groom
  kUnknown,   ///< others are there that may cast and were not heard yet
  kNobodys,
  kAnothers,
  kOwn
};

/// The daemon's end of a channel. One thread at a time.
class Publisher {
 public:
  virtual ~Publisher() = default;
  /// Describes the groom and its body to everyone, now and later. Call before publish(); again, with a higher
  /// revision, when the topology changes. `groom_id`, the body's revision and, over DDS, `session` are filled
  /// in by the channel. Throws Error on what a receiver would refuse: no strands, counts that do not fit,
  /// non-finite numbers, a strand of more than kMaxWireVertices vertices.
  virtual void announce(const GroomDescription& groom, const BodyDescription& body) = 0;
  /// Tells everyone, now and later, what hair collides with; again, with a higher revision, when that
  /// changes. Where colliders are that do not follow the head is in the frames. `groom_id` and, over DDS and
  /// LCM, `session` are filled in by the channel. Throws Error on what a receiver would refuse: shapes that
  /// are not sound, two colliders of one id, more than kMaxColliderShapes shapes.
  virtual void announceColliders(const ColliderSet& colliders) = 0;
  /// Neither blocks on slow readers nor throws. `frame` fits the groom last announced (another vertex count
  /// or revision is the program's own fault: nothing is sent then); its `groom_id` and, over DDS, `session`
  /// are filled in by the channel.
  virtual void publish(const GuideFrame& frame) = 0;
  /// The end of a publisher waits a second for live readers that lack the last status: it may hold the answer
  /// to the command that ended it.
  virtual void publishStatus(const Status& status) = 0;
  /// The next command for this groom, in the order of arrival; one that was sent twice comes once. Up to
  /// kMaxQueuedCommands wait; beyond that the oldest go.
  virtual std::optional<Command> takeCommand() = 0;
  virtual uint32_t matchedReaders() const = 0;
  /// What became of the newest frame on the wire; in-process nothing is encoded.
  virtual EncodingReport encoding() const = 0;
  /// The rival, if one was heard; of several one that casts, else the one of the lowest session. A
  /// publisher names itself from its creation on; ask again for listenTime() and before announce(), which
  /// would take the readers over. Two daemons started at once hear each other: let the one with the higher
  /// session give way, and the other wait until it has gone. A rival that was killed is never heard by a
  /// daemon started after its end, and is forgotten after its lease of 3 s by one that ran before.
  /// In-process: always empty.
  virtual std::optional<Rival> rival() const = 0;
  /// How long after its creation a rival may still be heard for the first time, as far as is known now: over
  /// DDS kQuietListenTime where no program is there that may be one, else kRivalListenTime (with keys
  /// kSecureRivalListenTime; kSharedListens times as long where the groom is shared); over LCM
  /// kLcmListenTime. None in-process.
  virtual std::chrono::milliseconds listenTime() const { return std::chrono::milliseconds(0); }
  /// How many programs are there that may be rivals and have not said so.
  virtual size_t possibleRivals() const { return 0; }
  /// Of a daemon that shares its groom: whose turn it is. What it publishes is cast on its own turn alone,
  /// and its first frame is its claim: it has the show by then, or there is none.
  virtual SharedTurn sharedTurn() const { return SharedTurn::kUnshared; }
  /// Of a daemon that shares its groom: true, once, where it stood still for so long (a suspended machine, a
  /// debugger, a GPU that hangs) that another has taken its turn. From then on it is silent; it joins anew
  /// and has to take the show before it publishes again.
  virtual bool lapsed() { return false; }
  /// Of a daemon that shares its groom and has published no frame: whether the one that casts claims it with
  /// the same strength. It came first, and this one is to publish none as long as that one casts.
  virtual bool yields() const { return false; }
  /// Of a daemon that shares its groom, while another one casts: it claims nothing from now on, until it
  /// publishes again.
  virtual void leaveTurn() {}
  /// Whether a daemon of this groom has been there for longer than its writers take to be found, and nothing
  /// comes from it, as through shared memory where it runs as another user (DDS, profile `local`).
  virtual bool isDeaf() const { return false; }
  /// How many others share the groom.
  virtual size_t sharers() const { return 0; }
  /// Whether others have joined since the last show with hair.
  virtual bool wantsHair() const { return false; }
  /// On this daemon's turn: tells the others the show. `session` and `revision` are filled in by the channel.
  /// Hair is sent by and by with the frames that follow.
  virtual void publishShow(const Show&) {}
  /// The newest show of the daemon whose turn it is, with hair and then without, each once.
  virtual std::optional<Show> takeShow() { return std::nullopt; }
  /// Why what was published is not kept where it was to be, in an LCM log; empty where nothing went wrong. It
  /// was logged, once.
  virtual std::string failure() const { return {}; }
};

}  // namespace strandcast
