#include "service/daemon.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>
#include <random>
#include <thread>

#include "core/error.h"
#include "core/quantile.h"
#include "core/smooth_step.h"
#include "options/settings.h"
#include "service/colliders.h"
#include "service/commands.h"
#include "service/scene_simulation.h"
#include "service/show_fingerprint.h"
#include "transport/chunks.h"
#include "transport/commands.h"
#include "transport/parameter_table.h"

namespace strandcast {
namespace {

using Clock = std::chrono::steady_clock;
constexpr size_t kStepWindow = 1200;  // steps in the window of the timing statistics
constexpr double kPullSeconds = 1;    // s of simulation time after which a pull without updates ends (drag
                                      // timeout)

double millisecondsOf(Clock::duration d) { return std::chrono::duration<double, std::milli>(d).count(); }

/// Reads docs/wire.md, "Command": kind, whether it follows the head, pose, and the numbers of a shape.
ContactPrimitive commandedShape(const std::vector<double>& values, const std::string& where) {
  constexpr size_t kBefore = 9;
  if (values.size() != kBefore + kShapeNumbers)
    throw Error("a collider takes 25 numbers", where, "kind, follows head, pose (7), shape (16)");
  const double kind = values[0];
  if (kind != std::floor(kind) || kind < 0 || kind > static_cast<double>(PrimitiveKind::kBox))
    throw Error("a collider of this kind cannot be added by command", where,
                "commands add kinds 0 (sphere) to 5 (box)");
  ContactPrimitive shape;
  shape.kind = static_cast<PrimitiveKind>(static_cast<uint32_t>(kind));
  const double* number = values.data() + kBefore;
  shapeNumbers(shape, [&](float& into) { into = static_cast<float>(*number++); });
  checkColliderShape(shape, where);  // validated before anything changes, not at the announcement
  return shape;
}

/// The single value of a command, a whole number within [low, high].
int wholeNumber(const Command& command, int low, int high, const std::string& where) {
  const bool one = command.values.size() == 1;
  if (!one || !(command.values[0] >= low && command.values[0] <= high) ||
      std::fmod(command.values[0], 1) != 0)
    throw Error(fmt::format("give one whole number from {} to {}", low, high), where, "");
  return static_cast<int>(command.values[0]);
}

}  // namespace

uint64_t newSession() {
  std::random_device entropy;
  const uint64_t clock = static_cast<uint64_t>(std::chrono::system_clock::now().time_since_epoch().count());
  const uint64_t session = clock ^ (static_cast<uint64_t>(entropy()) << 32 | entropy());
  return session == 0 ? 1 : session;
}

Daemon::Daemon(const Settings& settings, Scene scene, Publisher& publisher, uint64_t session)
    : settings_(settings),
      publisher_(publisher),
      conflict_detector_(settings.groom_id),
      named_(scene.named_bodies),
      body_name_(scene.body_name),
      named_parts_(scene.named_parts),
      maker_(settings.collider_folder, scene.mesh_bodies),
      skinned_(scene.skinned),
      scene_motion_(scene.motion),
      motion_(scene.motion),
      head_pivot_(scene.head_pivot),
      simulation_(makeSimulation(scene, settings)),
      wind_(settings.wind_sources, simulation_) {
  if (publisher.castingState() != CastingState::kUnshared) {
    share_state_ = ShareState::kWaiting;
    fingerprint_ = fingerprintOf(scene, settings);
  }
  frame_.groom_id = settings.groom_id;
  frame_.session = session;
  frame_.revision = 1;
  frame_.positions.resize(simulation_.model().vertices());
  step_ms_.reserve(kStepWindow);

  status_.groom_id = settings.groom_id;
  status_.session = session;
  status_.groom_name = scene.name;
  status_.backend = simulation_.backend().name();
  status_.device = simulation_.backend().device();
  status_.strands = simulation_.model().strands();
  status_.vertices = simulation_.model().vertices();
  fillStatus();

  groom_.groom_id = settings.groom_id;
  groom_.session = session;
  groom_.revision = frame_.revision;
  groom_.name = scene.name;
  groom_.hair_radius = simulation_.parameters().hair_radius;
  groom_.guides = std::move(scene.groom.strands);
  body_.groom_id = settings.groom_id;
  body_.session = session;
  body_.mesh = std::move(scene.body);
  body_.head_weights = std::move(scene.head_weights);
}

void Daemon::announce() {
  const size_t free = placedColliders(simulation_).size();
  if (free > kMaxPlacedColliders)
    throw Error(fmt::format("{} bodies do not follow the head", free), status_.groom_name,
                fmt::format("at most {} are published: leave out the names of standing [[body.primitives]], "
                            "which then form one body",
                            kMaxPlacedColliders));
  publisher_.announce(groom_, body_);
  announceColliders();
  groom_ = {};
  body_ = {};
}

void Daemon::apply(const Command& command) {
  const std::string where = commandText(command);
  switch (command.kind) {
    case CommandKind::kSetParameter: {
      Parameters parameters = simulation_.parameters();
      setParameter(parameters, command.name, command.values, where);
      simulation_.setParameters(parameters);
      warnIfUnused(command.name);
      return fillStatus();
    }
    case CommandKind::kHeadPose:
      return moveHead(command, where);
    case CommandKind::kHeadMotion:  // only procedural motions: file names belong to another machine
      return setHeadControl({HeadControl::Kind::kNamed, command.name, motionPose(), {}, simulation_.time()});
    case CommandKind::kReset:
      return reset();
    case CommandKind::kShutdown:
      shutdown_ = true;
      return;
    case CommandKind::kPause:
      paused_ = wholeNumber(command, 0, 1, where) == 1;
      return;
    case CommandKind::kStep:
      if (!paused_) throw Error("only a paused simulation takes single steps", where, "pause it first");
      return requestSteps(command, where);
    case CommandKind::kPull:
      return pull(command, where);
    case CommandKind::kAddCollider:
      addCollider(command, where);
      return fillStatus();
    case CommandKind::kAddColliderFile:
      return addColliderFile(command, where);
    case CommandKind::kMoveCollider:
      return moveCollider(command, where);
    case CommandKind::kRemoveCollider:
      removeCollider(command, where);
      return fillStatus();
    case CommandKind::kAddWindSource:
      wind_.add(command, where);
      return fillStatus();
    case CommandKind::kMoveWindSource:
      return wind_.move(command, where);
    case CommandKind::kRemoveWindSource:
      wind_.remove(command, where);
      return fillStatus();
  }
  throw Error("unknown kind of command", where, "is the sender newer than this daemon?");
}

/// Resets the hair and its measurements. Motions of head and bodies, parameters, wind and simulation time are
/// kept.
void Daemon::reset() {
  simulation_.reset();
  ++resets_;
  measured_ = {};
  strands_measured_ = 0;
  status_.mean_stretch = status_.max_stretch = status_.max_penetration = 0;
  status_.non_finite = status_.strands_reset = 0;
}

void Daemon::warnIfUnused(const std::string& parameter) {
  const std::string why = unmetConditionOf(simulation_.parameters(), parameter);
  if (why.empty())
    unused_parameters_.erase(parameter);
  else if (unused_parameters_.insert(parameter).second)
    spdlog::warn("parameter '{}' has no effect: {}", parameter, why);
}

void Daemon::pull(const Command& command, const std::string& where) {
  const auto& v = command.values;
  if (v.empty()) return simulation_.releaseHair();
  if (v.size() != 8)
    throw Error("a pull takes 8 numbers", where,
                "grab point, radius, target point, rate; no numbers release");
  const auto at = [&](size_t i) { return Vec3(Eigen::Vector3d(v[i], v[i + 1], v[i + 2]).cast<float>()); };
  simulation_.pullHair(at(0), static_cast<float>(v[3]), at(4), static_cast<float>(v[7]));
  pull_until_ = simulation_.time() + kPullSeconds;
  std::copy(v.begin(), v.end(), last_pull_.begin());
}

void Daemon::moveHead(const Command& command, const std::string& where) {
  if (command.values.size() != 7)
    throw Error("a head pose takes 7 finite numbers", where, "position, rotation x y z w");
  setHeadControl({HeadControl::Kind::kPose, "", motionPose(), commandedPose(command.values, 0, where),
                  simulation_.time()});
}

Pose Daemon::motionPose() const {
  const Pose carried = skinned_ ? skinned_->carried(simulation_.time()) : Pose{};
  return carried.inverse() * simulation_.headPose();
}

void Daemon::setHeadControl(HeadControl control) {
  motion_ = motionOf(control, scene_motion_, head_pivot_);
  head_control_ = std::move(control);
}

void Daemon::addCollider(const Command& command, const std::string& where) {
  checkColliderName(command.name, where);
  RigidBody body;
  body.primitives = {commandedShape(command.values, where)};
  body.follows_head = command.values[1] != 0;
  body.pose = commandedPose(command.values, 2, where);
  addNamed(command.name, std::move(body), where);
  collider_commands_[command.name] = command;
}

void Daemon::addColliderFile(const Command& command, const std::string& where) {
  checkColliderName(colliderFileOf(command, where).name, where);
  maker_.begin(command, where);
  pending_colliders_[command.id] = command;
}

BodyId Daemon::namedCollider(const std::string& name, const std::string& where) const {
  const auto known = named_.find(name);
  if (known != named_.end()) return known->second;
  if (!body_name_.empty() && name == body_name_)
    throw Error("hair grows on '" + name + "', which commands neither move nor remove", where,
                skinned_ ? "its clip and the head's motion move its joints" : "move the head");
  throw Error(
      "unknown collider '" + name + "'", where,
      "commands move and remove only colliders that a command added or that the configuration file names");
}

void Daemon::checkColliderName(const std::string& name, const std::string& where) const {
  if (name.empty()) throw Error("a collider has no name", where, "give it a unique name");
  if (named_.contains(name) || name == body_name_)
    throw Error("a collider has the same name: '" + name + "'", where, "give it a unique name");
  if (maker_.makes(name))
    throw Error("a collider '" + name + "' is being made", where, "give it a unique name");
}

void Daemon::addNamed(const std::string& name, RigidBody body, const std::string& where) {
  size_t free = body.follows_head ? 0 : 1, shapes = 1;
  for (const BodyId id : simulation_.bodyIds()) {
    free += simulation_.body(id).follows_head ? 0 : 1;
    shapes += simulation_.body(id).primitives.size();
  }
  if (free > kMaxPlacedColliders || simulation_.bodies() >= kMaxColliders || shapes > kMaxColliderShapes)
    throw Error("too many colliders", where, "remove one first");
  named_[name] = simulation_.addBody(std::move(body));
  announceColliders();
}

void Daemon::addMadeBodies() {
  while (std::optional<ColliderMaker::Made> made = maker_.take()) {
    if (made->refusal.empty()) {
      made->refusal = errorTextOf([&] {
        if (show_entries_.contains(made->command)) checkMesh(*made);
        checkColliderShape(made->body.primitives.front(), made->where);
        addNamed(made->name, std::move(made->body), made->where);
        fillStatus();
      });
    }
    auto command = pending_colliders_.extract(made->command);
    if (made->refusal.empty() && !command.empty()) {
      collider_commands_[made->name] = std::move(command.mapped());
      mesh_hashes_[made->name] = made->mesh_hash;
    }
    if (const auto of_show = show_entries_.extract(made->command); !of_show.empty())
      recordMissingCollider(of_show.mapped(), made->refusal);
    else
      answer(made->command, made->refusal);
  }
}

bool Daemon::waitUntilBodiesMade(const std::atomic<bool>& stop) {
  constexpr std::chrono::milliseconds kPollInterval{20};
  for (; maker_.isBusy(); addMadeBodies()) {
    if (stop) return false;
    maker_.wait(kPollInterval);
  }
  return true;
}

void Daemon::dropBodies() {
  maker_.stop();
  addMadeBodies();
}

void Daemon::moveCollider(const Command& command, const std::string& where) {
  const BodyId id = namedCollider(command.name, where);
  if (command.values.size() != 7 && command.values.size() != 8)
    throw Error("a collider's move takes a pose of 7 numbers, and seconds", where,
                "position, rotation x y z w");
  if (simulation_.body(id).follows_head)
    throw Error("collider '" + command.name + "' follows the head", where, "move the head");
  if (const std::string* joint = skinned_ ? skinned_->jointOf(id) : nullptr)
    throw Error(fmt::format("collider '{}' follows the body's joint '{}'", command.name, *joint), where,
                "the body's clip and the head's motion move it; remove it and add a standing collider");
  const double seconds = command.values.size() == 8 ? command.values[7] : kRampSeconds;
  if (!(seconds >= 0 && seconds <= kLongestWay))
    throw Error(fmt::format("a collider's move takes 0 to {:g} s", kLongestWay), where, "");
  tweens_[id] = {simulation_.bodyPose(id), commandedPose(command.values, 0, where), simulation_.time(),
                 seconds};
}

void Daemon::removeCollider(const Command& command, const std::string& where) {
  if (maker_.drop(command.name)) return;
  const BodyId id = namedCollider(command.name, where);
  simulation_.removeBody(id);
  named_.erase(command.name);
  collider_commands_.erase(command.name);
  mesh_hashes_.erase(command.name);
  tweens_.erase(id);
  announceColliders();
}

void Daemon::announceColliders() {
  ColliderSet set;
  set.session = frame_.session;
  set.revision = ++collider_revision_;
  set.colliders = collidersOf(simulation_);
  frame_.colliders = placedColliders(simulation_);
  publisher_.announceColliders(set);
}

void Daemon::requestSteps(const Command& command, const std::string& where) {
  const int count = wholeNumber(command, 1, kMaxRequestedSteps, where);
  int outstanding = 0;
  for (const Steps& steps : steps_) outstanding += steps.left;
  if (outstanding + count > kMaxRequestedSteps)
    throw Error(fmt::format("{} steps are pending", outstanding), where, "wait for the daemon's answer");
  steps_.push_back({command.id, where, count});
}

void Daemon::execute(const Command& command) {
  const CommandKind kind = command.kind;
  if (kind == CommandKind::kReset || kind == CommandKind::kPause || kind == CommandKind::kShutdown)
    dropSteps("reset, pause, go and stop cancel pending steps");
  if (kind == CommandKind::kShutdown) dropBodies();
  const std::string refusal = errorTextOf([&] { apply(command); });
  const bool takes_time = kind == CommandKind::kStep || kind == CommandKind::kAddColliderFile;
  const bool has_begun = takes_time && refusal.empty();
  if (!has_begun) answer(command.id, refusal);
}

void Daemon::answer(uint64_t command, const std::string& refusal) {
  if (is_following_) return;  // the casting daemon answers
  status_.simulation_time = simulation_.time();
  status_.last_command = command;
  status_.last_command_error = refusal;
  constexpr size_t kAnswersKept = 64;
  answered_.emplace_back(command, refusal);
  if (answered_.size() > kAnswersKept) answered_.pop_front();
  publishShow(false);  // before the answer, so that the show contains every answered command
  if (!refusal.empty()) spdlog::warn("refused: {}", refusal);
  publisher_.publishStatus(status_);  // measured values are those of the last measure()
}

/// Takes this frame's share of the steps that commands have requested. False when `stop` came first.
bool Daemon::runRequestedSteps(const std::atomic<bool>& stop) {
  const auto end = Clock::now() + std::chrono::duration<double>(0.5 / settings_.rate);
  do {
    if (stop) return false;
    advance();
    if (--steps_.front().left > 0) continue;
    measure();  // the answer to a step command carries current measurements
    answer(steps_.front().command, {});
    steps_.pop_front();
  } while (!steps_.empty() && (takes_another_ ? takes_another_(simulation_) : Clock::now() < end));
  return true;
}

void Daemon::dropSteps(const std::string& why) {
  for (; !steps_.empty(); steps_.pop_front()) {
    const auto& [command, where, left] = steps_.front();
    const Error refusal(fmt::format("{} steps were not taken", left), where, why);
    answer(command, refusal.what());
  }
}

void Daemon::advance() {
  const Clock::time_point start = Clock::now();
  if (simulation_.pulledVertices() > 0 && simulation_.time() > pull_until_) simulation_.releaseHair();
  const double end = simulation_.time() + simulation_.parameters().time_step;
  moveTo(skinned_.get(), end, motion_(end - head_control_.start), simulation_);
  advanceColliderMotions(end);
  wind_.advance(end);
  simulation_.step();
  status_.strands_reset +=
      simulation_.resetDiverged();  // synchronises with the backend, so that the time covers the whole step
  const double ms = millisecondsOf(Clock::now() - start);
  if (step_ms_.size() < kStepWindow)
    step_ms_.push_back(ms);
  else
    step_ms_[step_count_ % kStepWindow] = ms;
  ++step_count_;
}

void Daemon::advanceColliderMotions(double time) {
  for (auto way = tweens_.begin(); way != tweens_.end();) {
    const auto& [id, w] = *way;
    simulation_.setBodyPose(id, poseBetween(w.from, w.to, time - w.start, w.seconds));
    way = time - w.start >= w.seconds ? tweens_.erase(way) : std::next(way);
  }
}

void Daemon::placeColliders() {
  for (PlacedCollider& placed : frame_.colliders) {
    placed.pose = simulation_.bodyPose(placed.id);
    placed.bend = simulation_.bodyBend(placed.id);
  }
}

void Daemon::publishFrame() {
  const std::span<const Vec3> guides = simulation_.guides();
  std::copy(guides.begin(), guides.end(), frame_.positions.begin());
  ++frame_.frame;
  frame_.simulation_time = simulation_.time();
  frame_.head = simulation_.headPose();
  placeColliders();
  frame_.publish_time = static_cast<uint64_t>(std::chrono::duration_cast<std::chrono::nanoseconds>(
                                                  std::chrono::system_clock::now().time_since_epoch())
                                                  .count());
  if (share_state_ == ShareState::kParticipating) publisher_.publish(frame_);
  status_.frames = frame_.frame;
  measureSlice(static_cast<size_t>(std::ceil(static_cast<double>(simulation_.model().strands()) /
                                             std::max(kStatusInterval * settings_.rate, 1.0))));
  if (observer_) observer_(simulation_);
}

// Measuring all strands in one frame would delay it: 0.1 s for 96,000 vertices.
void Daemon::measureSlice(size_t strands) {
  const size_t end = std::min(strands_measured_ + strands, simulation_.model().strands());
  measured_.add(simulation_.measure({strands_measured_, end}));
  strands_measured_ = end;
}

void Daemon::fillStatus() {
  status_.parameters = parameterTable(simulation_.parameters());
  for (const auto& [name, source] : wind_.sources())
    appendEntry(status_.parameters, kWindSourceEntry, name, windSourceValues(source));
  if (named_parts_ > 0)
    appendEntry(status_.parameters, kColliderEntry, body_name_, {0, static_cast<double>(named_parts_)});
  for (const auto& [name, id] : named_)
    appendEntry(status_.parameters, kColliderEntry, name, {static_cast<double>(id)});
  for (const std::string& name : unused_parameters_)
    if (!unmetConditionOf(simulation_.parameters(), name).empty())
      appendEntry(status_.parameters, kUnusedEntry, name, {1});
}

void Daemon::measure() {
  measureSlice(simulation_.model().strands());
  const Measurement measured = std::exchange(measured_, {});
  strands_measured_ = 0;
  status_.simulation_time = simulation_.time();
  status_.step_ms_median = quantileOf(step_ms_, 0.5);
  status_.step_ms_p95 = quantileOf(step_ms_, 0.95);
  status_.mean_stretch = measured.mean_stretch;
  status_.max_stretch = std::max(status_.max_stretch, measured.max_stretch);
  status_.max_penetration = std::max(status_.max_penetration, measured.max_penetration);
  status_.non_finite = measured.non_finite;
}

void Daemon::publishStatus() {
  fillStatus();
  measure();
  status_.readers = publisher_.matchedReaders();
  status_.encoding = publisher_.encoding();
  publisher_.publishStatus(status_);
  if (const auto why =
          conflict_detector_.check(publisher_, status_.session, status_.frames, Clock::now() - cast_since_))
    failure_ = *why;
}

bool Daemon::executeCommands(const std::atomic<bool>& stop) {
  for (size_t taken = 0; taken < kMaxCommandsPerFrame; ++taken) {
    const std::optional<Command> command = publisher_.takeCommand();
    if (!command) break;
    execute(*command);
    if (waits_for_bodies_ && !waitUntilBodiesMade(stop)) return false;
  }
  return true;
}

bool Daemon::castFrame(const std::atomic<bool>& stop) {
  if (publisher_.pollClaimLoss()) waitForShow();
  const CastingState turn = publisher_.castingState();
  if (share_state_ == ShareState::kWaiting && !hasShow(turn)) return true;
  addMadeBodies();
  // A standby that has not yet heard all claimants does not take over.
  const bool follows = turn == CastingState::kOther || (turn == CastingState::kUnknown && is_following_);
  if (follows) {
    followShow();
    if (!failure_.empty()) return true;
  } else {
    if (is_following_) becomeCaster();
    if (!executeCommands(stop)) return false;
  }
  const double step = simulation_.parameters().time_step;
  if (paused_ && !is_following_) {
    if (!steps_.empty() && !runRequestedSteps(stop)) return false;
    publishFrame();
    publishShowIfDue();
    return true;
  }
  for (time_accumulator_ += paused_ ? 0 : 1 / settings_.rate; time_accumulator_ > step * (1 - 1e-6);
       time_accumulator_ -= step) {
    if (stop) return false;
    advance();
  }
  publishFrame();
  if (turn == CastingState::kOwn) publishShowIfDue();
  return true;
}

DaemonSummary Daemon::run(const std::atomic<bool>& stop) {
  DaemonSummary summary;
  const Clock::time_point start = Clock::now();
  const auto interval =
      std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(1 / settings_.rate));
  Clock::time_point due = start, status_due = start;
  cast_since_ = start;
  while (!stop && !shutdown_ && failure_.empty()) {
    if (!castFrame(stop)) break;
    const Clock::time_point now = Clock::now();
    if (now >= status_due) {
      publishStatus();
      status_due =
          now + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(kStatusInterval));
    }
    if (settings_.duration > 0 && std::chrono::duration<double>(now - start).count() >= settings_.duration)
      break;
    due += interval;
    if (Clock::now() > due) {
      ++summary.late_frames;
      due = Clock::now();
    }
    std::this_thread::sleep_until(due);
  }
  dropSteps("the daemon ends");
  dropBodies();
  publishStatus();
  summary.seconds = std::chrono::duration<double>(Clock::now() - start).count();
  summary.status = status_;
  summary.failure = failure_;
  return summary;
}

}  // namespace strandcast
