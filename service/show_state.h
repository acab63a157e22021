// Shows of a daemon's state, and the state of a daemon from a show (docs/wire.md, "ShowChunk").
#pragma once
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "service/controls.h"
#include "service/status_report.h"
#include "transport/show.h"

namespace strandcast {

/// The colliders of shows: makes and removes those of a daemon until it has those of a show. A collider that
/// cannot be made here, or has another mesh here, is missing.
class ShowColliders {
 public:
  /// `simulation` and its `registry` must outlive this.
  ShowColliders(uint32_t groom_id, Simulation& simulation, ColliderRegistry& registry)
      : groom_id_(groom_id), simulation_(simulation), registry_(registry) {}

  void addEntries(std::vector<ShowEntry>& entries) const;
  /// Throws Error on entries that make no sense.
  void apply(const Show& show);
  /// Whether the command is one of apply(), which makes a collider from a file. A refused one is missing.
  bool takeAnswer(uint64_t command, const std::string& refusal);
  /// Whether a collider is still being made from its file.
  bool isMaking() const { return registry_.isMaking(); }
  /// Names of the missing colliders, with the show's mesh hash; 0 = the show has none.
  const std::map<std::string, uint64_t>& missing() const { return missing_; }

 private:
  void add(const ShowEntry& entry);
  /// Records a missing collider, with a warning. Empty refusal: no effect.
  void recordMissing(const ShowEntry& entry, const std::string& refusal);
  /// Throws Error where the show's mesh hash differs from that of the collider made here.
  void checkMesh(const ColliderMaker::Made& made) const;

  const uint32_t groom_id_;
  Simulation& simulation_;
  ColliderRegistry& registry_;
  std::map<uint64_t, ShowEntry> in_work_;         ///< entries of colliders from files, by id of the command
  std::map<std::string, uint64_t> missing_;       ///< see missing()
  std::map<std::string, uint64_t> shown_meshes_;  ///< mesh hashes of the newest show; 0 = the show has none
};

/// Makes shows of a daemon's state and takes shows over. Not thread-safe.
class ShowState {
 public:
  /// `fingerprint`: of scene and settings; equal for all daemons that share the groom. `controlled` and
  /// `report` must outlive this.
  ShowState(const Settings& settings, std::vector<ShowEntry> fingerprint, ControlledSimulation& controlled,
            StatusReport& report);
  ShowState(const ShowState&) = delete;  // checks of bodies that are being made refer to colliders()
  ShowState& operator=(const ShowState&) = delete;

  /// The state that a standby needs to go on in place of this daemon. `with_hair`: including the strand
  /// state.
  Show make(bool with_hair);
  /// Takes a show over, and returns how far this daemon's hair is behind it before the present frame, s of
  /// simulation time. Throws Error where the show is not of this scene or has invalid entries.
  [[nodiscard]] double restoreFrom(const Show& show);

  /// Keeps the answer for the next shows.
  void recordAnswer(uint64_t command, const std::string& refusal);
  /// The newest commands and their refusals, oldest first; an empty refusal means executed.
  const std::deque<std::pair<uint64_t, std::string>>& answers() const { return answers_; }
  /// Whether the command was answered, or its steps are outstanding.
  bool knows(uint64_t command) const;
  /// s of simulation time from this daemon to the newest show without hair; negative: the daemon is ahead.
  double lag() const { return lag_; }
  ShowColliders& colliders() { return colliders_; }

 private:
  /// Moves to the show's time where this daemon is far from it. Returns as restoreFrom().
  double syncTime(double time);

  const uint32_t groom_id_;
  const double rate_;  ///< frames per second
  const std::vector<ShowEntry> fingerprint_;
  ControlledSimulation& controlled_;
  StatusReport& report_;
  ShowColliders colliders_;
  std::deque<std::pair<uint64_t, std::string>> answers_;
  std::optional<uint64_t> session_;  ///< of the show applied last
  double lag_ = 0;
};

}  // namespace strandcast
