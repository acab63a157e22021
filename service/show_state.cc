#include "service/show_state.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>

#include "core/error.h"
#include "service/commands.h"
#include "service/network.h"
#include "service/show_fingerprint.h"
#include "transport/chunks.h"
#include "transport/commands.h"
#include "transport/parameter_table.h"

namespace strandcast {
namespace {

constexpr double kMaxBehind = 1;  // s; a daemon farther from the show's time jumps to it
constexpr size_t kPoseValues = 7, kPoseOfCommand = 2;

void addSource(std::vector<double>& values, const WindSource& source) {
  const std::vector<double> numbers = windSourceValues(source);
  values.insert(values.end(), numbers.begin(), numbers.end());
}

std::string whereOf(const Show& show) { return fmt::format("show of session {:016x}", show.session); }

/// Throws Error, naming `where`, unless the entry has `count` values.
void checkCount(const ShowEntry& entry, size_t count, const std::string& where) {
  if (entry.values.size() != count)
    throw Error(fmt::format("an entry of kind {} has {} values, not {}", static_cast<uint32_t>(entry.kind),
                            entry.values.size(), count),
                where, "is the publishing daemon of another version?");
}

bool isCollider(const ShowEntry& entry) {
  return entry.kind == ShowKind::kCollider || entry.kind == ShowKind::kColliderFile ||
         entry.kind == ShowKind::kSceneCollider;
}

bool followsHead(const ShowEntry& entry) { return entry.values.size() > 1 && entry.values[1] != 0; }

/// The collider's name in an entry. An entry of a file collider holds two names, the collider's first.
std::string nameOf(const ShowEntry& entry) {
  if (entry.kind != ShowKind::kColliderFile) return entry.name;
  return withSpaces(std::string_view(entry.name).substr(0, entry.name.find(' ')));
}

/// Whether the command makes the collider of the entry. Poses may differ where the collider can be moved.
bool makes(const Command& command, const ShowEntry& entry) {
  const CommandKind kind =
      entry.kind == ShowKind::kColliderFile ? CommandKind::kAddColliderFile : CommandKind::kAddCollider;
  if (command.kind != kind || command.name != entry.name || command.values.size() != entry.values.size())
    return false;
  for (size_t i = 0; i < entry.values.size(); ++i) {
    const bool is_place = i >= kPoseOfCommand && i < kPoseOfCommand + kPoseValues;
    if (command.values[i] != entry.values[i] && (!is_place || followsHead(entry))) return false;
  }
  return true;
}

HeadControl headControlOf(const ShowEntry& entry, const std::string& where) {
  checkCount(entry, 2 + 2 * kPoseValues, where);
  HeadControl control;
  const double kind = entry.values[0];
  if (kind != 0 && kind != 1 && kind != 2) throw Error("unknown kind of head motion", where, "");
  control.kind = static_cast<HeadControl::Kind>(static_cast<int>(kind));
  control.name = entry.name;
  control.start = entry.values[1];
  control.from = commandedPose(entry.values, 2, where);
  control.to = commandedPose(entry.values, 2 + kPoseValues, where);
  return control;
}

ShowEntry entryOf(const HeadControl& control) {
  ShowEntry entry{ShowKind::kHead, control.name, {static_cast<double>(control.kind), control.start}};
  appendPose(entry.values, control.from);
  appendPose(entry.values, control.to);
  return entry;
}

ShowEntry entryOf(const WindControl::Ramp& way) {
  ShowEntry entry{ShowKind::kWindRamp, way.name, {static_cast<double>(way.parts), way.start, way.seconds}};
  addSource(entry.values, way.from);
  addSource(entry.values, way.to);
  return entry;
}

WindControl::Ramp windRampOf(const ShowEntry& entry, const std::string& where) {
  const size_t numbers = windSourceValues({}).size();
  checkCount(entry, 3 + 2 * numbers, where);
  const auto& v = entry.values;
  if (!(v[0] >= 1 && v[0] <= kAllSourceParts) || !(v[2] >= 0 && v[2] <= kLongestWay))
    throw Error("unknown kind of wind source motion", where, "");
  const auto sourceAt = [&](size_t first) {
    const auto begin = v.begin() + static_cast<ptrdiff_t>(first);
    return windSourceOf({begin, begin + static_cast<ptrdiff_t>(numbers)}, where);
  };
  return {entry.name, static_cast<WindSourceParts>(v[0]), sourceAt(3), sourceAt(3 + numbers), v[1], v[2]};
}

/// The command id of an answer or of steps, and the text after it.
std::pair<uint64_t, std::string> numbered(const ShowEntry& entry) {
  uint64_t id = 0;
  const char* const end = entry.name.data() + entry.name.size();
  const char* rest = std::from_chars(entry.name.data(), end, id).ptr;
  if (rest != end) ++rest;  // a space
  return {id, std::string(rest, end)};
}

/// Seconds, and ns within one: a double is not exact over all clocks.
ShowEntry entryOf(const LivePoses::Delay& delay) {
  const int64_t second = delay.ns / kNsPerSecond;
  return {ShowKind::kPoseSource,
          fmt::format("{}", delay.source),
          {static_cast<double>(second), static_cast<double>(delay.ns - second * kNsPerSecond)}};
}

LivePoses::Delay delayOf(const ShowEntry& entry, const std::string& where) {
  checkCount(entry, 2, where);
  constexpr double kFarthest = 9e9, kSecond = kNsPerSecond;
  if (!(std::fabs(entry.values[0]) <= kFarthest && std::fabs(entry.values[1]) <= kSecond))
    throw Error("a source of poses has an impossible delay", where, "");
  return {numbered(entry).first,
          static_cast<int64_t>(entry.values[0]) * kNsPerSecond + static_cast<int64_t>(entry.values[1])};
}

/// Whether a collider has the show's mesh; true where either has no hash.
bool hasMeshOf(const Show& show, const std::string& name, const NamedCollider& collider) {
  const uint64_t shown = meshHashIn(show.entries, name);
  return !collider.mesh_hash || shown == 0 || *collider.mesh_hash == shown;
}

}  // namespace

void ShowColliders::addEntries(std::vector<ShowEntry>& entries) const {
  for (const auto& [name, collider] : registry_.named()) {
    const bool free = !simulation_.body(collider.body).follows_head;
    ShowEntry entry{ShowKind::kSceneCollider, name, {}};
    if (collider.command) {
      const Command& command = *collider.command;
      entry.kind =
          command.kind == CommandKind::kAddColliderFile ? ShowKind::kColliderFile : ShowKind::kCollider;
      entry.name = command.name;
      entry.values = command.values;
      std::vector<double> now;
      appendPose(now, simulation_.bodyPose(collider.body));
      if (free) std::copy(now.begin(), now.end(), entry.values.begin() + kPoseOfCommand);
    } else if (registry_.standsFree(collider)) {
      appendPose(entry.values, simulation_.bodyPose(collider.body));
    }
    entries.push_back(std::move(entry));
    if (collider.mesh_hash) entries.push_back(meshEntry(name, *collider.mesh_hash));
    if (!collider.tween) continue;
    ShowEntry moves{ShowKind::kColliderMotion, name, {collider.tween->start, collider.tween->seconds}};
    appendPose(moves.values, collider.tween->from);
    appendPose(moves.values, collider.tween->to);
    entries.push_back(std::move(moves));
  }
}

void ShowColliders::apply(const Show& show) {
  const std::string where = whereOf(show);
  const auto entryFor = [&](const std::string& name) {
    return std::find_if(show.entries.begin(), show.entries.end(),
                        [&](const ShowEntry& entry) { return isCollider(entry) && nameOf(entry) == name; });
  };
  std::vector<std::string> gone;
  for (const auto& [name, collider] : registry_.named()) {
    const auto entry = entryFor(name);
    const bool stays =
        entry != show.entries.end() &&
        (!collider.command ? entry->kind == ShowKind::kSceneCollider
                           : makes(*collider.command, *entry) && hasMeshOf(show, name, collider));
    if (!stays) gone.push_back(name);
  }
  for (const std::string& name : gone) registry_.erase(name);
  for (auto missing = missing_.begin(); missing != missing_.end();) {
    const bool is_same = entryFor(missing->first) != show.entries.end() &&
                         meshHashIn(show.entries, missing->first) == missing->second;
    missing = is_same ? std::next(missing) : missing_.erase(missing);
  }
  shown_meshes_.clear();
  for (const ShowEntry& entry : show.entries)
    if (entry.kind == ShowKind::kColliderFile)
      shown_meshes_[nameOf(entry)] = meshHashIn(show.entries, nameOf(entry));
  const size_t before = simulation_.bodies();
  for (const ShowEntry& entry : show.entries)
    if (isCollider(entry)) add(entry);
  const bool changed = !gone.empty() || simulation_.bodies() != before;
  const auto& named = registry_.named();
  std::map<std::string, PoseTween> tweens;
  for (const ShowEntry& entry : show.entries) {
    const auto known = named.find(entry.name);
    if (entry.kind != ShowKind::kColliderMotion || known == named.end()) continue;
    checkCount(entry, 2 + 2 * kPoseValues, where);
    if (simulation_.body(known->second.body).follows_head) continue;
    tweens[known->first] = {commandedPose(entry.values, 2, where),
                            commandedPose(entry.values, 2 + kPoseValues, where), entry.values[0],
                            entry.values[1]};
  }
  for (const ShowEntry& entry : show.entries) {
    const auto known = isCollider(entry) ? named.find(nameOf(entry)) : named.end();
    if (known == named.end() || tweens.contains(known->first)) continue;
    if (!registry_.standsFree(known->second)) continue;
    const size_t first = entry.kind == ShowKind::kSceneCollider ? 0 : kPoseOfCommand;
    if (entry.values.size() >= first + kPoseValues)
      simulation_.setBodyPose(known->second.body, commandedPose(entry.values, first, where));
  }
  registry_.replaceTweens(tweens);
  if (changed) registry_.announce();
}

void ShowColliders::add(const ShowEntry& entry) {
  const std::string name = nameOf(entry);
  if (registry_.has(name) || missing_.contains(name)) return;
  Command command;
  command.groom_id = groom_id_;
  command.id = newSession();
  command.name = entry.name;
  command.values = entry.values;
  const std::string refusal = errorTextOf([&] {
    if (entry.kind == ShowKind::kSceneCollider)
      throw Error("collider '" + name + "' of the scene was removed here", "the show", "");
    if (entry.kind == ShowKind::kColliderFile) {
      command.kind = CommandKind::kAddColliderFile;
      registry_.addFile(command, "collider " + name + " of the show",
                        [this](const ColliderMaker::Made& made) { checkMesh(made); });
      in_work_[command.id] = entry;
    } else {
      command.kind = CommandKind::kAddCollider;
      registry_.add(command, "collider " + name + " of the show");
    }
  });
  recordMissing(entry, refusal);
}

bool ShowColliders::takeAnswer(uint64_t command, const std::string& refusal) {
  const auto in_work = in_work_.extract(command);
  if (in_work.empty()) return false;
  recordMissing(in_work.mapped(), refusal);
  return true;
}

void ShowColliders::checkMesh(const ColliderMaker::Made& made) const {
  const auto shown = shown_meshes_.find(made.name);
  if (shown == shown_meshes_.end() || shown->second == 0 || shown->second == made.mesh_hash) return;
  throw Error("the file's mesh differs from the publishing daemon's", made.where,
              "copy the publishing daemon's file into this daemon's --collider-folder, then remove the "
              "collider and add it again");
}

void ShowColliders::recordMissing(const ShowEntry& entry, const std::string& refusal) {
  if (refusal.empty()) return;
  const auto shown = shown_meshes_.find(nameOf(entry));
  missing_[nameOf(entry)] = shown == shown_meshes_.end() ? 0 : shown->second;
  spdlog::warn("this daemon lacks a collider of the show, and takes over only if no other daemon can: {}",
               refusal);
}

ShowState::ShowState(const Settings& settings, std::vector<ShowEntry> fingerprint,
                     ControlledSimulation& controlled, StatusReport& report)
    : groom_id_(settings.groom_id),
      rate_(settings.rate),
      fingerprint_(std::move(fingerprint)),
      controlled_(controlled),
      report_(report),
      colliders_(settings.groom_id, controlled.simulation, controlled.colliders) {}

Show ShowState::make(bool with_hair) {
  Show show;
  show.simulation_time = controlled_.simulation.time();
  show.entries = fingerprint_;
  for (const auto& [name, values] : namedValues(parameterTable(controlled_.simulation.parameters())))
    show.entries.push_back({ShowKind::kParameter, name, values});
  for (const auto& [name, source] : controlled_.wind.sources())
    show.entries.push_back({ShowKind::kWindSource, name, windSourceValues(source)});
  for (const WindControl::Ramp& way : controlled_.wind.tweens()) show.entries.push_back(entryOf(way));
  colliders_.addEntries(show.entries);
  show.entries.push_back(entryOf(controlled_.head.control()));
  for (const LivePoses::Delay& delay : controlled_.poses.delays()) show.entries.push_back(entryOf(delay));
  for (PoseTargets::Held& held : controlled_.poses.held())
    show.entries.push_back({ShowKind::kHeldPose, std::move(held.name), std::move(held.values)});
  if (controlled_.steps.isPaused()) show.entries.push_back({ShowKind::kPaused, "", {}});
  for (const StepSchedule::Request& steps : controlled_.steps.requests())
    show.entries.push_back(
        {ShowKind::kSteps, fmt::format("{}", steps.command), {static_cast<double>(steps.left)}});
  if (std::vector<double> pull = controlled_.hand.state(); !pull.empty())
    show.entries.push_back({ShowKind::kPull, "", std::move(pull)});
  show.entries.push_back({ShowKind::kResets, "", {static_cast<double>(controlled_.resets)}});
  for (const auto& [id, refusal] : answers_)
    show.entries.push_back({ShowKind::kAnswered, shortened(fmt::format("{} {}", id, refusal)), {}});
  if (with_hair) show.hair = controlled_.simulation.state();
  return show;
}

double ShowState::restoreFrom(const Show& show) {
  const std::string where = whereOf(show);
  const std::string difference = differenceOf(fingerprint_, show.entries);
  if (!difference.empty())
    throw Error(
        fmt::format("groom {} is published from another scene; differences: {}", groom_id_, difference),
        where,
        "start daemons that --claim one groom with the same scene and options, or choose another --groom-id");
  Simulation& simulation = controlled_.simulation;
  Parameters parameters = simulation.parameters();
  std::vector<NamedWindSource> sources;
  std::vector<WindControl::Ramp> wind_tweens;
  HeadControl control;
  std::vector<double> pull;
  uint32_t resets = 0;
  controlled_.steps.clear();
  answers_.clear();
  for (const ShowEntry& entry : show.entries) {
    switch (entry.kind) {
      case ShowKind::kParameter:
        setParameter(parameters, entry.name, entry.values, where);
        break;
      case ShowKind::kWindSource:
        sources.push_back({entry.name, windSourceOf(entry.values, where)});
        break;
      case ShowKind::kWindRamp:
        wind_tweens.push_back(windRampOf(entry, where));
        break;
      case ShowKind::kHead:
        control = headControlOf(entry, where);
        break;
      case ShowKind::kPoseSource:
        controlled_.poses.adopt(delayOf(entry, where));
        break;
      case ShowKind::kPaused:
        controlled_.steps.pause(true);
        break;
      case ShowKind::kSteps: {
        checkCount(entry, 1, where);
        const int left = static_cast<int>(std::clamp(entry.values[0], 1.0, double{kMaxRequestedSteps}));
        controlled_.steps.restore({numbered(entry).first, fmt::format("strandcast ctl step {}", left), left});
        break;
      }
      case ShowKind::kPull:
        checkCount(entry, HandControl::kStateValues, where);
        pull = entry.values;
        break;
      case ShowKind::kResets:
        checkCount(entry, 1, where);
        resets = static_cast<uint32_t>(std::clamp(entry.values[0], 0.0, 4e9));
        break;
      case ShowKind::kAnswered:
        answers_.push_back(numbered(entry));
        break;
      default:
        break;  // colliders: see ShowColliders
    }
  }
  if (namedValues(parameterTable(parameters)) != namedValues(parameterTable(simulation.parameters())))
    simulation.setParameters(parameters);
  controlled_.wind.restoreFrom(std::move(sources), std::move(wind_tweens), where);
  if (!(control == controlled_.head.control())) controlled_.head.set(control);
  for (const ShowEntry& entry : show.entries)
    if (entry.kind == ShowKind::kHeldPose) controlled_.poses.restore({entry.name, entry.values}, where);
  colliders_.apply(show);
  const bool is_new = session_ != show.session;
  double behind = 0;
  if (show.hasHair()) {
    controlled_.moveTo(show.simulation_time);
    simulation.resumeFrom(show.hair, show.simulation_time);
  } else {
    if (!is_new && resets != controlled_.resets) {
      controlled_.reset();
      report_.reset();
    }
    behind = syncTime(show.simulation_time);
  }
  controlled_.resets = resets;
  session_ = show.session;
  controlled_.hand.restoreFrom(pull);
  report_.setParameters(controlled_.table());
  return behind;
}

double ShowState::syncTime(double time) {
  lag_ = time - controlled_.simulation.time();
  if (std::fabs(lag_) <= kMaxBehind)
    return controlled_.steps.isPaused() ? lag_ : lag_ - 1 / rate_;  // the present frame adds one interval
  // This machine is too slow, or stood still: its hair continues from its present state at the show's time.
  controlled_.moveTo(time);
  controlled_.simulation.resumeFrom(controlled_.simulation.state(), time);
  return 0;
}

void ShowState::recordAnswer(uint64_t command, const std::string& refusal) {
  constexpr size_t kAnswersKept = 64;
  answers_.emplace_back(command, refusal);
  if (answers_.size() > kAnswersKept) answers_.pop_front();
}

bool ShowState::knows(uint64_t command) const {
  const auto& steps = controlled_.steps.requests();
  return std::any_of(answers_.begin(), answers_.end(),
                     [&](const auto& answer) { return answer.first == command; }) ||
         std::any_of(steps.begin(), steps.end(),
                     [&](const StepSchedule::Request& request) { return request.command == command; });
}

}  // namespace strandcast
