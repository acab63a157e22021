#pragma once
#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "transport/messages.h"

namespace strandcast {

struct ReceiveStatistics {
  uint64_t frames_received = 0;  ///< complete frames, concealed ones among them
  /// Frame numbers from the first to the newest complete frame of each session and revision that never became
  /// complete: gaps in the count, and frames left incomplete when a newer one was completed. Frames that the
  /// renderer did not look at in time are not lost, nor are those of a leap by more than 4096 frames.
  uint64_t frames_lost = 0;
  /// Of the frames received: those with strands that were lost and are put where they probably are, and these
  /// strands, added up. Only over links that do not repair losses (LCM).
  uint64_t frames_concealed = 0, strands_concealed = 0;
  uint64_t chunks_rejected = 0;  ///< damaged, of another session or revision, or of a frame far off
  /// Sound chunks that refer to a key frame that is not here (--codec temporal): from before this reader
  /// joined, or behind a key frame that it lost.
  uint64_t chunks_without_key = 0;
  uint64_t payload_bytes = 0;  ///< of the frames received; 0 in-process, where nothing is encoded
  /// Publish to complete, over the last 1,000 frames, by the system clocks of both machines: their difference
  /// is in it.
  double latency_ms_p50 = 0, latency_ms_p99 = 0;
};

inline constexpr size_t kFrameQueueLength = 8;

/// The renderer's end of a channel: the one thing a renderer programmer needs, made by makeDdsSubscriber()
/// (transport/dds.h), makeLcmSubscriber() (transport/lcm.h) or makeInProcessChannel()
/// (transport/in_process.h). docs/client.md has a whole reader. Receives in its own thread; every call is
/// thread-safe.
///
/// A daemon that has gone is told by status() alone: groom() and frame() stay what they were.
class Subscriber {
 public:
  virtual ~Subscriber() = default;
  /// The newest description, or null while none is complete. The pointer changes when the daemon or its groom
  /// does.
  virtual std::shared_ptr<const GroomDescription> groom() const = 0;
  /// The body that was announced with groom(), or null while it is not complete.
  virtual std::shared_ptr<const BodyDescription> body() const = 0;
  /// What the hair of groom() collides with, newest, or null while it is not complete. The pointer changes
  /// when that does.
  virtual std::shared_ptr<const ColliderSet> colliders() const = 0;
  /// The newest complete frame that fits groom(), or null.
  virtual std::shared_ptr<const GuideFrame> frame() const = 0;
  /// How many of the newest frames are kept, at least 1; kFrameQueueLength unless a reader may be held up for
  /// longer and wants every frame (a recording). Each costs 12 B a vertex.
  virtual void keepFrames(size_t count) = 0;
  /// The OLDEST of the frames kept that is newer than `after`, waiting for one when there is none yet; null
  /// on timeout. 0 takes any. A reader that passes the number of the frame it got last sees every frame in
  /// order while it is fewer frames behind than are kept, and skips the oldest when it is not. Frame numbers
  /// start again with a session, that is when a daemon is started anew: an `after` beyond the newest frame is
  /// of an earlier session and counts as 0, but one that is not cannot be told from this session's. Who reads
  /// on through that uses waitForNext().
  virtual std::shared_ptr<const GuideFrame> waitForFrame(uint64_t after,
                                                         std::chrono::milliseconds timeout) = 0;
  /// The same after the frame `last`; null, or a frame of another session, stands for none.
  virtual std::shared_ptr<const GuideFrame> waitForNext(const GuideFrame* last,
                                                        std::chrono::milliseconds timeout) = 0;
  /// Waits for groom and body, of one session and revision; false on timeout.
  virtual bool waitForGroom(std::chrono::milliseconds timeout) = 0;
  /// Newest status of this subscriber's groom; `strands` is 0 while its daemon does not cast yet. None before
  /// the first, and once its daemon is gone: at once when it says so (DDS), else after 3 s of silence.
  virtual std::optional<Status> status() const = 0;
  /// Newest status of every live daemon on the network.
  virtual std::vector<Status> allStatuses() const = 0;
  /// Whether this program is permitted to (DDS, profile `secure`), and commands go anywhere: from readers of
  /// a log file (LCM) they do not.
  virtual bool mayCommand() const { return true; }
  /// Sends a command to the daemon of `command.groom_id` 's groom, which is this subscriber's (0 stands for
  /// it). Blocks until the daemon's machine has it (over LCM: until it is sent), and the daemon's answer can
  /// be heard. The command may be lost, and the daemon may end before it obeys: ask() sends until there is an
  /// answer. Throws Error when no daemon of that groom answers within 2 s (6 s with keys), or until
  /// `gives_up` where there is one, which is asked again and again; when `id` is 0, when the command is
  /// longer than the wire takes, or without mayCommand().
  virtual void send(const Command& command, const std::function<bool()>& gives_up = {}) = 0;
  /// The daemon's answer to the command of this id: empty text when it was carried out, the reason when it
  /// was refused, nothing on timeout. The newest 256 answers are kept, also when the daemon has ended.
  virtual std::optional<std::string> waitForAnswer(uint64_t command, std::chrono::milliseconds timeout) = 0;
  virtual ReceiveStatistics statistics() const = 0;
};

/// Sends the command, again every half second, until the daemon has answered; however often it comes, a
/// daemon obeys it once. Its answer as of waitForAnswer(); nothing, or the Error of the last send, soon after
/// `gives_up` is true. Throws Error at once on a command that the wire does not take.
std::optional<std::string> ask(Subscriber& subscriber, const Command& command,
                               const std::function<bool()>& gives_up);

/// Which of the frames that have come is drawn.
enum class Playout {
  kLatest,  ///< the newest one: least delay, but uneven motion where frames come unevenly
  kSmooth,  ///< between two frames, one frame behind: even motion at any rate of pictures
  kExact    ///< each one once, in order: for pictures that are kept
};

struct PlayoutStatistics {
  uint64_t pictures = 0;  ///< calls that gave a frame
  uint64_t repeated = 0;  ///< of these, with nothing newer than the picture before
  double delay_ms = 0;    ///< kSmooth: from the arrival of a frame without jitter to its picture
  double jitter_ms = 0;   ///< kSmooth: by which 19 of 20 frames come later than the fastest
};

/// Moves hair that was simulated on one head pose rigidly to another, newer one ("late latching"): a renderer
/// that tracks the head itself then shows no delay of the head, only of the sway of the hair. Not for hair
/// whose roots stay on a skinned body, which is not the head's.
void moveToHead(GuideFrame& frame, const Pose& head);
/// A frame between two of one revision, at a time between theirs: positions go straight relative to the head,
/// the head and colliders from pose to pose. All else is the later one's.
void mixFrames(const GuideFrame& a, const GuideFrame& b, double time, GuideFrame& out);

/// Picks frames for the pictures of a renderer, one thread at a time. `subscriber` outlives it.
class FramePlayer {
 public:
  FramePlayer(Subscriber& subscriber, Playout playout);
  ~FramePlayer();
  FramePlayer(const FramePlayer&) = delete;
  FramePlayer& operator=(const FramePlayer&) = delete;

  /// The frame for a picture that is drawn now; null while there is none (kExact: no further one). With
  /// `head`, moved there. Never waits. `now` by the steady clock.
  ///
  /// kSmooth keeps the offset between this machine's clock and simulation time at the least that the last
  /// second or so of arrivals shows, and plays one frame interval and the jitter (at most a second interval)
  /// behind it, between two frames as mixFrames(). Where frames stay away it stands still on the newest.
  std::shared_ptr<const GuideFrame> next(
      const std::optional<Pose>& head = std::nullopt,
      std::chrono::steady_clock::time_point now = std::chrono::steady_clock::now());
  PlayoutStatistics statistics() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace strandcast
