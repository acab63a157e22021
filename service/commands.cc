#include "service/commands.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/error.h"
#include "core/smooth_step.h"
#include "transport/parameter_table.h"

namespace strandcast {
namespace {

std::string wordsOf(CommandKind kind) {
  switch (kind) {
    case CommandKind::kSetParameter:
      return "set";
    case CommandKind::kHeadPose:
      return "head";
    case CommandKind::kHeadMotion:
      return "motion";
    case CommandKind::kReset:
      return "reset";
    case CommandKind::kShutdown:
      return "stop";
    case CommandKind::kPause:
      return "pause";
    case CommandKind::kStep:
      return "step";
    case CommandKind::kPull:
      return "pull";
    case CommandKind::kAddCollider:
    case CommandKind::kAddColliderFile:
      return "collider add";
    case CommandKind::kMoveCollider:
      return "collider move";
    case CommandKind::kRemoveCollider:
      return "collider remove";
    case CommandKind::kAddWindSource:
      return "fan add";
    case CommandKind::kMoveWindSource:
      return "fan move";
    case CommandKind::kRemoveWindSource:
      return "fan remove";
  }
  return "(unknown command)";
}

}  // namespace

std::string commandText(const Command& command) {
  std::string text = "strandcast ctl " + wordsOf(command.kind);
  if (command.kind == CommandKind::kPause && command.values == std::vector<double>{0})
    text = "strandcast ctl go";
  const bool has_file = command.kind == CommandKind::kAddColliderFile;  // after the collider's own name
  const std::string name = has_file ? command.name.substr(0, command.name.find(' ')) : command.name;
  return name.empty() ? text : text + ' ' + name;
}

Pose commandedPose(const std::vector<double>& values, size_t first, const std::string& where) {
  const double* const v = values.data() + first;
  if (!std::all_of(v, v + 3, [](double x) { return std::fabs(x) <= kFarthestPlace; }))
    throw Error("a position is too far away", where,
                fmt::format("give x y z in metres, each within {}", kFarthestPlace));
  const Quat rotation(Eigen::Quaterniond(v[6], v[3], v[4], v[5]).cast<float>());
  if (!(std::fabs(rotation.norm() - 1) < 0.5f))
    throw Error("a rotation is not a unit quaternion", where, "give x y z w, with squares that add up to 1");
  return {Vec3(Eigen::Vector3d(v[0], v[1], v[2]).cast<float>()), rotation.normalized()};
}

void appendPose(std::vector<double>& values, const Pose& pose) {
  for (int c = 0; c < 3; ++c) values.push_back(static_cast<double>(pose.position[c]));
  for (int c = 0; c < 4; ++c) values.push_back(static_cast<double>(pose.rotation.coeffs()[c]));
}

Pose poseBetween(const Pose& from, const Pose& to, double seconds, double of) {
  return interpolate(from, to, static_cast<float>(easedFraction(seconds, of)));
}

namespace {

double timeStepOf(const Status& status) {
  for (const auto& [name, values] : namedValues(status.parameters))
    if (name == "time_step") return values.front();
  return 0;
}

}  // namespace

bool AnswerWait::isOver(const std::optional<Status>& status) {
  const auto now = std::chrono::steady_clock::now();
  if (steps_ > 0 && status) {
    const double time = status->simulation_time;
    if (!begin_) begin_ = reached_ = time;
    const bool goes_on = std::exchange(reached_, time) != time;
    const double rounding = 0.5 * timeStepOf(*status);
    if (goes_on && time - *begin_ < steps_ * timeStepOf(*status) + rounding) heard_ = now;
  }
  return std::chrono::duration<double>(now - heard_).count() > timeout_;
}

}  // namespace strandcast
