#include "transport/dds_claim.h"

#include <algorithm>

namespace strandcast {
namespace {
constexpr std::chrono::milliseconds kClaimPeriod{40};
constexpr size_t kProgramBytes = 12;  // of a GUID: they are alike in all that a participant writes
}  // namespace

DdsClaim::DdsClaim(uint32_t groom_id, uint64_t session, uint32_t strength)
    : groom_id_(groom_id),
      session_(session),
      strength_(strength),
      listener_(
          [this](v6::Claim& claim, const auto&) {
            if (claim.groom_id() != groom_id_ || holder_.exchange(claim.session()) == claim.session()) return;
            if (claim.session() == session_) ++turns_;
          },
          {.found =
               [this](const auto& writer) {
                 const std::lock_guard lock(writers_mutex_);
                 writers_.insert(writer);
               },
           .left =
               [this](const auto& writer) {
                 const std::lock_guard lock(writers_mutex_);
                 writers_.erase(writer);
               }}) {}

uint64_t DdsClaim::turn() const {
  return holder_ == session_ && std::chrono::steady_clock::now() >= settled_ ? turns_.load() : 0;
}

bool DdsClaim::isClaimants(const StatusBoard::WriterId& writer) const {
  const std::lock_guard lock(writers_mutex_);
  return std::any_of(writers_.begin(), writers_.end(), [&](const StatusBoard::WriterId& known) {
    return std::equal(known.begin(), known.begin() + kProgramBytes, writer.begin());
  });
}

void DdsClaim::join(DdsParticipant& participant, std::chrono::milliseconds settles) {
  settled_ = std::chrono::steady_clock::now() + settles;
  participant.createReader(kClaimTopic, new ClaimType, &listener_);
  writer_ = participant.createWriter(kClaimTopic, new ClaimType, nullptr, strength_);
}

void DdsClaim::claim() {
  if (!thread_.joinable()) thread_ = std::thread([this] { write(); });
}

void DdsClaim::stop() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  wake_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void DdsClaim::write() {
  v6::Claim sample;
  sample.groom_id(groom_id_);
  sample.session(session_);
  std::unique_lock lock(mutex_);
  do {
    lock.unlock();
    writer_->write(&sample);
    lock.lock();
  } while (!wake_.wait_for(lock, kClaimPeriod, [&] { return stop_; }));
}

}  // namespace strandcast
