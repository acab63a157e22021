#include "apps/viewer/command_sender.h"

#include <algorithm>

#include "apps/daemon.h"
#include "core/error.h"

namespace strandcast {
namespace {

constexpr std::chrono::seconds kPatience{5};

}  // namespace

CommandSender::CommandSender(Subscriber& subscriber) : subscriber_(subscriber), thread_([this] { run(); }) {}

CommandSender::~CommandSender() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

uint64_t CommandSender::send(CommandKind kind, const std::string& name, std::vector<double> values) {
  Command command;
  const uint64_t id = newSession();
  command.id = id;
  command.kind = kind;
  command.name = name;
  command.values = std::move(values);
  {
    const std::lock_guard lock(mutex_);
    std::erase_if(queue_, [&](const Command& other) {
      return other.kind == kind && other.name == name && kind != CommandKind::kStep;
    });
    queue_.push_back(std::move(command));
  }
  changed_.notify_all();
  return id;
}

size_t CommandSender::waiting() const {
  const std::lock_guard lock(mutex_);
  return queue_.size() + (asking_ ? 1 : 0);
}

std::vector<CommandOutcome> CommandSender::takeOutcomes() {
  const std::lock_guard lock(mutex_);
  return std::exchange(outcomes_, {});
}

void CommandSender::run() {
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [&] { return stop_ || !queue_.empty(); });
    if (stop_) return;
    const Command command = queue_.front();
    queue_.pop_front();
    asking_ = true;
    lock.unlock();
    const auto deadline = std::chrono::steady_clock::now() + kPatience;
    CommandOutcome outcome{command.id, command.kind, command.name, "the daemon did not answer"};
    try {
      const auto answer = ask(subscriber_, command, [&] {
        const std::lock_guard stopping(mutex_);
        return stop_ || std::chrono::steady_clock::now() > deadline;
      });
      if (answer) outcome.refusal = *answer;
    } catch (const Error& error) {
      outcome.refusal = error.what();
    }
    lock.lock();
    asking_ = false;
    outcomes_.push_back(std::move(outcome));
  }
}

}  // namespace strandcast
