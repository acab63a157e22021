// Execution of commands (docs/wire.md, "Command").
#pragma once
#include <atomic>
#include <cstdint>
#include <functional>
#include <string>

#include "service/controls.h"
#include "service/status_report.h"
#include "transport/messages.h"

namespace strandcast {

/// Executes commands on a simulation and answers each once. A refused command changes nothing. Most commands
/// are answered at once; those for single steps by the caller that takes the steps, those for colliders from
/// files by addMadeBodies(). Not thread-safe.
class CommandExecutor {
 public:
  /// An empty refusal means that the command was executed.
  using Answer = std::function<void(uint64_t command, const std::string& refusal)>;
  /// `controlled` and `report` must outlive the executor. The report has the new values before the answer.
  CommandExecutor(ControlledSimulation& controlled, StatusReport& report, Answer answer)
      : controlled_(controlled), report_(report), answer_(std::move(answer)) {}

  void execute(const Command& command);
  /// Whether a command has asked the daemon to end.
  bool isShutDown() const { return shutdown_; }

  /// Adds the bodies made from files so far and answers their commands.
  void addMadeBodies();
  /// Waits until all bodies from files are made. False when `stop` came first.
  bool waitUntilBodiesMade(const std::atomic<bool>& stop);
  /// Refuses the bodies from files that are not made yet.
  void dropBodies();
  /// Refuses the steps that are outstanding; `why` is the remedy in the answer.
  void dropSteps(const std::string& why);

 private:
  void apply(const Command& command);
  void reportParameters() { report_.setParameters(controlled_.table()); }

  ControlledSimulation& controlled_;
  StatusReport& report_;
  const Answer answer_;
  bool shutdown_ = false;
};

}  // namespace strandcast
