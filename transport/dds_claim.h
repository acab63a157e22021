#pragma once
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <map>
#include <mutex>
#include <thread>

#include "transport/dds_neighbours.h"
#include "transport/dds_participant.h"
#include "transport/wire_type_support.h"

namespace strandcast {

/// Which of several daemons casts a groom, by DDS's exclusive ownership: each writes its session to the topic
/// strandcast/claim, and a reader is given only what the strongest live writer wrote (of equals, the one of
/// the lower GUID).
class DdsClaim {
 public:
  DdsClaim(uint32_t groom_id, uint64_t session, uint32_t strength, const DdsNeighbours& neighbours);
  ~DdsClaim() { stop(); }
  /// Is known for a claimant from now on, and knows the others. Where programs are there that say no role, it
  /// is nobody's turn here for the time that such a one may take to be heard, `settles`. `participant` is
  /// taken down between stop() and the end of this.
  void join(DdsParticipant& participant, std::chrono::milliseconds settles);
  /// Claims from now on, in a thread of its own: a weaker one falls silent at once. Again, it changes
  /// nothing.
  void claim();
  void stop();
  /// Whether so long has passed between two claims of this daemon that others have taken its turn. From then
  /// on it claims nothing, until claimAgain() or joinAgain().
  bool hasStoodStill() const;
  void claimAgain();    ///< as before
  void forgetClaims();  ///< of its own, and claims no more, until claim()
  void joinAgain();     ///< as after join(): not before claim()

  /// How often it has become this daemon's turn, where it is; else 0.
  uint64_t turn() const;
  /// Whose turn it is, as far as is known.
  SharedTurn sharedTurn() const;
  /// Whether this daemon, which claims nothing yet, is to leave it so as long as the one casts whose turn it
  /// is: that one claims with the same strength, and DDS would choose between the two by their GUIDs.
  bool yields() const;
  /// The session whose claim was heard last; 0 where none was.
  uint64_t holder() const { return holder_; }
  /// Whether the program that this writer of any topic is of claims the groom too.
  bool isClaimants(const StatusBoard::WriterId& writer) const;

 private:
  using Clock = std::chrono::steady_clock;
  void write();
  bool isLate() const;
  /// Whether every claimant that is there has had the time to be heard.
  bool hasHeardOthers() const;

  const uint32_t groom_id_;
  const uint64_t session_;
  const uint32_t strength_;
  const DdsNeighbours& neighbours_;
  std::atomic<uint64_t> holder_{0};
  std::atomic<bool> holder_is_equal_{false};  // in strength
  std::atomic<uint64_t> turns_{0};
  std::atomic<Clock::time_point> heard_{Clock::time_point()};  // the newest claim
  mutable std::atomic<bool> has_heard_others_{false};
  Clock::time_point joined_;
  std::chrono::milliseconds settles_{0};
  mutable std::mutex writers_mutex_;
  std::map<DdsNeighbours::Prefix, Clock::time_point> writers_;  // of claims, that are there, and since when
  TakingListener<v6::Claim> listener_;
  eprosima::fastdds::dds::DataWriter* writer_ = nullptr;
  std::mutex mutex_;
  std::condition_variable wake_;
  bool stop_ = false;
  std::atomic<Clock::time_point> written_{Clock::time_point()};  // the newest claim of its own
  std::atomic<bool> stood_still_{false};
  std::thread thread_;
};

}  // namespace strandcast
