#pragma once
#include <atomic>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "apps/settings.h"
#include "transport/recording/recording.h"

namespace strandcast {

/// The source that a daemon's recording keeps for resimulation: the daemon's arguments, the folder of
/// relative paths, and the text of the configuration file. `backend` and `device` as in Status.
std::string simulationSource(const std::vector<std::string>& words, const SettingsOptions& options,
                             const std::string& backend, const std::string& device);

/// The results of a resimulation.
struct ResimulationReport {
  std::string backend, device, recorded_device;
  uint64_t frames = 0;     ///< frames compared
  uint64_t different = 0;  ///< frames whose positions differ from the recorded ones in any bit
  uint64_t first_different = 0;
  uint64_t inputs = 0;  ///< commands that were replayed
};

/// Simulates a daemon's recording (`strandcastd --record`) again, with the same settings and the same
/// commands before the same frames, and compares the hash of each frame. Throws Error where the recording has
/// no source, or where its groom differs from the one that the settings make now. `frame_done` is called with
/// the number of frames compared and the simulation; an Error from it ends the resimulation.
ResimulationReport resimulate(Recording& recording, const std::string& name, const std::atomic<bool>& stop,
                              const std::function<void(uint64_t frames, Simulation&)>& frame_done);

}  // namespace strandcast
