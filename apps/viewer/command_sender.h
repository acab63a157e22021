#pragma once
#include <condition_variable>
#include <deque>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

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

}  // namespace strandcast
