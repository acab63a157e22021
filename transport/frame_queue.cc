#include "transport/frame_queue.h"

#include <algorithm>
#include <utility>

#include "core/quantile.h"

namespace strandcast {
namespace {
constexpr size_t kFreeFrames = kFrameQueueLength + 4;
}

FramePool::Buffer FramePool::acquire() {
  const std::lock_guard lock(store_->mutex);
  if (store_->free.empty()) return std::make_unique<GuideFrame>();
  Buffer frame = std::move(store_->free.back());
  store_->free.pop_back();
  return frame;
}

std::shared_ptr<const GuideFrame> FramePool::share(Buffer frame) {
  return {frame.release(), [store = store_](GuideFrame* used) { store->release(Buffer(used)); }};
}

void FramePool::Store::release(Buffer frame) {
  const std::lock_guard lock(mutex);
  if (free.size() < kFreeFrames) free.push_back(std::move(frame));
}

bool FrameQueue::setGroom(std::shared_ptr<const GroomDescription> groom) {
  const std::lock_guard lock(mutex_);
  if (groom_ && groom_->session == groom->session && groom->revision <= groom_->revision) return false;
  groom_ = std::move(groom);
  frames_.clear();
  changed_.notify_all();
  return true;
}

void FrameQueue::setBody(std::shared_ptr<const BodyDescription> body) {
  const std::lock_guard lock(mutex_);
  // A body that is announced again unchanged keeps its pointer.
  if (body_ && body_->session == body->session && body->revision <= body_->revision) return;
  body_ = std::move(body);
  changed_.notify_all();
}

bool FrameQueue::setColliders(std::shared_ptr<const ColliderSet> colliders) {
  const std::lock_guard lock(mutex_);
  if (colliders_ && colliders_->session == colliders->session && colliders->revision <= colliders_->revision)
    return false;
  colliders_ = std::move(colliders);
  changed_.notify_all();
  return true;
}

void FrameQueue::setHairs(std::shared_ptr<const HairDescription> hairs) {
  const std::lock_guard lock(mutex_);
  if (hairs_ && hairs_->session == hairs->session && hairs->revision <= hairs_->revision) return;
  hairs_ = std::move(hairs);
  changed_.notify_all();
}

void FrameQueue::keep(size_t count) {
  const std::lock_guard lock(mutex_);
  kept_ = std::max<size_t>(count, 1);
  while (frames_.size() > kept_) frames_.pop_front();
}

void FrameQueue::push(std::shared_ptr<const GuideFrame> frame, double latency_ms) {
  const std::lock_guard lock(mutex_);
  if (!groom_ || frame->session != groom_->session || frame->revision != groom_->revision) return;
  if (!frames_.empty() && frame->frame <= frames_.back()->frame) frames_.clear();  // frame numbers restarted
  frames_.push_back(std::move(frame));
  if (frames_.size() > kept_) frames_.pop_front();
  latencies_ms_[latencies_++ % latencies_ms_.size()] = static_cast<float>(latency_ms);
  changed_.notify_all();
}

template <class Description>
bool FrameQueue::isOfGroom(const Description* description) const {
  return description && groom_ && description->session == groom_->session &&
         description->revision == groom_->revision;
}

bool FrameQueue::isWhole() const {
  return isOfGroom(body_.get()) &&
         ((groom_->growth & GroomDescription::kHairs) == 0 || isOfGroom(hairs_.get()));
}

std::shared_ptr<const GroomDescription> FrameQueue::groom() const {
  const std::lock_guard lock(mutex_);
  return groom_;
}

std::shared_ptr<const BodyDescription> FrameQueue::body() const {
  const std::lock_guard lock(mutex_);
  return isOfGroom(body_.get()) ? body_ : nullptr;
}

std::shared_ptr<const ColliderSet> FrameQueue::colliders() const {
  const std::lock_guard lock(mutex_);
  return colliders_ && groom_ && colliders_->session == groom_->session ? colliders_ : nullptr;
}

std::shared_ptr<const HairDescription> FrameQueue::hairs() const {
  const std::lock_guard lock(mutex_);
  return isOfGroom(hairs_.get()) ? hairs_ : nullptr;
}

std::shared_ptr<const GuideFrame> FrameQueue::frame() const {
  const std::lock_guard lock(mutex_);
  return frames_.empty() ? nullptr : frames_.back();
}

template <class Reached>
std::shared_ptr<const GuideFrame> FrameQueue::waitBeyond(std::chrono::milliseconds timeout,
                                                         const Reached& reached) {
  std::unique_lock lock(mutex_);
  std::shared_ptr<const GuideFrame> found;
  changed_.wait_for(lock, timeout, [&] {
    if (frames_.empty()) return false;
    const uint64_t after = reached(*frames_.back());
    const auto newer =
        std::find_if(frames_.begin(), frames_.end(), [&](const auto& frame) { return frame->frame > after; });
    if (newer != frames_.end()) found = *newer;
    return found != nullptr;
  });
  return found;
}

std::shared_ptr<const GuideFrame> FrameQueue::waitForFrame(uint64_t after,
                                                           std::chrono::milliseconds timeout) {
  return waitBeyond(timeout, [=](const GuideFrame& newest) { return after > newest.frame ? 0 : after; });
}

std::shared_ptr<const GuideFrame> FrameQueue::waitForNext(const GuideFrame* last,
                                                          std::chrono::milliseconds timeout) {
  return waitBeyond(timeout, [=](const GuideFrame& newest) {
    const bool is_before = last != nullptr && last->session == newest.session && last->frame <= newest.frame;
    return is_before ? last->frame : 0;
  });
}

bool FrameQueue::waitForGroom(std::chrono::milliseconds timeout) {
  std::unique_lock lock(mutex_);
  return changed_.wait_for(lock, timeout, [&] { return isWhole(); });
}

void FrameQueue::addLatencies(ReceiveStatistics& statistics) const {
  std::vector<double> latencies;
  {
    const std::lock_guard lock(mutex_);
    const size_t known = std::min(latencies_, latencies_ms_.size());
    latencies.assign(latencies_ms_.begin(), latencies_ms_.begin() + static_cast<ptrdiff_t>(known));
  }
  statistics.latency_ms_p50 = quantileOf(latencies, 0.50);
  statistics.latency_ms_p99 = quantileOf(std::move(latencies), 0.99);
}

namespace {

template <class Clock>
uint64_t nanoseconds() {
  const auto since = Clock::now().time_since_epoch();
  return static_cast<uint64_t>(std::chrono::duration_cast<std::chrono::nanoseconds>(since).count());
}

}  // namespace

uint64_t systemTime() { return nanoseconds<std::chrono::system_clock>(); }
uint64_t steadyTime() { return nanoseconds<std::chrono::steady_clock>(); }

double latencyMs(uint64_t publish_time) {
  return static_cast<double>(static_cast<int64_t>(systemTime() - publish_time)) * 1e-6;
}

}  // namespace strandcast
