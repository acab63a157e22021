#include "service/groom_sharing.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "service/show_fingerprint.h"
#include "transport/commands.h"

namespace strandcast {
namespace {

using SharingClock = std::chrono::steady_clock;
constexpr std::chrono::milliseconds kShowPeriod{100};
constexpr size_t kAnswersRepeated = 16;

}  // namespace

GroomSharing::GroomSharing(const Settings& settings, const Scene& scene, ControlledSimulation& controlled,
                           StatusReport& report, Publisher& publisher)
    : groom_id_(settings.groom_id),
      rate_(settings.rate),
      simulation_(controlled.simulation),
      report_(report),
      publisher_(publisher),
      show_(settings,
            publisher.castingState() == CastingState::kUnshared ? std::vector<ShowEntry>()
                                                                : fingerprintOf(scene, settings),
            controlled, report) {
  if (publisher.castingState() != CastingState::kUnshared) state_ = State::kWaiting;
}

bool GroomSharing::hasAudience() const {
  return publisher_.castingState() == CastingState::kOwn && publisher_.sharers() > 0;
}

void GroomSharing::publishShow(bool with_hair) {
  if (hasAudience()) publisher_.publishShow(show_.make(with_hair));
}

void GroomSharing::publishShowIfDue() {
  if (!hasAudience()) return;
  if (publisher_.wantsHair()) publishShow(true);
  if (SharingClock::now() < show_due_) return;
  show_due_ = SharingClock::now() + kShowPeriod;
  publishShow(false);
}

bool GroomSharing::keepAnswer(uint64_t command, const std::string& refusal) {
  return show_.colliders().takeAnswer(command, refusal) || is_following_;
}

void GroomSharing::recordAnswer(uint64_t command, const std::string& refusal) {
  show_.recordAnswer(command, refusal);
  publishShow(false);
}

void GroomSharing::waitForShow() {
  spdlog::warn("groom {}: this daemon was suspended and lost its claim; it waits for the show", groom_id_);
  state_ = State::kWaiting;
  has_own_hair_ = true;
  is_following_ = logged_wait_ = warned_wait_ = false;
  waits_since_ = SharingClock::now();
  queued_commands_.clear();
}

bool GroomSharing::join(CastingState turn, double& time_accumulator) {
  if (turn == CastingState::kUnclaimed || turn == CastingState::kOwn) {
    if (logged_wait_)
      spdlog::warn("groom {} has no publisher any more and no show was received: this daemon {}", groom_id_,
                   has_own_hair_ ? "continues with its own hair" : "starts from the rest shape");
    state_ = State::kParticipating;
    return true;
  }
  while (std::optional<Show> show = publisher_.takeShow()) {
    if (!show->hasHair() && !has_own_hair_) continue;
    time_accumulator = show_.restoreFrom(*show);
    spdlog::info("continues the show of session {:016x} at {:.1f} s", show->session, show->simulation_time);
    is_following_ = true;
    state_ = State::kCatchingUp;
    shows_in_tolerance_ = 0;
    return true;
  }
  logWait();
  return false;
}

void GroomSharing::logWait() {
  constexpr std::chrono::milliseconds kNotableWait{500};
  constexpr std::chrono::seconds kTooLong{10};
  const auto waited = SharingClock::now() - waits_since_;
  if (!logged_wait_ && waited > kNotableWait) {
    logged_wait_ = true;
    spdlog::info(
        "another daemon publishes groom {}: this daemon waits for its show and may take over after that",
        groom_id_);
  }
  if (!warned_wait_ && waited > kTooLong) {
    warned_wait_ = true;
    spdlog::warn(
        "no show of groom {} was received for {} s: is the publishing daemon older, or without the keys for "
        "it? This daemon stands by, and publishes when that daemon ends",
        groom_id_, kTooLong.count());
  }
}

void GroomSharing::follow(double& time_accumulator) {
  is_following_ = true;
  while (std::optional<Command> command = publisher_.takeCommand()) {
    if (command->kind == CommandKind::kShutdown) shutdown_ = true;
    if (queued_commands_.size() < kMaxQueuedCommands) queued_commands_.push_back(std::move(*command));
  }
  while (std::optional<Show> show = publisher_.takeShow()) {
    if (show->hasHair()) continue;
    time_accumulator = show_.restoreFrom(*show);
    std::erase_if(queued_commands_, [&](const Command& command) { return show_.knows(command.id); });
    // The first shows after the hair may have been queued while this daemon was busy: their time is stale.
    constexpr int kMinShowsInTolerance = 3;
    const bool is_there = std::fabs(show_.lag()) < 3 / rate_ && ++shows_in_tolerance_ >= kMinShowsInTolerance;
    const bool has_all = show_.colliders().missing().empty();
    if (state_ == State::kParticipating && !has_all) {  // daemons with all colliders have precedence
      state_ = State::kCatchingUp;
      publisher_.withdrawClaim();
    }
    const bool is_ready =
        state_ == State::kCatchingUp && is_there && !show_.colliders().isMaking() && has_all;
    if (is_ready && publisher_.yields()) {
      if (!std::exchange(logged_equal_, true))
        spdlog::info(
            "the publishing daemon of groom {} has an equal claim: this daemon publishes when that daemon "
            "ends",
            groom_id_);
    } else if (is_ready) {
      state_ = State::kParticipating;
    }
  }
}

std::vector<Command> GroomSharing::takeOver() {
  if (!is_following_) return {};
  is_following_ = false;
  state_ = State::kParticipating;
  spdlog::info("takes over groom {} at {:.1f} s", groom_id_, simulation_.time());
  for (const auto& [name, mesh] : show_.colliders().missing())
    spdlog::warn("the show continues without collider {}", name);
  // The senders of these commands may not have received the answers.
  const auto& answers = show_.answers();
  const size_t repeated = std::min(answers.size(), kAnswersRepeated);
  for (auto answer = answers.end() - static_cast<ptrdiff_t>(repeated); answer != answers.end(); ++answer) {
    report_.setAnswer(answer->first, answer->second);
    publisher_.publishStatus(report_.status());
  }
  return std::exchange(queued_commands_, {});
}

}  // namespace strandcast
