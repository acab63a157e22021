#pragma once
#include <array>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <vector>

#include "transport/messages.h"
#include "transport/subscriber.h"

namespace strandcast {

/// Recycles the memory of frames after the last reader has released them. Thread-safe; frames may outlive the
/// pool.
class FramePool {
 public:
  using Buffer = std::unique_ptr<GuideFrame>;
  FramePool() : store_(std::make_shared<Store>()) {}
  /// A frame with unspecified contents.
  Buffer acquire();
  /// Makes the frame immutable and shared; its memory returns to the pool with the last reference.
  std::shared_ptr<const GuideFrame> share(Buffer frame);
  void release(Buffer frame) { store_->release(std::move(frame)); }

 private:
  struct Store {
    std::mutex mutex;
    std::vector<Buffer> free;
    void release(Buffer frame);
  };
  std::shared_ptr<Store> store_;
};

/// The current descriptions and the newest frames that fit them, as a subscriber returns them. Thread-safe.
class FrameQueue {
 public:
  /// Makes `groom` current unless it is current already or an earlier revision of its session; drops older
  /// frames. Returns whether it has become current.
  bool setGroom(std::shared_ptr<const GroomDescription> groom);
  /// Sets the body unless it is an earlier or the same revision of its session.
  void setBody(std::shared_ptr<const BodyDescription> body);
  /// As setGroom(), but keeps frames.
  bool setColliders(std::shared_ptr<const ColliderSet> colliders);
  /// As setBody().
  void setHairs(std::shared_ptr<const HairDescription> hairs);
  /// As Subscriber::keepFrames().
  void keep(size_t count);
  /// Ignores a frame that does not fit groom(). A frame whose number is not above the newest restarts the
  /// queue. `latency_ms`: from publication to now.
  void push(std::shared_ptr<const GuideFrame> frame, double latency_ms);

  /// As the functions of Subscriber.
  std::shared_ptr<const GroomDescription> groom() const;
  std::shared_ptr<const BodyDescription> body() const;
  std::shared_ptr<const ColliderSet> colliders() const;
  std::shared_ptr<const HairDescription> hairs() const;
  std::shared_ptr<const GuideFrame> frame() const;
  std::shared_ptr<const GuideFrame> waitForFrame(uint64_t after, std::chrono::milliseconds timeout);
  std::shared_ptr<const GuideFrame> waitForNext(const GuideFrame* last, std::chrono::milliseconds timeout);
  bool waitForGroom(std::chrono::milliseconds timeout);
  /// Sets the latency fields.
  void addLatencies(ReceiveStatistics& statistics) const;

 private:
  /// False for null.
  template <class Description>
  bool isOfGroom(const Description* description) const;
  /// Whether groom_ and all that belongs to it and is drawn are here.
  bool isWhole() const;
  /// The oldest frame that is newer than `reached(newest frame)`.
  template <class Reached>
  std::shared_ptr<const GuideFrame> waitBeyond(std::chrono::milliseconds timeout, const Reached& reached);
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::shared_ptr<const GroomDescription> groom_;
  std::shared_ptr<const BodyDescription> body_;   // newest; returned when it fits groom_
  std::shared_ptr<const ColliderSet> colliders_;  // newest; returned when it is of groom_'s session
  std::shared_ptr<const HairDescription> hairs_;  // newest; returned when it fits groom_
  size_t kept_ = kFrameQueueLength;
  std::deque<std::shared_ptr<const GuideFrame>> frames_;  // at most kept_
  std::array<float, 1000> latencies_ms_{};
  size_t latencies_ = 0;  // number since the start
};

/// ns since 1970 by the system clock, as GuideFrame::publish_time.
uint64_t systemTime();
/// ns by the steady clock, as GuideFrame::arrival_time.
uint64_t steadyTime();
/// From `publish_time` to now; negative when the sender's clock is ahead.
double latencyMs(uint64_t publish_time);

}  // namespace strandcast
