#pragma once
#include <condition_variable>
#include <deque>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "transport/subscriber.h"

namespace strandcast {

/// What became of a command.
struct CommandOutcome {
  uint64_t id;
  CommandKind kind;
  std::string name;
  std::string refusal;  ///< empty where it was carried out
};

/// Sends commands from a thread of its own, one after the other, each until the daemon has answered. Of those
/// that wait, one of the same kind and name takes the place of an older one: a slider that is dragged sends
/// its newest value.
class CommandSender {
 public:
  explicit CommandSender(Subscriber& subscriber);  ///< which outlives it
  ~CommandSender();

  /// Returns the command's id.
  uint64_t send(CommandKind kind, const std::string& name, std::vector<double> values);
  /// Without an answer yet.
  size_t waiting() const;
  /// Those since the last call.
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
