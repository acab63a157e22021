#pragma once
#include <atomic>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "apps/air_slices.h"
#include "apps/channel.h"
#include "apps/presets.h"
#include "apps/viewer/command_sender.h"

namespace strandcast {

/// Which slice through the air the viewer wants to see.
struct SliceRequest {
  AirQuantity quantity = AirQuantity::kWind;
  int axis = 2;
};

/// A stream that the viewer shows: frames in, commands out, and what is known of the simulation behind it.
class ViewerSession {
 public:
  /// Waits until groom and body are known; throws Error after `timeout` seconds.
  ViewerSession(const Settings& settings, bool here, double timeout, Playout playout);
  ~ViewerSession();

  Subscriber& subscriber() { return stream_.subscriber(); }
  void checkAlive() const { stream_.checkAlive(); }
  FramePlayer& player() { return player_; }
  CommandSender& commands() { return commands_; }
  bool isHere() const { return here_; }  ///< the simulation is in this process
  uint32_t groomId() const { return groom_id_; }

  // Of one thread, which calls takeOutcomes() once a picture.

  /// What became of commands since the last call. Looks at what the daemon tells of its parameters.
  std::vector<CommandOutcome> takeOutcomes();
  /// The parameters that the daemon told, in its order; those that this program does not know have a name and
  /// no more. Until it has told any, those of a simulation.
  const std::vector<ParameterInfo>& settable() const { return settable_; }
  /// What a parameter is set to: what was sent, until that is answered, else what the daemon told.
  std::optional<std::vector<double>> parameter(const std::string& name) const;
  void setParameter(const std::string& name, const std::vector<double>& values);
  /// What resets go back to: as it was when the daemon was first heard, else as all simulations have it.
  std::vector<double> usualParameter(const std::string& name) const;
  /// Those of a simulation that are known, as a preset has them.
  NamedValues parameters() const;

  /// Slices of a simulation in this process, a few times a second, until nothing is asked for.
  void askForSlice(const std::optional<SliceRequest>& request);
  /// The newest since the last call, or why there is none.
  std::optional<AirSlice> takeSlice();
  std::string sliceProblem() const;

  /// Writes frames from now on; throws Error.
  void startRecording(const std::filesystem::path& file);
  void stopRecording();
  bool records() const { return recording_.joinable(); }
  double recordedSeconds() const { return recorded_seconds_; }
  std::string recordingProblem() const;

 private:
  /// A command that is not answered yet.
  struct Sent {
    uint64_t id;
    std::vector<double> values;
  };
  void observe(Simulation& simulation);
  void takeParameters();

  const bool here_;
  const uint32_t groom_id_;
  uint64_t told_by_ = 0;  // session
  std::map<std::string, std::vector<double>> told_, first_told_;
  std::map<std::string, Sent> sent_;
  std::vector<ParameterInfo> settable_ = parameterList();
  mutable std::mutex mutex_;  // of all below but the stream
  std::optional<SliceRequest> request_;
  std::optional<AirSlice> slice_;
  std::string slice_problem_, recording_problem_;
  std::chrono::steady_clock::time_point slice_due_{};
  std::atomic<bool> stop_recording_{false};
  std::atomic<double> recorded_seconds_{0};
  std::thread recording_;
  Stream stream_;
  FramePlayer player_;
  CommandSender commands_;
};

}  // namespace strandcast
