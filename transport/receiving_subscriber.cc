#include "transport/receiving_subscriber.h"

#include <cmath>

#include "transport/metrics.h"
#include "transport/parameter_table.h"

namespace strandcast {

bool isSound(const ReaderReport& report) {
  const auto is_finite = [](auto... numbers) { return (std::isfinite(numbers) && ...); };
  return report.reader != 0 && (report.pixels == -1 || (report.pixels >= 0 && report.pixels <= 1e6f)) &&
         report.rate >= 0 && is_finite(report.rate, report.latency_ms_p50, report.latency_ms_p99);
}

std::optional<Status> ReceivingSubscriber::status() const {
  const auto own = queue_.groom();
  return statuses_.ofGroom(groom_id_, own ? own->session : 0);
}

ReceiveStatistics ReceivingSubscriber::statistics() const {
  ReceiveStatistics statistics;
  {
    const std::lock_guard lock(mutex_);
    statistics = frames_.statistics();
    statistics.chunks_rejected +=
        grooms_.chunksRejected() + bodies_.chunksRejected() + colliders_.chunksRejected() + messages_damaged_;
  }
  queue_.addLatencies(statistics);
  return statistics;
}

void ReceivingSubscriber::receive(GroomChunk chunk) {
  const std::lock_guard lock(mutex_);
  const auto complete = grooms_.add(std::move(chunk));
  if (complete && queue_.setGroom(complete)) frames_.setGroom(complete);
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

void ReceivingSubscriber::describe(ReaderReport& report) const {
  const auto shown = frame();
  const ReceiveStatistics received = statistics();
  report.session = shown ? shown->session : 0;
  report.frames_received = received.frames_received;
  report.frames_lost = received.frames_lost;
  report.latency_ms_p50 = static_cast<float>(received.latency_ms_p50);
  report.latency_ms_p99 = static_cast<float>(received.latency_ms_p99);
}

void ReceivingSubscriber::countDamagedMessage() {
  const std::lock_guard lock(mutex_);
  ++messages_damaged_;
}

}  // namespace strandcast
