#include "service/command_executor.h"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <optional>

#include "core/error.h"
#include "service/commands.h"
#include "transport/commands.h"

namespace strandcast {
namespace {

/// The single value of a command, a whole number within [low, high].
int wholeNumber(const Command& command, int low, int high, const std::string& where) {
  const bool one = command.values.size() == 1;
  if (!one || !(command.values[0] >= low && command.values[0] <= high) ||
      std::fmod(command.values[0], 1) != 0)
    throw Error(fmt::format("give one whole number from {} to {}", low, high), where, "");
  return static_cast<int>(command.values[0]);
}

}  // namespace

void CommandExecutor::execute(const Command& command) {
  const CommandKind kind = command.kind;
  if (kind == CommandKind::kReset || kind == CommandKind::kPause || kind == CommandKind::kShutdown)
    dropSteps("reset, pause, go and stop cancel pending steps");
  if (kind == CommandKind::kShutdown) dropBodies();
  const std::string refusal = errorTextOf([&] { apply(command); });
  const bool takes_time = kind == CommandKind::kStep || kind == CommandKind::kAddColliderFile;
  const bool has_begun = takes_time && refusal.empty();
  if (!has_begun) answer_(command.id, refusal);
}

void CommandExecutor::apply(const Command& command) {
  const std::string where = commandText(command);
  switch (command.kind) {
    case CommandKind::kSetParameter:
      controlled_.parameters.set(command, where);
      return reportParameters();
    case CommandKind::kHeadPose:
      controlled_.poses.checkHeadFree(where);
      return controlled_.head.moveTo(command, where);
    case CommandKind::kHeadMotion:
      controlled_.poses.checkHeadFree(where);
      return controlled_.head.play(command);
    case CommandKind::kReset:
      controlled_.reset();
      return report_.reset();
    case CommandKind::kShutdown:
      shutdown_ = true;
      return;
    case CommandKind::kPause:
      return controlled_.steps.pause(wholeNumber(command, 0, 1, where) == 1);
    case CommandKind::kStep:
      controlled_.steps.checkPaused(where);
      return controlled_.steps.request(command.id, where, wholeNumber(command, 1, kMaxRequestedSteps, where));
    case CommandKind::kPull:
      return controlled_.hand.pull(command, where);
    case CommandKind::kAddCollider:
      controlled_.colliders.add(command, where);
      return reportParameters();
    case CommandKind::kAddColliderFile:
      return controlled_.colliders.addFile(command, where);
    case CommandKind::kMoveCollider:
      controlled_.poses.checkBodyFree(command.name, where);
      return controlled_.colliders.move(command, where);
    case CommandKind::kRemoveCollider:
      controlled_.colliders.remove(command, where);
      return reportParameters();
    case CommandKind::kAddWindSource:
      controlled_.wind.add(command, where);
      return reportParameters();
    case CommandKind::kMoveWindSource:
      return controlled_.wind.move(command, where);
    case CommandKind::kRemoveWindSource:
      controlled_.wind.remove(command, where);
      return reportParameters();
  }
  throw Error("unknown kind of command", where, "is the sender newer than this daemon?");
}

void CommandExecutor::addMadeBodies() {
  while (const std::optional<ColliderRegistry::MadeResult> made = controlled_.colliders.addNextMade()) {
    if (made->refusal.empty()) reportParameters();
    answer_(made->command, made->refusal);
  }
}

bool CommandExecutor::waitUntilBodiesMade(const std::atomic<bool>& stop) {
  constexpr std::chrono::milliseconds kPollInterval{20};
  for (; controlled_.colliders.isMaking(); addMadeBodies()) {
    if (stop) return false;
    controlled_.colliders.waitForMade(kPollInterval);
  }
  return true;
}

void CommandExecutor::dropBodies() {
  controlled_.colliders.stopMaking();
  addMadeBodies();
}

void CommandExecutor::dropSteps(const std::string& why) {
  for (StepSchedule& steps = controlled_.steps; !steps.requests().empty(); steps.pop()) {
    const auto& [command, where, left] = steps.requests().front();
    const Error refusal(fmt::format("{} steps were not taken", left), where, why);
    answer_(command, refusal.what());
  }
}

}  // namespace strandcast
