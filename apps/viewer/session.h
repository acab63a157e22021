// The viewer's stream: commands to its daemon, other daemons on the network, slices and recordings.
#pragma once
#include <atomic>
#include <condition_variable>
#include <deque>
#include <filesystem>
#include <future>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "options/presets.h"
#include "options/settings.h"
#include "service/slices.h"
#include "service/stream.h"
#include "transport/subscriber.h"

namespace strandcast {

/// The outcome of a command.
struct CommandOutcome {
  uint64_t id;
  CommandKind kind;
  std::string name;
  std::string refusal;  ///< empty on success
};

/// Sends commands from its own thread, one after the other, each until the daemon has answered. A queued
/// command is replaced by a newer one of the same kind and name: a slider that is dragged sends its newest
/// value.
class CommandSender {
 public:
  explicit CommandSender(Subscriber& subscriber);  ///< must outlive this
  ~CommandSender();

  /// Returns the command's id.
  uint64_t send(CommandKind kind, const std::string& name, std::vector<double> values);
  /// Number of commands without an answer.
  size_t waiting() const;
  /// Outcomes since the last call.
  std::vector<CommandOutcome> takeOutcomes();

 private:
  void run();

  Subscriber& subscriber_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Command> queue_;
  bool asking_ = false, stop_ = false;
  std::vector<CommandOutcome> outcomes_;
  std::thread thread_;
};

/// The daemons on a network. Listening starts in the background on the first call of listen().
class NetworkList {
 public:
  /// Listens on the network of these settings.
  explicit NetworkList(const Settings& settings) : settings_(settings) {}
  void listen();
  bool listens() const { return subscriber_ != nullptr || joining_.valid(); }
  /// The newest status of each daemon; empty until one was heard.
  std::vector<Status> daemons();
  const std::string& problem() const { return problem_; }  ///< why listening failed; empty otherwise

 private:
  const Settings settings_;
  std::future<std::unique_ptr<Subscriber>> joining_;
  std::unique_ptr<Subscriber> subscriber_;
  std::string problem_;
};

/// The slice through the air that the viewer shows.
struct SliceRequest {
  AirQuantity quantity = AirQuantity::kWind;
  int axis = 2;
};

/// The stream that the viewer shows: receives frames, sends commands, and tracks the state of the simulation
/// behind it. Not thread-safe: one thread, which calls takeOutcomes() once per picture.
class ViewerSession {
 public:
  /// Waits for groom and body; throws Error after `timeout` seconds.
  ViewerSession(const Settings& settings, bool here, double timeout, Playout playout);
  ~ViewerSession();

  Subscriber& subscriber() { return stream_.subscriber(); }
  void checkAlive() const { stream_.checkAlive(); }
  FramePlayer& player() { return player_; }
  CommandSender& commands() { return commands_; }
  bool isHere() const { return here_; }  ///< the simulation is in this process
  uint32_t groomId() const { return groom_id_; }

  /// Outcomes of commands since the last call. Also updates the daemon's parameters from its newest status.
  std::vector<CommandOutcome> takeOutcomes();
  /// The daemon's parameters in its order; those that this program does not know have only a name. Until the
  /// first status, the parameters of a simulation.
  const std::vector<ParameterInfo>& settable() const { return settable_; }
  /// The value of a parameter: the one sent, until the daemon has answered, else the one of its newest
  /// status.
  std::optional<std::vector<double>> parameter(const std::string& name) const;
  void setParameter(const std::string& name, const std::vector<double>& values);
  /// The value that resets return to: that of the daemon's first status, else the default.
  std::vector<double> usualParameter(const std::string& name) const;
  /// The known parameters of a simulation, as a preset stores them.
  NamedValues parameters() const;

  /// Requests slices of a simulation in this process, a few times a second, until the request is empty.
  void requestSlice(const std::optional<SliceRequest>& request);
  /// The newest slice since the last call, or the reason why there is none.
  std::optional<AirSlice> takeSlice();
  std::string sliceProblem() const;

  /// Records frames from now on; throws Error.
  void startRecording(const std::filesystem::path& file);
  void stopRecording();
  bool records() const { return recording_.joinable(); }
  double recordedSeconds() const { return recorded_seconds_; }
  std::string recordingProblem() const;

 private:
  /// A command without an answer yet.
  struct Sent {
    uint64_t id;
    std::vector<double> values;
  };
  void observe(Simulation& simulation);
  void takeParameters();

  const bool here_;
  const uint32_t groom_id_;
  uint64_t received_from_ = 0;  // session of received_values_
  std::map<std::string, std::vector<double>> received_values_, initial_values_;
  std::map<std::string, Sent> sent_;
  std::vector<ParameterInfo> settable_ = parameterList();
  mutable std::mutex mutex_;  // guards the members below, except the stream
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
