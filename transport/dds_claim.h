#pragma once
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <set>
#include <thread>

#include "transport/dds_participant.h"
#include "transport/wire_type_support.h"

namespace strandcast {

/// Which of several daemons casts a groom, by DDS's exclusive ownership: each writes its session to the topic
/// strandcast/claim, and a reader is given only what the strongest live writer wrote (of equals, the one of
/// the lower GUID).
class DdsClaim {
 public:
  DdsClaim(uint32_t groom_id, uint64_t session, uint32_t strength);
  ~DdsClaim() { stop(); }
  /// Is known for a claimant from now on, and knows the others; it is nobody's turn here for the time that
  /// they may take to be heard. `participant` is taken down between stop() and the end of this.
  void join(DdsParticipant& participant, std::chrono::milliseconds settles);
  /// Claims from now on, in a thread of its own: a weaker one falls silent at once. Again, it changes
  /// nothing.
  void claim();
  void stop();

  /// How often it has become this daemon's turn, where it is; else 0.
  uint64_t turn() const;
  /// Whether the program that this writer of any topic is of claims the groom too.
  bool isClaimants(const StatusBoard::WriterId& writer) const;

 private:
  void write();

  const uint32_t groom_id_;
  const uint64_t session_;
  const uint32_t strength_;
  std::atomic<uint64_t> holder_{0};  // session of the daemon whose turn it is; 0 while that is not known
  std::atomic<uint64_t> turns_{0};
  std::chrono::steady_clock::time_point settled_;
  mutable std::mutex writers_mutex_;
  std::set<StatusBoard::WriterId> writers_;  // of claims, that are there
  TakingListener<v6::Claim> listener_;
  eprosima::fastdds::dds::DataWriter* writer_ = nullptr;
  std::mutex mutex_;
  std::condition_variable wake_;
  bool stop_ = false;
  std::thread thread_;
};

}  // namespace strandcast
