#include "transport/receiving_subscriber.h"

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
  if (!isSound(status.parameters)) {
    countDamagedMessage();
    return false;
  }
  const bool is_taken = statuses_.post(writer, status);
  // After the status, so that a thread that sees the answer sees its effects.
  if (status.groom_id == groom_id_) answers_.post(status);
  return is_taken;
}

void ReceivingSubscriber::countDamagedMessage() {
  const std::lock_guard lock(mutex_);
  ++messages_damaged_;
}

}  // namespace strandcast
