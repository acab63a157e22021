#pragma once
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <map>
#include <mutex>
#include <thread>

#include "transport/dds_neighbours.h"
#include "transport/dds_participant.h"
#include "transport/wire_fields.h"

namespace strandcast {

/// Elects the daemon that casts a shared groom by DDS's exclusive ownership: each claimant writes its session
/// to the topic strandcast/claim, and DDS gives a reader only the samples of the strongest live writer (of
/// equal ones, that of the lower GUID). That session holds the claim.
class DdsClaim {
 public:
  /// `strength`: ownership strength of its claims. `neighbours` must outlive this.
  DdsClaim(uint32_t groom_id, uint64_t session, uint32_t strength, const DdsNeighbours& neighbours);
  ~DdsClaim() { stop(); }
  /// Creates the writer and the reader of claims: from now on this daemon is discovered as a claimant and
  /// hears the others. Where participants without a role are present, the holder stays unknown for up to
  /// `settle_time`, so that they can be heard. `participant` must be destroyed between stop() and the
  /// destructor of this.
  void join(DdsParticipant& participant, std::chrono::milliseconds settle_time);
  /// Starts the thread that writes claims: a weaker claimant stops casting at once. Idempotent.
  void claim();
  /// Ends the thread that writes claims. Idempotent.
  void stop();
  /// Whether the pause between two claims of this daemon was so long that another one has taken over. It
  /// writes no more claims then, until restartClaims() or rejoin().
  bool hasStalled() const;
  void restartClaims();  ///< restarts the thread; the holder is kept
  void resetClaims();    ///< stops the thread until claim()
  void rejoin();         ///< as join(): forgets the holder, and claims nothing until claim()

  /// While this daemon holds the claim, how often it has gained it, from 1; else 0.
  uint64_t turn() const;
  /// Which daemon casts, as far as is known.
  CastingState castingState() const;
  /// Whether this daemon, which has not claimed yet, must not claim while the present holder casts: their
  /// strengths are equal, and DDS would choose between them by GUID.
  bool yields() const;
  /// The session of the newest claim heard; 0 before the first.
  uint64_t holder() const { return holder_; }
  /// Whether the participant of this writer (of any topic) also claims the groom.
  bool isOfClaimant(const StatusBoard::WriterId& writer) const;

 private:
  using Clock = std::chrono::steady_clock;
  void write();
  bool isLate() const;
  /// Whether every claimant present has had the time to be heard.
  bool hasDiscoveredClaimants() const;

  const uint32_t groom_id_;
  const uint64_t session_;
  const uint32_t strength_;
  const DdsNeighbours& neighbours_;
  std::atomic<uint64_t> holder_{0};
  std::atomic<bool> holder_is_equal_{false};  // whether the holder's strength is this daemon's
  std::atomic<uint64_t> turns_{0};
  std::atomic<Clock::time_point> heard_{Clock::time_point()};  // when the newest claim was heard
  mutable std::atomic<bool> has_discovered_claimants_{false};
  Clock::time_point joined_;
  std::chrono::milliseconds settle_time_{0};
  mutable std::mutex writers_mutex_;
  // Writers of claims, and when each was matched
  std::map<DdsNeighbours::Prefix, Clock::time_point> writers_;
  SampleListener<Claim> listener_;
  eprosima::fastdds::dds::DataWriter* writer_ = nullptr;
  std::mutex mutex_;
  std::condition_variable wake_;
  bool stop_ = false;
  std::atomic<Clock::time_point> written_{Clock::time_point()};  // when this daemon last wrote a claim
  std::atomic<bool> stalled_{false};
  std::thread thread_;
};

}  // namespace strandcast
