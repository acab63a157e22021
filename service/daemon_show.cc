// How daemons that share a groom hand over a show: the casting daemon publishes it, the others follow it
// (docs/wire.md, "ShowChunk").
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

#include "core/error.h"
#include "service/commands.h"
#include "service/daemon.h"
#include "service/show_fingerprint.h"
#include "transport/commands.h"
#include "transport/parameter_table.h"

namespace strandcast {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::milliseconds kShowPeriod{100};
constexpr double kMaxBehind = 1;  // s; a daemon farther from the show's time jumps to it
constexpr size_t kPoseValues = 7, kPoseOfCommand = 2;
constexpr size_t kAnswersRepeated = 16;

void addPose(std::vector<double>& values, const Pose& pose) {
  for (int c = 0; c < 3; ++c) values.push_back(static_cast<double>(pose.position[c]));
  for (int c = 0; c < 4; ++c) values.push_back(static_cast<double>(pose.rotation.coeffs()[c]));
}

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
  addPose(entry.values, control.from);
  addPose(entry.values, control.to);
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

}  // namespace

void Daemon::addColliderEntries(std::vector<ShowEntry>& entries) const {
  for (const auto& [name, id] : named_) {
    const bool free = !simulation_.body(id).follows_head;
    ShowEntry entry{ShowKind::kSceneCollider, name, {}};
    if (const auto made = collider_commands_.find(name); made != collider_commands_.end()) {
      const Command& command = made->second;
      entry.kind =
          command.kind == CommandKind::kAddColliderFile ? ShowKind::kColliderFile : ShowKind::kCollider;
      entry.name = command.name;
      entry.values = command.values;
      std::vector<double> now;
      addPose(now, simulation_.bodyPose(id));
      if (free) std::copy(now.begin(), now.end(), entry.values.begin() + kPoseOfCommand);
    } else if (free && !(skinned_ && skinned_->jointOf(id))) {
      addPose(entry.values, simulation_.bodyPose(id));
    }
    entries.push_back(std::move(entry));
    if (const auto mesh = mesh_hashes_.find(name); mesh != mesh_hashes_.end())
      entries.push_back(meshEntry(name, mesh->second));
    const auto way = tweens_.find(id);
    if (way == tweens_.end()) continue;
    ShowEntry moves{ShowKind::kColliderMotion, name, {way->second.start, way->second.seconds}};
    addPose(moves.values, way->second.from);
    addPose(moves.values, way->second.to);
    entries.push_back(std::move(moves));
  }
}

Show Daemon::makeShow(bool with_hair) {
  Show show;
  show.simulation_time = simulation_.time();
  show.entries = fingerprint_;
  for (const auto& [name, values] : namedValues(parameterTable(simulation_.parameters())))
    show.entries.push_back({ShowKind::kParameter, name, values});
  for (const auto& [name, source] : wind_.sources())
    show.entries.push_back({ShowKind::kWindSource, name, windSourceValues(source)});
  for (const WindControl::Ramp& way : wind_.tweens()) show.entries.push_back(entryOf(way));
  addColliderEntries(show.entries);
  show.entries.push_back(entryOf(head_control_));
  if (paused_) show.entries.push_back({ShowKind::kPaused, "", {}});
  for (const Steps& steps : steps_)
    show.entries.push_back(
        {ShowKind::kSteps, fmt::format("{}", steps.command), {static_cast<double>(steps.left)}});
  if (simulation_.pulledVertices() > 0) {
    ShowEntry pull{ShowKind::kPull, "", {last_pull_.begin(), last_pull_.end()}};
    pull.values.push_back(pull_until_);
    show.entries.push_back(std::move(pull));
  }
  show.entries.push_back({ShowKind::kResets, "", {static_cast<double>(resets_)}});
  for (const auto& [id, refusal] : answered_)
    show.entries.push_back({ShowKind::kAnswered, shortened(fmt::format("{} {}", id, refusal)), {}});
  if (with_hair) show.hair = simulation_.state();
  return show;
}

void Daemon::publishShow(bool with_hair) {
  if (publisher_.castingState() != CastingState::kOwn || publisher_.sharers() == 0) return;
  publisher_.publishShow(makeShow(with_hair));
}

void Daemon::publishShowIfDue() {
  if (publisher_.castingState() != CastingState::kOwn || publisher_.sharers() == 0) return;
  if (publisher_.wantsHair()) publishShow(true);
  if (Clock::now() < show_due_) return;
  show_due_ = Clock::now() + kShowPeriod;
  publishShow(false);
}

void Daemon::waitForShow() {
  spdlog::warn("groom {}: this daemon was suspended and lost its claim; it waits for the show",
               settings_.groom_id);
  share_state_ = ShareState::kWaiting;
  has_own_hair_ = true;
  is_following_ = logged_wait_ = warned_wait_ = false;
  waits_since_ = Clock::now();
  queued_commands_.clear();
}

bool Daemon::hasShow(CastingState turn) {
  constexpr std::chrono::milliseconds kNotableWait{500};
  constexpr std::chrono::seconds kTooLong{10};
  if (turn == CastingState::kUnclaimed || turn == CastingState::kOwn) {
    if (logged_wait_)
      spdlog::warn("groom {} has no publisher any more and no show was received: this daemon {}",
                   settings_.groom_id,
                   has_own_hair_ ? "continues with its own hair" : "starts from the rest shape");
    share_state_ = ShareState::kParticipating;
    return true;
  }
  while (std::optional<Show> show = publisher_.takeShow()) {
    if (!show->hasHair() && !has_own_hair_) continue;
    failure_ = errorTextOf([&] { restoreFrom(*show); });
    if (!failure_.empty()) return false;
    spdlog::info("continues the show of session {:016x} at {:.1f} s", show->session, show->simulation_time);
    is_following_ = true;
    share_state_ = ShareState::kCatchingUp;
    shows_in_tolerance_ = 0;
    return true;
  }
  const auto waited = Clock::now() - waits_since_;
  if (!logged_wait_ && waited > kNotableWait) {
    logged_wait_ = true;
    spdlog::info(
        "another daemon publishes groom {}: this daemon waits for its show and may take over after that",
        settings_.groom_id);
  }
  if (!warned_wait_ && waited > kTooLong) {
    warned_wait_ = true;
    spdlog::warn(
        "no show of groom {} was received for {} s: is the publishing daemon older, or without the keys for "
        "it? This daemon stands by, and publishes when that daemon ends",
        settings_.groom_id, kTooLong.count());
  }
  return false;
}

void Daemon::followShow() {
  is_following_ = true;
  while (std::optional<Command> command = publisher_.takeCommand()) {
    if (command->kind == CommandKind::kShutdown) shutdown_ = true;  // ends all sharers of the groom
    if (queued_commands_.size() < kMaxQueuedCommands) queued_commands_.push_back(std::move(*command));
  }
  while (std::optional<Show> show = publisher_.takeShow()) {
    if (show->hasHair()) continue;
    failure_ = errorTextOf([&] { restoreFrom(*show); });
    if (!failure_.empty()) return;
    std::erase_if(queued_commands_, [&](const Command& command) {
      return std::any_of(answered_.begin(), answered_.end(),
                         [&](const auto& answer) { return answer.first == command.id; }) ||
             std::any_of(steps_.begin(), steps_.end(),
                         [&](const Steps& steps) { return steps.command == command.id; });
    });
    // The first shows after the hair may have been queued while this daemon was busy: their time is stale.
    constexpr int kMinShowsInTolerance = 3;
    const bool is_there =
        std::fabs(show_lag_) < 3 / settings_.rate && ++shows_in_tolerance_ >= kMinShowsInTolerance;
    if (share_state_ == ShareState::kParticipating &&
        !missing_colliders_.empty()) {  // daemons with all colliders have precedence
      share_state_ = ShareState::kCatchingUp;
      publisher_.withdrawClaim();
    }
    const bool is_ready =
        share_state_ == ShareState::kCatchingUp && is_there && !maker_.isBusy() && missing_colliders_.empty();
    if (is_ready && publisher_.yields()) {
      if (!std::exchange(logged_equal_, true))
        spdlog::info(
            "the publishing daemon of groom {} has an equal claim: this daemon publishes when that daemon "
            "ends",
            settings_.groom_id);
    } else if (is_ready) {
      share_state_ = ShareState::kParticipating;
    }
  }
}

void Daemon::becomeCaster() {
  is_following_ = false;
  share_state_ = ShareState::kParticipating;
  spdlog::info("takes over groom {} at {:.1f} s", settings_.groom_id, simulation_.time());
  for (const auto& [name, mesh] : missing_colliders_)
    spdlog::warn("the show continues without collider {}", name);
  // The senders of these commands may not have received the answers.
  const size_t repeated = std::min(answered_.size(), kAnswersRepeated);
  for (auto answer = answered_.end() - static_cast<ptrdiff_t>(repeated); answer != answered_.end();
       ++answer) {
    status_.last_command = answer->first;
    status_.last_command_error = answer->second;
    publisher_.publishStatus(status_);
  }
  for (const Command& command : std::exchange(queued_commands_, {})) execute(command);
}

void Daemon::restoreFrom(const Show& show) {
  const std::string where = whereOf(show);
  const std::string difference = differenceOf(fingerprint_, show.entries);
  if (!difference.empty())
    throw Error(
        fmt::format("groom {} is published from another scene; differences: {}", settings_.groom_id,
                    difference),
        where,
        "start daemons that --claim one groom with the same scene and options, or choose another --groom-id");
  Parameters parameters = simulation_.parameters();
  std::vector<NamedWindSource> sources;
  std::vector<WindControl::Ramp> wind_tweens;
  HeadControl control;
  const ShowEntry* pull = nullptr;
  uint32_t resets = 0;
  paused_ = false;
  steps_.clear();
  answered_.clear();
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
      case ShowKind::kPaused:
        paused_ = true;
        break;
      case ShowKind::kSteps: {
        checkCount(entry, 1, where);
        const int left = static_cast<int>(std::clamp(entry.values[0], 1.0, double{kMaxRequestedSteps}));
        steps_.push_back({numbered(entry).first, fmt::format("strandcast ctl step {}", left), left});
        break;
      }
      case ShowKind::kPull:
        checkCount(entry, 9, where);
        pull = &entry;
        break;
      case ShowKind::kResets:
        checkCount(entry, 1, where);
        resets = static_cast<uint32_t>(std::clamp(entry.values[0], 0.0, 4e9));
        break;
      case ShowKind::kAnswered:
        answered_.push_back(numbered(entry));
        break;
      default:
        break;  // colliders: see applyColliders()
    }
  }
  if (namedValues(parameterTable(parameters)) != namedValues(parameterTable(simulation_.parameters())))
    simulation_.setParameters(parameters);
  wind_.restoreFrom(std::move(sources), std::move(wind_tweens), where);
  if (!(control == head_control_)) setHeadControl(control);
  applyColliders(show);
  const bool is_new = show_session_ != show.session;
  if (show.hasHair()) {
    moveTo(skinned_.get(), show.simulation_time, motion_(show.simulation_time - head_control_.start),
           simulation_);
    advanceColliderMotions(show.simulation_time);
    simulation_.resumeFrom(show.hair, show.simulation_time);
    time_accumulator_ = 0;
  } else {
    if (!is_new && resets != resets_) reset();
    syncTime(show.simulation_time);
  }
  resets_ = resets;
  show_session_ = show.session;
  if (pull == nullptr) {
    simulation_.releaseHair();
  } else {
    const auto& v = pull->values;
    std::copy_n(v.begin(), last_pull_.size(), last_pull_.begin());
    const auto at = [&](size_t i) { return Vec3(Eigen::Vector3d(v[i], v[i + 1], v[i + 2]).cast<float>()); };
    simulation_.pullHair(at(0), static_cast<float>(v[3]), at(4), static_cast<float>(v[7]));
    pull_until_ = v[8];
  }
  fillStatus();
}

void Daemon::syncTime(double time) {
  const double behind = show_lag_ = time - simulation_.time();
  time_accumulator_ = paused_ ? behind : behind - 1 / settings_.rate;  // the current frame adds one interval
  if (std::fabs(behind) <= kMaxBehind) return;
  // This machine is too slow, or stood still: its hair continues from its present state at the show's time.
  moveTo(skinned_.get(), time, motion_(time - head_control_.start), simulation_);
  advanceColliderMotions(time);
  simulation_.resumeFrom(simulation_.state(), time);
  time_accumulator_ = 0;
}

void Daemon::applyColliders(const Show& show) {
  const std::string where = whereOf(show);
  bool changed = false;
  const auto entryFor = [&](const std::string& name) {
    return std::find_if(show.entries.begin(), show.entries.end(),
                        [&](const ShowEntry& entry) { return isCollider(entry) && nameOf(entry) == name; });
  };
  for (auto known = named_.begin(); known != named_.end();) {
    const auto entry = entryFor(known->first);
    const auto made = collider_commands_.find(known->first);
    const bool stays =
        entry != show.entries.end() &&
        (made == collider_commands_.end() ? entry->kind == ShowKind::kSceneCollider
                                          : makes(made->second, *entry) && hasMeshOf(show, known->first));
    if (stays) {
      ++known;
      continue;
    }
    simulation_.removeBody(known->second);
    tweens_.erase(known->second);
    if (made != collider_commands_.end()) collider_commands_.erase(made);
    mesh_hashes_.erase(known->first);
    known = named_.erase(known);
    changed = true;
  }
  for (auto missing = missing_colliders_.begin(); missing != missing_colliders_.end();) {
    const bool is_same = entryFor(missing->first) != show.entries.end() &&
                         meshHashIn(show.entries, missing->first) == missing->second;
    missing = is_same ? std::next(missing) : missing_colliders_.erase(missing);
  }
  show_mesh_hashes_.clear();
  for (const ShowEntry& entry : show.entries)
    if (entry.kind == ShowKind::kColliderFile)
      show_mesh_hashes_[nameOf(entry)] = meshHashIn(show.entries, nameOf(entry));
  const size_t before = simulation_.bodies();
  for (const ShowEntry& entry : show.entries)
    if (isCollider(entry)) applyCollider(entry);
  changed = changed || simulation_.bodies() != before;
  std::map<BodyId, PoseTween> tweens;
  for (const ShowEntry& entry : show.entries) {
    const auto known = named_.find(entry.name);
    if (entry.kind != ShowKind::kColliderMotion || known == named_.end()) continue;
    checkCount(entry, 2 + 2 * kPoseValues, where);
    if (simulation_.body(known->second).follows_head) continue;
    tweens[known->second] = {commandedPose(entry.values, 2, where),
                             commandedPose(entry.values, 2 + kPoseValues, where), entry.values[0],
                             entry.values[1]};
  }
  for (const ShowEntry& entry : show.entries) {
    const auto known = isCollider(entry) ? named_.find(nameOf(entry)) : named_.end();
    if (known == named_.end() || tweens.contains(known->second)) continue;
    if (simulation_.body(known->second).follows_head || (skinned_ && skinned_->jointOf(known->second)))
      continue;
    const size_t first = entry.kind == ShowKind::kSceneCollider ? 0 : kPoseOfCommand;
    if (entry.values.size() >= first + kPoseValues)
      simulation_.setBodyPose(known->second, commandedPose(entry.values, first, where));
  }
  tweens_ = std::move(tweens);
  if (changed) announceColliders();
}

void Daemon::applyCollider(const ShowEntry& entry) {
  const std::string name = nameOf(entry);
  if (named_.contains(name) || maker_.makes(name) || missing_colliders_.contains(name)) return;
  Command command;
  command.groom_id = settings_.groom_id;
  command.id = newSession();
  command.name = entry.name;
  command.values = entry.values;
  const std::string refusal = errorTextOf([&] {
    if (entry.kind == ShowKind::kSceneCollider)
      throw Error("collider '" + name + "' of the scene was removed here", "the show", "");
    if (entry.kind == ShowKind::kColliderFile) {
      command.kind = CommandKind::kAddColliderFile;
      show_entries_[command.id] = entry;
      addColliderFile(command, "collider " + name + " of the show");
    } else {
      command.kind = CommandKind::kAddCollider;
      addCollider(command, "collider " + name + " of the show");
    }
  });
  if (refusal.empty()) return;
  show_entries_.erase(command.id);
  recordMissingCollider(entry, refusal);
}

void Daemon::checkMesh(const ColliderMaker::Made& made) const {
  const auto shown = show_mesh_hashes_.find(made.name);
  if (shown == show_mesh_hashes_.end() || shown->second == 0 || shown->second == made.mesh_hash) return;
  throw Error("the file's mesh differs from the publishing daemon's", made.where,
              "copy the publishing daemon's file into this daemon's --collider-folder, then remove the "
              "collider and add it again");
}

bool Daemon::hasMeshOf(const Show& show, const std::string& collider) const {
  const auto own = mesh_hashes_.find(collider);
  const uint64_t shown = meshHashIn(show.entries, collider);
  return own == mesh_hashes_.end() || shown == 0 || own->second == shown;
}

void Daemon::recordMissingCollider(const ShowEntry& entry, const std::string& refusal) {
  if (refusal.empty()) return;
  const auto shown = show_mesh_hashes_.find(nameOf(entry));
  missing_colliders_[nameOf(entry)] = shown == show_mesh_hashes_.end() ? 0 : shown->second;
  spdlog::warn("this daemon lacks a collider of the show, and takes over only if no other daemon can: {}",
               refusal);
}

}  // namespace strandcast
