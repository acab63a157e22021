#include "transport/dds_claim.h"

namespace strandcast {
namespace {
constexpr std::chrono::milliseconds kClaimPeriod{40};
constexpr std::chrono::milliseconds kFallsSilent{1000};  // in which every claimant has heard of a new holder
}  // namespace

DdsClaim::DdsClaim(uint32_t groom_id, uint64_t session, uint32_t strength)
    : groom_id_(groom_id),
      session_(session),
      strength_(strength),
      listener_([this](v6::Claim& claim, const auto&) {
        if (claim.groom_id() != groom_id_ || holder_.exchange(claim.session()) == claim.session()) return;
        changed_ = std::chrono::steady_clock::now().time_since_epoch();
        if (claim.session() == session_) ++turns_;
      }) {}

uint64_t DdsClaim::turn() const {
  return holder_ == session_ && std::chrono::steady_clock::now() >= settled_ ? turns_.load() : 0;
}

bool DdsClaim::isSettled() const {
  const auto now = std::chrono::steady_clock::now();
  return holder_ != 0 && now >= settled_ && now.time_since_epoch() - changed_.load() >= kFallsSilent;
}

void DdsClaim::start(DdsParticipant& participant, std::chrono::milliseconds settles) {
  settled_ = std::chrono::steady_clock::now() + settles;
  participant.createReader(kClaimTopic, new ClaimType, &listener_);
  thread_ = std::thread([this, writer = participant.createWriter(kClaimTopic, new ClaimType, nullptr,
                                                                 strength_)] { claim(writer); });
}

void DdsClaim::stop() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  wake_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void DdsClaim::claim(eprosima::fastdds::dds::DataWriter* writer) {
  v6::Claim sample;
  sample.groom_id(groom_id_);
  sample.session(session_);
  std::unique_lock lock(mutex_);
  do {
    lock.unlock();
    writer->write(&sample);
    lock.lock();
  } while (!wake_.wait_for(lock, kClaimPeriod, [&] { return stop_; }));
}

}  // namespace strandcast
