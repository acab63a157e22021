#include "transport/dds_claim.h"

#include <algorithm>

#include "transport/dds_type.h"

namespace strandcast {
namespace {
constexpr std::chrono::milliseconds kClaimPeriod{40};
/// After this pause since its last claim another claimant has taken over: the topic's deadline is 250 ms.
constexpr std::chrono::milliseconds kStallTimeout{700};
/// Longest time from the discovery of a casting daemon's writer of claims to its first claim.
constexpr std::chrono::milliseconds kFirstClaim{250};
/// Time after the last claim when no claimant is left: the topic's deadline, and time for the next claimant's
/// first claim.
constexpr std::chrono::milliseconds kClaimSilence{1000};
}  // namespace

DdsClaim::DdsClaim(uint32_t groom_id, uint64_t session, uint32_t strength, const DdsNeighbours& neighbours)
    : groom_id_(groom_id),
      session_(session),
      strength_(strength),
      neighbours_(neighbours),
      listener_(
          [this](const Claim& claim, const auto& writer) {
            if (claim.groom_id != groom_id_) return;
            heard_ = Clock::now();
            holder_is_equal_ = neighbours_.strengthOf(prefixOf(writer)) == strength_;
            if (holder_.exchange(claim.session) == claim.session) return;
            if (claim.session == session_) ++turns_;
          },
          {.found =
               [this](const auto& writer) {
                 const std::lock_guard lock(writers_mutex_);
                 writers_[prefixOf(writer)] = Clock::now();
               },
           .left =
               [this](const auto& writer) {
                 const std::lock_guard lock(writers_mutex_);
                 writers_.erase(prefixOf(writer));
               }}) {}

bool DdsClaim::hasDiscoveredClaimants() const {
  if (has_discovered_claimants_) return true;
  const Clock::time_point now = Clock::now();
  if (now - joined_ < kSharedListenFactor * kShortListenTime) return false;
  if (neighbours_.possibleConflicts(groom_id_, true) > 0 && now - joined_ < settle_time_) return false;
  const DdsNeighbours::Times claimants = neighbours_.claimants(groom_id_);
  const std::lock_guard lock(writers_mutex_);
  const bool all = std::all_of(claimants.begin(), claimants.end(), [&](const auto& claimant) {
    const auto writer = writers_.find(claimant.first);
    if (writer != writers_.end()) return now - writer->second >= kFirstClaim;
    return now - claimant.second >= kConflictListenTime;
  });
  if (all) has_discovered_claimants_ = true;
  return all;
}

uint64_t DdsClaim::turn() const {
  return holder_ == session_ && hasDiscoveredClaimants() ? turns_.load() : 0;
}

CastingState DdsClaim::castingState() const {
  if (!hasDiscoveredClaimants()) return CastingState::kUnknown;
  const uint64_t holder = holder_;
  if (holder == session_) return CastingState::kOwn;
  const bool is_alive = holder != 0 && Clock::now() - heard_.load() < kClaimSilence;
  return is_alive ? CastingState::kOther : CastingState::kUnclaimed;
}

bool DdsClaim::yields() const {
  return !thread_.joinable() && holder_is_equal_ && castingState() == CastingState::kOther;
}

bool DdsClaim::isOfClaimant(const StatusBoard::WriterId& writer) const {
  const std::lock_guard lock(writers_mutex_);
  return writers_.contains(prefixOf(writer));
}

void DdsClaim::join(DdsParticipant& participant, std::chrono::milliseconds settle_time) {
  joined_ = Clock::now();
  settle_time_ = settle_time;
  participant.createReader(kClaimTopic, new WireType<Claim>, &listener_);
  writer_ = participant.createWriter(kClaimTopic, new WireType<Claim>, nullptr, strength_);
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

bool DdsClaim::isLate() const {
  const Clock::time_point written = written_;
  return written != Clock::time_point() && Clock::now() - written > kStallTimeout;
}

bool DdsClaim::hasStalled() const { return thread_.joinable() && (stalled_ || isLate()); }

void DdsClaim::resetClaims() {
  stop();
  stop_ = false;
  stalled_ = false;
  written_ = Clock::time_point();
}

void DdsClaim::restartClaims() {
  resetClaims();
  claim();
}

void DdsClaim::rejoin() {
  resetClaims();
  holder_ = 0;
  has_discovered_claimants_ = false;
  joined_ = Clock::now();
}

void DdsClaim::write() {
  Claim sample{session_, groom_id_};
  std::unique_lock lock(mutex_);
  do {
    if (isLate()) stalled_ = true;
    if (stalled_) break;
    lock.unlock();
    writer_->write(&sample);
    written_ = Clock::now();
    lock.lock();
  } while (!wake_.wait_for(lock, kClaimPeriod, [&] { return stop_; }));
}

}  // namespace strandcast
