#include "transport/subscriber.h"

#include <algorithm>
#include <array>
#include <deque>
#include <thread>

#include "core/error.h"
#include "transport/chunks.h"
#include "transport/codec/guide_payload.h"
#include "transport/frame_queue.h"

namespace strandcast {
namespace {
constexpr std::chrono::milliseconds kSendAgain{500}, kPollInterval{20};
}

std::optional<std::string> ask(Subscriber& subscriber, const Command& command,
                               const std::function<bool()>& gives_up) {
  checkCommand(command, command.groom_id);  // an invalid command is not repeated
  for (;;) {
    try {
      subscriber.send(command, gives_up);
      const auto end = std::chrono::steady_clock::now() + kSendAgain;
      do {
        const std::optional<std::string> answer = subscriber.waitForAnswer(command.id, kPollInterval);
        if (answer || gives_up()) return answer;
      } while (std::chrono::steady_clock::now() < end);
    } catch (const Error&) {
      if (!subscriber.mayCommand() || gives_up()) throw;
    }
    std::this_thread::sleep_for(kPollInterval);  // send() may throw at once
  }
}

namespace {

using Frame = std::shared_ptr<const GuideFrame>;
constexpr size_t kKept = kFrameQueueLength;
constexpr size_t kArrivals = 64;  // window for the clock offset and the jitter

double seconds(uint64_t nanoseconds) { return static_cast<double>(nanoseconds) * 1e-9; }

}  // namespace

/// Estimates simulation time of one session by this machine's clock.
class ArrivalClock {
 public:
  void reset() { count_ = 0; }
  void add(const GuideFrame& frame) {
    offsets_[count_++ % kArrivals] = seconds(frame.arrival_time) - frame.simulation_time;
    const size_t kept = std::min(count_, kArrivals);
    std::array<double, kArrivals> sorted = offsets_;
    std::sort(sorted.begin(), sorted.begin() + static_cast<ptrdiff_t>(kept));
    offset_ = sorted[0];
    jitter_ = sorted[(kept - 1) * 19 / 20] - sorted[0];
  }
  /// Steady-clock time of simulation time 0, s, by the fastest arrivals.
  double offset() const { return offset_; }
  double jitter() const { return jitter_; }

 private:
  std::array<double, kArrivals> offsets_{};
  size_t count_ = 0;
  double offset_ = 0, jitter_ = 0;
};

void moveToHead(GuideFrame& frame, const Pose& head) {
  const HeadFrame from(frame.head), to(head);
  for (Vec3& position : frame.positions) position = to.toWorld(from.toHead(position));
  frame.head = head;
}

void interpolateFrames(const GuideFrame& a, const GuideFrame& b, double time, GuideFrame& out) {
  const auto t = static_cast<float>((time - a.simulation_time) / (b.simulation_time - a.simulation_time));
  out = b;
  out.simulation_time = time;
  out.head = interpolate(a.head, b.head, t);
  for (PlacedCollider& placed : out.colliders) {
    for (const PlacedCollider& before : a.colliders) {
      if (before.id != placed.id) continue;
      placed.pose = interpolate(before.pose, placed.pose, t);
      if (!before.bend.isNone() || !placed.bend.isNone())
        placed.bend = interpolate(before.bend, placed.bend, t);
    }
  }
  const HeadFrame from_a(a.head), from_b(b.head), to(out.head);
  for (size_t v = 0; v < out.positions.size(); ++v) {
    const Vec3 start = from_a.toHead(a.positions[v]), end = from_b.toHead(b.positions[v]);
    out.positions[v] = to.toWorld(start + t * (end - start));
  }
}

struct FramePlayer::State {
  Subscriber& subscriber;
  const Playout playout;
  std::deque<Frame> frames;  // newest last, of one session and revision
  ArrivalClock clock;
  FramePool pool;
  double shown_time = 0;  // simulation time of the last picture, s
  uint64_t shown_frame = 0;
  double delay = 0;  // s
  PlayoutStatistics statistics;

  void fetch() {
    for (;;) {
      const Frame frame = subscriber.waitForNext(frames.empty() ? nullptr : frames.back().get(),
                                                 std::chrono::milliseconds(0));
      if (!frame) break;
      const bool is_new = !frames.empty() && (frame->session != frames.back()->session ||
                                              frame->revision != frames.back()->revision ||
                                              frame->frame <= frames.back()->frame);
      if (is_new || frames.empty()) {
        frames.clear();
        clock.reset();
        shown_time = 0;
        shown_frame = 0;
      }
      clock.add(*frame);
      frames.push_back(frame);
      if (frames.size() > kKept) frames.pop_front();
    }
    // A new groom came, but no frame of it yet.
    const auto groom = subscriber.groom();
    if (groom && !frames.empty() &&
        (frames.back()->session != groom->session || frames.back()->revision != groom->revision))
      frames.clear();
  }

  /// Mean simulation time between frames, s; 0 if unknown.
  double interval() const {
    const GuideFrame &first = *frames.front(), &last = *frames.back();
    return last.frame > first.frame ? (last.simulation_time - first.simulation_time) /
                                          static_cast<double>(last.frame - first.frame)
                                    : 0;
  }

  Frame between(const GuideFrame& a, const GuideFrame& b, double time) {
    FramePool::Buffer mixed = pool.acquire();
    interpolateFrames(a, b, time, *mixed);
    return pool.share(std::move(mixed));
  }

  Frame smooth(double now) {
    const double step = interval();
    delay = step + std::min(clock.jitter(), step);
    const double newest = frames.back()->simulation_time;
    const double time = std::min(std::max(now - clock.offset() - delay, shown_time), newest);
    statistics.repeated += time <= shown_time ? 1 : 0;
    shown_time = time;
    const auto later = std::find_if(frames.begin(), frames.end(),
                                    [&](const Frame& frame) { return frame->simulation_time >= time; });
    if (later == frames.begin() || (*later)->simulation_time == time) return *later;
    if ((*std::prev(later))->continuity != (*later)->continuity) return *std::prev(later);
    return between(**std::prev(later), **later, time);
  }

  Frame pick(double now) {
    switch (playout) {
      case Playout::kLatest:
        statistics.repeated += frames.back()->frame == shown_frame ? 1 : 0;
        shown_frame = frames.back()->frame;
        return frames.back();
      case Playout::kSmooth:
        return smooth(now);
      case Playout::kExact:
        break;
    }
    const auto next = std::find_if(frames.begin(), frames.end(),
                                   [&](const Frame& frame) { return frame->frame > shown_frame; });
    if (next == frames.end()) return nullptr;
    shown_frame = (*next)->frame;
    return *next;
  }
};

FramePlayer::FramePlayer(Subscriber& subscriber, Playout playout)
    : state_(new State{subscriber, playout, {}, {}, {}, 0, 0, 0, {}}) {}
FramePlayer::~FramePlayer() = default;

std::shared_ptr<const GuideFrame> FramePlayer::next(const std::optional<Pose>& head,
                                                    std::chrono::steady_clock::time_point now) {
  state_->fetch();
  if (state_->frames.empty()) return nullptr;
  Frame frame = state_->pick(std::chrono::duration<double>(now.time_since_epoch()).count());
  if (!frame) return nullptr;
  ++state_->statistics.pictures;
  if (!head) return frame;
  FramePool::Buffer moved = state_->pool.acquire();
  *moved = *frame;
  moveToHead(*moved, *head);
  return state_->pool.share(std::move(moved));
}

PlayoutStatistics FramePlayer::statistics() const {
  PlayoutStatistics statistics = state_->statistics;
  statistics.delay_ms = 1e3 * state_->delay;
  statistics.jitter_ms = 1e3 * state_->clock.jitter();
  return statistics;
}

}  // namespace strandcast
