#include "transport/receiving_subscriber.h"

#include <cmath>
#include <random>

#include "transport/metrics.h"
#include "transport/parameter_table.h"

namespace strandcast {

std::optional<Status> ReceivingSubscriber::status() const {
  const auto own = queue_.groom();
  return statuses_.ofGroom(groom_id_, own ? own->session : 0);
}

ReceiveStatistics ReceivingSubscriber::statistics() const {
  ReceiveStatistics statistics;
  {
    const std::lock_guard lock(mutex_);
    statistics = frames_.statistics();
    statistics.chunks_rejected += grooms_.chunksRejected() + bodies_.chunksRejected() +
                                  colliders_.chunksRejected() + hairs_.chunksRejected() + messages_damaged_;
  }
  queue_.addLatencies(statistics);
  return statistics;
}

void ReceivingSubscriber::receive(GroomChunk chunk) {
  const std::lock_guard lock(mutex_);
  const auto complete = grooms_.add(std::move(chunk));
  if (!complete || !queue_.setGroom(complete)) return;
  frames_.setGroom(complete);
  if (auto waiting = hairs_.setGroom(complete)) queue_.setHairs(std::move(waiting));
}

void ReceivingSubscriber::receive(BodyChunk chunk) {
  const std::lock_guard lock(mutex_);
  if (auto complete = bodies_.add(std::move(chunk))) queue_.setBody(std::move(complete));
}

void ReceivingSubscriber::receive(ColliderChunk chunk) {
  const std::lock_guard lock(mutex_);
  const auto complete = colliders_.add(std::move(chunk));
  if (complete && queue_.setColliders(complete)) frames_.setColliders(complete);
}

void ReceivingSubscriber::receive(HairChunk chunk) {
  const std::lock_guard lock(mutex_);
  if (auto complete = hairs_.add(std::move(chunk))) queue_.setHairs(std::move(complete));
}

void ReceivingSubscriber::receiveGuideChunk() {
  push(frames_.add(guide_chunk_));
  if (conceals_) push(frames_.concealOverdue());
}

void ReceivingSubscriber::push(std::shared_ptr<const GuideFrame> frame) {
  if (!frame) return;
  const uint64_t publish_time = frame->publish_time;
  queue_.push(std::move(frame), latencyMs(publish_time));
}

bool ReceivingSubscriber::receive(Status status, const StatusBoard::WriterId& writer) {
  if (!isSound(status.parameters) || !isSound(status.metrics)) {
    countDamagedMessage();
    return false;
  }
  const bool is_taken = statuses_.post(writer, status);
  // After the status, so that a thread that sees the answer sees its effects.
  if (status.groom_id == groom_id_) answers_.post(status);
  return is_taken;
}

uint64_t ReceivingSubscriber::newReaderId() {
  std::random_device random;
  return 1 | random() | static_cast<uint64_t>(random()) << 32;
}

void ReceivingSubscriber::setPictures(float pixels, float rate) {
  const std::lock_guard lock(mutex_);
  pixels_ = pixels;
  rate_ = rate;
}

ReaderReport ReceivingSubscriber::report() const {
  ReaderReport report;
  report.reader = reader_id_;
  report.groom_id = groom_id_;
  if (const auto shown = frame()) report.session = shown->session;
  const ReceiveStatistics received = statistics();
  report.frames_received = received.frames_received;
  report.frames_lost = received.frames_lost;
  report.latency_ms_p50 = static_cast<float>(received.latency_ms_p50);
  report.latency_ms_p99 = static_cast<float>(received.latency_ms_p99);
  const auto own = groom();
  const bool has_hairs = !own || (own->growth & GroomDescription::kHairs) == 0 || hairs();
  report.wants = (own && body() ? 0u : ReaderReport::kGroomAndBody) |
                 (has_hairs ? 0u : ReaderReport::kHairs) | (colliders() ? 0u : ReaderReport::kColliders);
  const std::lock_guard lock(mutex_);
  report.pixels = pixels_;
  report.rate = rate_;
  return report;
}

bool ReceivingSubscriber::isUrgent(const ReaderReport& last, const ReaderReport& now) {
  const bool is_seen_otherwise = (last.pixels > 0) != (now.pixels > 0);
  return last.wants != now.wants || is_seen_otherwise ||
         std::abs(now.pixels - last.pixels) > 0.1f * std::abs(last.pixels);
}

void ReceivingSubscriber::countDamagedMessage() {
  const std::lock_guard lock(mutex_);
  ++messages_damaged_;
}

}  // namespace strandcast
