#pragma once
#include <atomic>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "apps/settings.h"
#include "transport/recording/recording.h"

namespace strandcast {

/// What a recording of a daemon keeps so that it can be simulated again: the daemon's words, the folder that
/// relative paths start from, the text of the configuration file. `backend` and `device` as in Status.
std::string simulationSource(const std::vector<std::string>& words, const SettingsOptions& options,
                             const std::string& backend, const std::string& device);

struct ResimulationReport {
  std::string backend, device, recorded_device;
  uint64_t frames = 0;     ///< compared
  uint64_t different = 0;  ///< of these, whose positions are not bit for bit the recorded ones
  uint64_t first_different = 0;
  uint64_t inputs = 0;  ///< commands that were given again
};

/// Simulates a recording of a daemon (`strandcastd --record`) again, from the same settings and with the same
/// commands before the same frames, and compares the hash of each frame. Throws Error where the recording has
/// no source, or its groom is not the one that the settings make now. `frame_done` is told how many frames
/// were compared and given the simulation as the newest has it; an Error of its ends it.
ResimulationReport resimulate(Recording& recording, const std::string& name, const std::atomic<bool>& stop,
                              const std::function<void(uint64_t frames, Simulation&)>& frame_done);

}  // namespace strandcast
