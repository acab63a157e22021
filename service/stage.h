// Daemons of several grooms in one process, and the road of each from its claim to its end.
#pragma once
#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "options/settings.h"
#include "service/daemon.h"
#include "service/network.h"
#include "service/rate_budget.h"
#include "transport/publisher.h"
#include "transport/recording/recorder.h"

namespace strandcast {

/// Joins a network as the daemon of settings.groom_id: joinAsDaemon(), or a channel of a test.
using DaemonChannel = std::function<std::unique_ptr<Publisher>(const Settings& settings, uint64_t session)>;
/// The source that a recording keeps for resimulation (simulationSource()), of a groom id, a backend and a
/// device as in Status.
using RecordingSource =
    std::function<std::string(uint32_t groom_id, const std::string& backend, const std::string& device)>;

/// How a character ended.
struct CharacterEnding {
  std::string character;  ///< CharacterSettings::label()
  uint32_t groom_id = 0;
  std::optional<DaemonSummary> summary;  ///< none: it never cast
  std::string failure;                   ///< why it never cast, or ended on its own; else empty
  std::string recording_failure;         ///< empty where all was recorded, or nothing was to be
  bool is_kept = true;                   ///< whether recording and LCM log hold all that was cast
};

/// A daemon from its claim to its end: its channel, scene, recording and summary. Call each step once, in
/// this order; cast() may run in another thread.
class Character {
 public:
  /// Checks that the recording can be written, and claims the groom: other daemons hear of it while this one
  /// loads. Throws Error.
  explicit Character(const CharacterSettings& character, const DaemonChannel& join = joinAsDaemon);
  Character(const Character&) = delete;
  Character& operator=(const Character&) = delete;
  /// Makes scene and simulation, with a progress bar. Throws Error; Interrupted or BakeStopped on Ctrl-C.
  void load();
  /// Waits until no other daemon of the groom would have been heard, begins the recording, and announces
  /// groom and body. Throws as load().
  void announce(const RecordingSource& source);
  /// Casts until `stop`, a shutdown command, settings.duration or a failure, and closes the recording.
  CharacterEnding cast(const std::atomic<bool>& stop);

  const CharacterSettings& settings() const { return character_; }
  /// After load().
  Daemon& daemon() { return *daemon_; }
  /// After load(); null where nothing is recorded.
  RecordingPublisher* recording() { return recording_; }

 private:
  const CharacterSettings character_;
  const uint64_t session_;
  std::unique_ptr<Publisher> publisher_;
  RecordingPublisher* recording_ = nullptr;  ///< publisher_, where it records
  GroomClaim claim_;
  std::unique_ptr<Daemon> daemon_;
};

/// Gives characters without a budget or a number of threads their equal share of `cores` processors. With one
/// character nothing changes. Results do not depend on either.
void shareMachine(std::vector<CharacterSettings>& characters, unsigned cores);

/// Casts several characters in one process. Each has a Daemon, a channel and a thread of its own, so none
/// waits for another's frames; a StagePressure makes those above their budget wait where the machine is too
/// slow for all. One that fails to load, or ends, leaves the others as they are.
///
/// All are claimed first, then loaded one after another, and cast from then on: loading takes all processors,
/// and would make frames late.
class Stage {
 public:
  /// Budgets are those of shareMachine().
  Stage(std::vector<CharacterSettings> characters, RecordingSource source, DaemonChannel join = joinAsDaemon)
      : characters_(std::move(characters)), source_(std::move(source)), join_(std::move(join)) {}
  /// Returns when every character has ended, by `stop`, a shutdown command, its duration or a failure. Logs
  /// a line for each that fails; lines about a character begin with its label. Throws Interrupted or
  /// BakeStopped on Ctrl-C before any casts. Endings are in the order of the characters. Call once.
  std::vector<CharacterEnding> run(const std::atomic<bool>& stop);

 private:
  const std::vector<CharacterSettings> characters_;
  const RecordingSource source_;
  const DaemonChannel join_;
  StagePressure pressure_;
};

}  // namespace strandcast
