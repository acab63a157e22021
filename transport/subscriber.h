// Public API
#pragma once
#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "transport/messages.h"

namespace strandcast {

/// Counts since the subscriber was made.
struct ReceiveStatistics {
  uint64_t frames_received = 0;  ///< complete frames, concealed ones included
  /// Frame numbers between the first and the newest complete frame of each session and revision that never
  /// became complete: gaps in the numbering, and frames still incomplete when a newer one was completed.
  /// Frames that the renderer did not take in time do not count, nor do those of a jump of more than 4096
  /// frames.
  uint64_t frames_lost = 0;
  /// frames_concealed: received frames with lost strands whose positions were extrapolated.
  /// strands_concealed: the sum of these strands over all frames. Both stay 0 over links that repair losses
  /// (all but LCM and DdsProfile::kBestEffort).
  uint64_t frames_concealed = 0, strands_concealed = 0;
  /// Chunks that are malformed, of another session or revision, or of a frame number out of sequence.
  uint64_t chunks_rejected = 0;
  /// Well-formed chunks that refer to a key frame that is missing here (--codec temporal): one from before
  /// this reader joined, or one that was lost.
  uint64_t chunks_without_key = 0;
  uint64_t payload_bytes = 0;  ///< of the frames received; 0 in-process, where nothing is encoded
  /// Latency from publication to completion over the last 1,000 frames, by the system clocks of both
  /// machines: it includes the offset between the clocks.
  double latency_ms_p50 = 0, latency_ms_p99 = 0;
};

inline constexpr size_t kFrameQueueLength = 8;  ///< frames that a subscriber keeps by default

/// The renderer's end of a channel, made by makeDdsSubscriber() (transport/dds.h), makeLcmSubscriber()
/// (transport/lcm.h) or makeInProcessChannel() (transport/in_process.h). It is the only interface that a
/// renderer needs; docs/client.md shows a whole reader. It receives in its own thread. Every call is
/// thread-safe.
///
/// When the daemon ends, only status() changes: groom() and frame() keep their last values.
class Subscriber {
 public:
  virtual ~Subscriber() = default;
  /// The newest description, or null while none is complete. The pointer changes when the daemon or its groom
  /// changes.
  virtual std::shared_ptr<const GroomDescription> groom() const = 0;
  /// The body that was announced with groom(), or null while it is incomplete.
  virtual std::shared_ptr<const BodyDescription> body() const = 0;
  /// The hairs that follow the guides of groom(), or null: it has none, or they are incomplete.
  virtual std::shared_ptr<const HairDescription> hairs() const = 0;
  /// The newest colliders of groom(), or null while they are incomplete. The pointer changes when they
  /// change.
  virtual std::shared_ptr<const ColliderSet> colliders() const = 0;
  /// The newest complete frame that fits groom(), or null.
  virtual std::shared_ptr<const GuideFrame> frame() const = 0;
  /// Sets how many of the newest frames are kept, at least 1; the default is kFrameQueueLength. A reader that
  /// wants every frame and may stall for longer (a recording) raises it. Each frame costs 12 B a vertex.
  virtual void keepFrames(size_t count) = 0;
  /// Returns the OLDEST kept frame that is newer than `after`, and waits when there is none yet; null on
  /// timeout. 0 accepts any frame. A reader that passes the number of its last frame gets every frame in
  /// order while it lags by fewer frames than are kept; otherwise it skips the oldest. Frame numbers start
  /// again with each session (each start of the daemon). An `after` beyond the newest frame therefore belongs
  /// to an earlier session and counts as 0; one within range cannot be told from this session's. A reader
  /// that continues across sessions uses waitForNext().
  virtual std::shared_ptr<const GuideFrame> waitForFrame(uint64_t after,
                                                         std::chrono::milliseconds timeout) = 0;
  /// As waitForFrame(), after the frame `last`. Null, or a frame of another session, stands for 0.
  virtual std::shared_ptr<const GuideFrame> waitForNext(const GuideFrame* last,
                                                        std::chrono::milliseconds timeout) = 0;
  /// Waits for groom and body of one session and revision and, where the groom's growth has kHairs, for its
  /// hairs; false on timeout.
  virtual bool waitForGroom(std::chrono::milliseconds timeout) = 0;
  /// Newest status of this subscriber's groom; `strands` is 0 until its daemon casts. Empty before the first
  /// status, and after the daemon has ended: at once when it says so (DDS), else after 3 s of silence.
  virtual std::optional<Status> status() const = 0;
  /// Newest status of every live daemon on the network.
  virtual std::vector<Status> allStatuses() const = 0;
  /// Whether this program may send commands (DDS, profile `secure`) and has a daemon to send them to: false
  /// for readers of an LCM log file.
  virtual bool mayCommand() const { return true; }
  /// Sends a command to the daemon of groom `command.groom_id`, which must be this subscriber's groom or 0,
  /// which stands for it. Blocks until the daemon's machine has received it (over LCM: until it is sent), and
  /// until the daemon's answer can be received. The command may be lost, and the daemon may end before it
  /// executes it: ask() repeats it until it is answered. Throws Error when no daemon of that groom is found
  /// within 2 s (12 s with keys; longer with profile `local`, which may fall back to UDP meanwhile) or before
  /// `gives_up` returns true (it is polled); when `id` is 0; when the command exceeds the wire's limits; or
  /// when mayCommand() is false.
  virtual void send(const Command& command, const std::function<bool()>& gives_up = {}) = 0;
  /// The daemon's answer to the command of this id: an empty text when it was executed, the reason when it
  /// was refused, nothing on timeout. The newest 256 answers are kept, also after the daemon has ended.
  virtual std::optional<std::string> waitForAnswer(uint64_t command, std::chrono::milliseconds timeout) = 0;
  virtual ReceiveStatistics statistics() const = 0;
  /// Tells the daemon what the pictures need, so that it may save work where hair is small. `pixels`:
  /// diameter of the hair's bounding sphere in the largest picture, at most 1e6; 0: in no picture, and no
  /// shadow of it in one; -1, the default: unknown. `rate`: pictures per second; 0: unknown.
  virtual void setPictures(float /*pixels*/, float /*rate*/) {}
  /// A daemon of another version of the wire that casts this subscriber's groom, if one is known.
  virtual std::optional<OtherVersion> otherVersion() const { return std::nullopt; }
};

/// Sends the command every half second until the daemon has answered; the daemon executes it once, however
/// often it arrives. Returns the answer as waitForAnswer() does. Soon after `gives_up` returns true, it
/// returns nothing or rethrows the Error of the last send. Throws Error at once on a command that exceeds the
/// wire's limits.
std::optional<std::string> ask(Subscriber& subscriber, const Command& command,
                               const std::function<bool()>& gives_up);

/// Which received frame a picture shows.
enum class Playout {
  kLatest,  ///< the newest frame: least delay, but uneven motion where frames arrive unevenly
  kSmooth,  ///< interpolated between two frames, one frame behind: even motion at any picture rate
  kExact    ///< each frame once, in order: for pictures that are stored
};

/// Counts since the player was made, and its present delay.
struct PlayoutStatistics {
  uint64_t pictures = 0;  ///< calls that returned a frame
  uint64_t repeated = 0;  ///< calls that had no newer frame than the call before
  double delay_ms = 0;   ///< kSmooth: from the arrival of a frame without jitter to the picture that shows it
  double jitter_ms = 0;  ///< kSmooth: 95th percentile of the delay of frames relative to the fastest
};

/// Moves hair that was simulated on one head pose rigidly to a newer one ("late latching"). A renderer that
/// tracks the head itself then shows no latency of the head, only of the sway of the hair. Not for hair whose
/// roots lie on a skinned body: its roots do not move with the head alone.
void moveToHead(GuideFrame& frame, const Pose& head);
/// Interpolates two frames of one revision at a time between theirs. Positions are interpolated linearly in
/// the head's frame, the head and colliders by pose. All other fields are those of the later frame.
void interpolateFrames(const GuideFrame& a, const GuideFrame& b, double time, GuideFrame& out);

/// Picks frames for the pictures of a renderer. Not thread-safe. `subscriber` must outlive it.
class FramePlayer {
 public:
  FramePlayer(Subscriber& subscriber, Playout playout);
  ~FramePlayer();
  FramePlayer(const FramePlayer&) = delete;
  FramePlayer& operator=(const FramePlayer&) = delete;

  /// The frame for a picture that is drawn now, moved to the pose `head` if given. Null while there is none
  /// (kExact: no further one). Never waits. `now` is of the steady clock.
  ///
  /// kSmooth estimates the offset between this machine's clock and simulation time as the least that about
  /// the last second of arrivals shows. It plays one frame interval plus the jitter (at most a second
  /// interval) behind it, and interpolates by interpolateFrames(). Where no new frames arrive, it stays on
  /// the newest; before a cut (GuideFrame::continuity), on the frame before it.
  std::shared_ptr<const GuideFrame> next(
      const std::optional<Pose>& head = std::nullopt,
      std::chrono::steady_clock::time_point now = std::chrono::steady_clock::now());
  PlayoutStatistics statistics() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace strandcast
