#pragma once
#include <chrono>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "transport/assembler.h"
#include "transport/commands.h"
#include "transport/frame_queue.h"
#include "transport/status_board.h"
#include "transport/subscriber.h"
#include "transport/wire_fields.h"

namespace strandcast {

/// The part of a subscriber that does not depend on the network: takes chunks and statuses of one groom, and
/// provides descriptions, frames, answers and statistics. Derived classes carry the messages. Thread-safe.
class ReceivingSubscriber : public Subscriber {
 public:
  std::shared_ptr<const GroomDescription> groom() const final { return queue_.groom(); }
  std::shared_ptr<const BodyDescription> body() const final { return queue_.body(); }
  std::shared_ptr<const HairDescription> hairs() const final { return queue_.hairs(); }
  std::shared_ptr<const ColliderSet> colliders() const final { return queue_.colliders(); }
  std::shared_ptr<const GuideFrame> frame() const final { return queue_.frame(); }
  void keepFrames(size_t count) final { queue_.keep(count); }
  std::shared_ptr<const GuideFrame> waitForFrame(uint64_t after, std::chrono::milliseconds timeout) final {
    return queue_.waitForFrame(after, timeout);
  }
  std::shared_ptr<const GuideFrame> waitForNext(const GuideFrame* last,
                                                std::chrono::milliseconds timeout) final {
    return queue_.waitForNext(last, timeout);
  }
  bool waitForGroom(std::chrono::milliseconds timeout) final { return queue_.waitForGroom(timeout); }
  std::optional<Status> status() const override;
  std::vector<Status> allStatuses() const override { return statuses_.all(); }
  std::optional<std::string> waitForAnswer(uint64_t command, std::chrono::milliseconds timeout) final {
    return answers_.wait(command, timeout);
  }
  ReceiveStatistics statistics() const final;
  void setPictures(float pixels, float rate) final;

 protected:
  /// Time that a daemon has to answer a command, unless its answer needs longer.
  static constexpr std::chrono::milliseconds kAnswerTime{2000};

  /// With `conceals`, incomplete frames are not waited for: their lost strands are extrapolated.
  ReceivingSubscriber(uint32_t groom_id, bool conceals)
      : groom_id_(groom_id),
        conceals_(conceals),
        reader_id_(newReaderId()),
        grooms_(groom_id),
        bodies_(groom_id),
        colliders_(groom_id),
        hairs_(groom_id),
        frames_(conceals) {}

  void receive(GroomChunk chunk);
  void receive(BodyChunk chunk);
  void receive(ColliderChunk chunk);
  void receive(HairChunk chunk);
  /// `read` fills the given chunk, whose memory is reused, and returns whether it is sound.
  template <class Read>
  void receiveGuides(const Read& read) {
    const std::lock_guard lock(mutex_);
    if (read(guide_chunk_))
      receiveGuideChunk();
    else
      ++messages_damaged_;
  }
  /// False where it is damaged or the status board is full.
  bool receive(Status status, const StatusBoard::WriterId& writer);
  void countDamagedMessage();
  /// The present report. Not with a lock that the thread which receives takes.
  ReaderReport report() const;
  /// Whether `now` is to be sent at once after `last`: it lacks or has other messages, or the size of the
  /// pictures has changed by a tenth.
  static bool isUrgent(const ReaderReport& last, const ReaderReport& now);

  mutable StatusBoard statuses_;

 private:
  static uint64_t newReaderId();
  void receiveGuideChunk();
  void push(std::shared_ptr<const GuideFrame> frame);

  const uint32_t groom_id_;
  const bool conceals_;
  const uint64_t reader_id_;
  FrameQueue queue_;
  Answers answers_;
  mutable std::mutex mutex_;  // guards all below
  GroomAssembler grooms_;
  BodyAssembler bodies_;
  ColliderAssembler colliders_;
  HairAssembler hairs_;
  GuideAssembler frames_;
  GuideChunk guide_chunk_;
  uint64_t messages_damaged_ = 0;
  float pixels_ = -1, rate_ = 0;
};

}  // namespace strandcast
