// The part that a daemon has among daemons that share a groom: one casts and publishes its show, the others
// follow.
#pragma once
#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "service/show_state.h"
#include "transport/publisher.h"

namespace strandcast {

/// Decides whether a daemon waits, follows or casts. A daemon that starts waits for the show (join()),
/// follows it until it is at its time, and claims the groom from then on. A daemon that does not share its
/// groom (CastingState::kUnshared) always casts. Not thread-safe.
class GroomSharing {
 public:
  /// The other objects must outlive this.
  GroomSharing(const Settings& settings, const Scene& scene, ControlledSimulation& controlled,
               StatusReport& report, Publisher& publisher);
  GroomSharing(const GroomSharing&) = delete;
  GroomSharing& operator=(const GroomSharing&) = delete;

  /// Whether this daemon has no show yet: it simulates nothing, and calls join() each frame.
  bool isWaiting() const { return state_ == State::kWaiting; }
  /// Whether this daemon publishes its frames, which claims the groom.
  bool isParticipating() const { return state_ == State::kParticipating; }
  /// Whether another daemon casts.
  bool isFollowing() const { return is_following_; }
  /// Whether this daemon has to follow in this frame. A standby that has not yet heard all claimants does not
  /// take over.
  bool mustFollow(CastingState turn) const {
    return turn == CastingState::kOther || (turn == CastingState::kUnknown && is_following_);
  }
  /// Whether a command has ended all daemons that share the groom.
  bool isShutDown() const { return shutdown_; }

  // In the next two `time_accumulator` is the daemon's, s of simulation time that its steps have yet to
  // cover; a show sets it. Both throw Error as ShowState::restoreFrom(): the daemon then has to end.

  /// Ends the waiting, and returns true, once this daemon has the casting daemon's show, or nobody casts.
  bool join(CastingState turn, double& time_accumulator);
  /// While another daemon casts: applies its show, and queues commands in case this daemon takes over.
  void follow(double& time_accumulator);
  /// After this daemon stood still and lost its turn: waits for the show again.
  void waitForShow();
  /// Takes over casting where this daemon has followed: repeats recent answers, and returns the queued
  /// commands, to be executed.
  std::vector<Command> takeOver();

  /// Whether an answer stays in this daemon: another daemon answers, or it was a command of the show itself.
  bool keepAnswer(uint64_t command, const std::string& refusal);
  /// Call before the answer is published: publishes a show that contains it.
  void recordAnswer(uint64_t command, const std::string& refusal);
  /// Publishes the show where this daemon casts and the show is due or hair is wanted.
  void publishShowIfDue();

 private:
  enum class State {
    kWaiting,       ///< waits for the show; claims nothing
    kCatchingUp,    ///< has the show and catches up with its time; claims nothing
    kParticipating  ///< claims, and casts on its turn
  };
  /// Whether this daemon casts and others share the groom.
  bool hasAudience() const;
  void publishShow(bool with_hair);
  void logWait();

  const uint32_t groom_id_;
  const double rate_;  ///< frames per second
  const Simulation& simulation_;
  StatusReport& report_;
  Publisher& publisher_;
  ShowState show_;
  State state_ = State::kParticipating;
  bool is_following_ = false, shutdown_ = false;
  bool has_own_hair_ = false;             ///< has cast and then stood still: a show without hair suffices
  std::vector<Command> queued_commands_;  ///< received while another daemon casts
  int shows_in_tolerance_ = 0;            ///< shows without hair received within tolerance since the hair
  std::chrono::steady_clock::time_point show_due_{}, waits_since_ = std::chrono::steady_clock::now();
  bool logged_wait_ = false, warned_wait_ = false, logged_equal_ = false;
};

}  // namespace strandcast
