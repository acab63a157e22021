#include "service/stream.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <utility>

#include "core/error.h"
#include "options/console.h"
#include "options/scene_loading.h"
#include "service/network.h"
#include "transport/in_process.h"
#include "transport/versions.h"

namespace strandcast {

EmbeddedDaemon::EmbeddedDaemon(const Settings& settings, SimulationObserver observer) {
  std::tie(publisher_, subscriber_) = makeInProcessChannel(settings.groom_id);
  daemon_ =
      std::make_unique<Daemon>(settings, makeSceneWithProgress(settings.scene), *publisher_, newSession());
  daemon_->setObserver(std::move(observer));
  daemon_->announce();
  thread_ = std::thread([this] {
    try {
      daemon_->run(stop_);
    } catch (...) {
      const std::lock_guard lock(mutex_);
      failure_ = std::current_exception();
    }
    has_ended_ = true;
  });
}

EmbeddedDaemon::~EmbeddedDaemon() {
  stop_ = true;
  thread_.join();
}

void EmbeddedDaemon::checkAlive() const {
  const std::lock_guard lock(mutex_);
  if (failure_) std::rethrow_exception(failure_);
}

Stream::Stream(const Settings& settings, bool here, double timeout, SimulationObserver observer) {
  if (here)
    embedded_ = std::make_unique<EmbeddedDaemon>(settings, std::move(observer));
  else
    remote_ = subscribe(settings);
  constexpr std::chrono::milliseconds kPollInterval{100};
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(timeout);
  bool found = false;
  while (!found && std::chrono::steady_clock::now() < end) {
    if (g_interrupted) throw Interrupted();
    found = subscriber().waitForGroom(kPollInterval);
  }
  if (const auto other = subscriber().otherVersion(); other && !found)
    throw Error("no daemon of this wire version publishes this groom",
                fmt::format("groom {} on {}", settings.groom_id, networkName(settings)),
                warningOf(*other, settings.groom_id, networkName(settings)));
  if (!found)
    throw Error("no daemon publishes this groom",
                fmt::format("groom {} on {}", settings.groom_id, networkName(settings)),
                settings.keys.empty() ? "start strandcastd, or name a --scene or --groom to simulate here"
                                      : "start strandcastd, or check the keys: a daemon refuses keys of "
                                        "another CA, expired keys and keys that do not permit this groom");
}

namespace {

constexpr double kSameTime = 1e-5;  // s, tolerance on a frame's time; nothing moves visibly within it
constexpr double kPause = 1;        // s for which the simulation time stands still before the daemon counts
                                    // as paused

std::shared_ptr<const GuideFrame> between(const GuideFrame& a, const GuideFrame& b, double time) {
  auto mixed = std::make_shared<GuideFrame>();
  interpolateFrames(a, b, time, *mixed);
  return mixed;
}

size_t bytesOf(const CapturedFrame& captured) { return captured.frame->positions.size() * sizeof(Vec3); }

}  // namespace

FrameCapture::FrameCapture(Stream& stream, const Plan& plan)
    : stream_(stream), plan_(plan), thread_([this] { run(); }) {}

FrameCapture::~FrameCapture() {
  stop_ = true;
  thread_.join();
}

std::optional<CapturedFrame> FrameCapture::next() {
  while (!g_interrupted) {
    {
      const std::lock_guard lock(mutex_);
      if (!queue_.empty()) {
        CapturedFrame frame = std::move(queue_.front());
        queue_.pop_front();
        held_ -= bytesOf(frame);
        return frame;
      }
      if (done_) return std::nullopt;
    }
    stream_.checkAlive();
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return std::nullopt;
}

bool FrameCapture::keep(CapturedFrame frame) {
  const std::lock_guard lock(mutex_);
  if (!queue_.empty() && held_ + bytesOf(frame) > plan_.room) return false;
  held_ += bytesOf(frame);
  queue_.push_back(std::move(frame));
  return true;
}

void FrameCapture::run() {
  Subscriber& subscriber = stream_.subscriber();
  std::shared_ptr<const GuideFrame> last;
  int captured = 0, due = 0;  // pictures; `due` counts from `start`
  double start = -1;          // s of simulation time
  auto moved = std::chrono::steady_clock::now();
  bool stands = false, told = false;
  while (captured < plan_.frames && !stop_ && !g_interrupted) {
    const bool has_ended = stream_.hasEnded();  // read before the wait, so that the last frames are not lost
    const auto frame = subscriber.waitForNext(last.get(), std::chrono::milliseconds(100));
    const auto now = std::chrono::steady_clock::now();
    const bool is_other = frame && last && last->session != frame->session;  // another daemon took over
    // A paused daemon repeats the same simulation time.
    if (frame) stands = last && !is_other && last->simulation_time == frame->simulation_time;
    if (frame && !stands) moved = now;
    const double still = std::chrono::duration<double>(now - moved).count();
    if (still > kPause && stands && !std::exchange(told, true))
      spdlog::warn("the daemon is paused at {:g} s: `strandcast ctl go` resumes it", last->simulation_time);
    if (still > plan_.timeout) {
      is_paused_ = stands && subscriber.status().has_value();  // the daemon may have ended since
      const StreamScene scene = StreamScene::of(subscriber);
      if (is_paused_ && captured == 0 && scene.fits(*last)) keep({last, scene});
      break;
    }
    if (!frame && has_ended) break;
    if (!frame) continue;
    const bool fits_last = last && !is_other && last->revision == frame->revision &&
                           last->continuity == frame->continuity &&
                           last->positions.size() == frame->positions.size();
    const auto before = std::exchange(last, frame);
    if (is_other) start = -1;
    const StreamScene scene = StreamScene::of(subscriber);
    if (!scene.fits(*frame)) continue;  // its body has not arrived yet
    if (start < 0) {
      start = frame->simulation_time + plan_.skip;
      due = 0;
    }
    for (; captured < plan_.frames; ++due) {
      const double time = start + due / plan_.fps;
      if (frame->simulation_time < time - kSameTime) break;
      const bool is_between =
          fits_last && time < frame->simulation_time - kSameTime && time > before->simulation_time;
      if (keep({is_between ? between(*before, *frame, time) : frame, scene})) {
        ++captured;
      } else if (skipped_frames_++ == 0) {
        spdlog::warn("drawing is slower than the stream, and {} MiB of frames wait: some are skipped",
                     plan_.room >> 20);
      }
    }
  }
  const std::lock_guard lock(mutex_);
  done_ = true;
}

/// Records the groom of the frame once it has arrived complete.
bool StreamRecording::describe(const GuideFrame& frame) {
  const StreamScene scene = StreamScene::of(subscriber_);
  if (!scene.fits(frame)) return false;
  recorder_.setGroom(*scene.groom, *scene.body);
  if (scene.hairs) recorder_.setHairs(*scene.hairs);
  return true;
}

bool StreamRecording::take(std::chrono::milliseconds timeout) {
  const auto frame = subscriber_.waitForNext(last_.get(), timeout);
  if (!frame) return false;
  const bool is_new = frame->session != session_ || frame->revision != revision_ ||
                      frame->frame <= last_->frame;  // the frame count restarted
  if (!is_new && frame->frame > last_->frame + 1) skipped_ += frame->frame - last_->frame - 1;
  const bool is_same = !is_new && frame->simulation_time == last_->simulation_time;  // of a paused daemon
  last_ = frame;
  if (is_same) return true;
  if (is_new && !describe(*frame)) return true;
  session_ = frame->session;
  revision_ = frame->revision;
  recorder_.addFrame(*frame);
  return true;
}

}  // namespace strandcast
