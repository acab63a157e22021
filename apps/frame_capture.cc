#include "apps/frame_capture.h"

#include <spdlog/spdlog.h>

#include <chrono>

#include "apps/interrupt.h"

namespace strandcast {
namespace {

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
  int captured = 0;
  double due = -1;
  auto heard = std::chrono::steady_clock::now();
  while (captured < plan_.frames && !stop_ && !g_interrupted) {
    const auto frame = subscriber.waitForNext(last.get(), std::chrono::milliseconds(100));
    const auto now = std::chrono::steady_clock::now();
    const bool is_other = frame && last && last->session != frame->session;  // another daemon took over
    // A daemon that is paused sends the same moment again and again.
    if (frame && (!last || is_other || last->simulation_time != frame->simulation_time)) heard = now;
    if (std::chrono::duration<double>(now - heard).count() > plan_.timeout) break;
    if (!frame) continue;
    if (is_other) due = -1;
    last = frame;
    const StreamScene scene = StreamScene::of(subscriber);
    if (!scene.fits(*frame)) continue;  // its body is still to come
    if (due < 0) due = frame->simulation_time + plan_.skip;
    if (frame->simulation_time < due - 1e-9) continue;
    due += 1 / plan_.fps;
    if (keep({frame, scene})) {
      ++captured;
    } else if (passed_over_++ == 0) {
      spdlog::warn("drawing is slower than the stream, and {} MiB of frames wait: some are passed over",
                   plan_.room >> 20);
    }
  }
  const std::lock_guard lock(mutex_);
  done_ = true;
}

}  // namespace strandcast
