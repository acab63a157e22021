#include "service/controls.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "air/air_system.h"
#include "core/error.h"
#include "core/name_lookup.h"
#include "core/smooth_step.h"
#include "service/commands.h"
#include "service/scene_simulation.h"
#include "transport/commands.h"
#include "transport/frame_queue.h"
#include "transport/parameter_table.h"

namespace strandcast {
namespace {

bool isSame(const Pose& a, const Pose& b) {
  return a.position == b.position && a.rotation.coeffs() == b.rotation.coeffs();
}

HeadMotion rampTo(const Pose& from, const Pose& to) {
  return [=](double seconds) { return poseBetween(from, to, seconds, kRampSeconds); };
}

/// Blends from the pose `from` into a motion, over kRampSeconds.
HeadMotion rampInto(HeadMotion motion, const Pose& from) {
  return [motion = std::move(motion), way = rampTo(from, {})](double seconds) {
    return way(seconds) * motion(seconds);
  };
}

}  // namespace

bool HeadControl::operator==(const HeadControl& other) const {
  return kind == other.kind && name == other.name && start == other.start && isSame(from, other.from) &&
         isSame(to, other.to);
}

HeadMotion motionOf(const HeadControl& control, const HeadMotion& scene, const Vec3& pivot) {
  switch (control.kind) {
    case HeadControl::Kind::kNamed:
      return rampInto(proceduralMotion(control.name, pivot), control.from);
    case HeadControl::Kind::kPose:
      return rampTo(control.from, control.to);
    case HeadControl::Kind::kScene:
      break;
  }
  return scene;
}

void HeadMotionControl::moveTo(const Command& command, const std::string& where) {
  if (command.values.size() != 7)
    throw Error("a head pose takes 7 finite numbers", where, "position, rotation x y z w");
  set({HeadControl::Kind::kPose, "", motionPose(), commandedPose(command.values, 0, where),
       simulation_.time()});
}

void HeadMotionControl::play(const Command& command) {
  set({HeadControl::Kind::kNamed, command.name, motionPose(), {}, simulation_.time()});
}

void HeadMotionControl::set(HeadControl control) {
  motion_ = motionOf(control, scene_motion_, pivot_);
  control_ = std::move(control);
  posed_.head.reset();
  posed_.joints_carry_hair = false;
}

void HeadMotionControl::poseJoint(size_t joint, const Placement& motion) {
  posed_.joints.resize(skinned_->skin().skeleton.joints.size());
  posed_.joints[joint] = motion;
  const std::vector<size_t>& carriers = skinned_->carriers();
  if (std::find(carriers.begin(), carriers.end(), joint) != carriers.end()) posed_.joints_carry_hair = true;
}

void HeadMotionControl::weigh(size_t target, float weight) {
  if (posed_.weights.empty()) posed_.weights = skinned_->skin().restWeights();
  posed_.weights[target] = weight;
}

SkinnedBody::Moment HeadMotionControl::momentAt(double time, const Pose& head) const {
  if (!posed_.joints.empty()) return skinned_->fromPalette(posed_.joints, posed_.weights, head);
  return skinned_->at(time, head, posed_.weights);
}

void HeadMotionControl::advance(double time) {
  const Pose head = posed_.joints_carry_hair ? Pose{}
                    : posed_.head            ? *posed_.head
                                             : motion_(time - control_.start);
  if (posed_.joints.empty() && posed_.weights.empty())
    return strandcast::moveTo(skinned_.get(), time, head, simulation_);
  // A palette may put parts of the body out of range; what it did not reach then stays where it is.
  const std::string why = errorTextOf([&] { place(*skinned_, momentAt(time, head), head, simulation_); });
  if (!why.empty() && !std::exchange(has_warned_, true)) spdlog::warn("poses of a live source: {}", why);
}

Pose HeadMotionControl::motionPose() const {
  if (posed_.head && !posed_.joints_carry_hair) return *posed_.head;
  const double time = simulation_.time();
  const Pose carried = !skinned_               ? Pose{}
                       : posed_.joints.empty() ? skinned_->carried(time)
                                               : momentAt(time, {}).carried;
  return carried.inverse() * simulation_.headPose();
}

void ParameterControl::set(const Command& command, const std::string& where) {
  Parameters parameters = simulation_.parameters();
  setParameter(parameters, command.name, command.values, where);
  simulation_.setParameters(parameters);
  const std::string why = unmetConditionOf(simulation_.parameters(), command.name);
  if (why.empty())
    unused_.erase(command.name);
  else if (unused_.insert(command.name).second)
    spdlog::warn("parameter '{}' has no effect: {}", command.name, why);
}

void ParameterControl::appendUnused(ParameterTable& table) const {
  for (const std::string& name : unused_)
    if (!unmetConditionOf(simulation_.parameters(), name).empty())
      appendEntry(table, kUnusedEntry, name, {1});
}

void HandControl::pull(const Command& command, const std::string& where) {
  constexpr double kPullSeconds = 1;  // s of simulation time; a pull without updates then ends (drag timeout)
  const auto& v = command.values;
  if (v.empty()) return simulation_.releaseHair();
  if (v.size() != last_pull_.size())
    throw Error("a pull takes 8 numbers", where,
                "grab point, radius, target point, rate; no numbers release");
  apply(v);
  end_ = simulation_.time() + kPullSeconds;
  std::copy(v.begin(), v.end(), last_pull_.begin());
}

void HandControl::releaseIfOver() {
  if (simulation_.pulledVertices() > 0 && simulation_.time() > end_) simulation_.releaseHair();
}

std::vector<double> HandControl::state() const {
  if (simulation_.pulledVertices() == 0) return {};
  std::vector<double> values(last_pull_.begin(), last_pull_.end());
  values.push_back(end_);
  return values;
}

void HandControl::restoreFrom(std::span<const double> state) {
  if (state.empty()) return simulation_.releaseHair();
  std::copy_n(state.begin(), last_pull_.size(), last_pull_.begin());
  apply(state);
  end_ = state.back();
}

void HandControl::apply(std::span<const double> pull) {
  const auto at = [&](size_t i) {
    return Vec3(Eigen::Vector3d(pull[i], pull[i + 1], pull[i + 2]).cast<float>());
  };
  simulation_.pullHair(at(0), static_cast<float>(pull[3]), at(4), static_cast<float>(pull[7]));
}

void StepSchedule::checkPaused(const std::string& where) const {
  if (!paused_) throw Error("only a paused simulation takes single steps", where, "pause it first");
}

void StepSchedule::request(uint64_t command, const std::string& where, int count) {
  int outstanding = 0;
  for (const Request& request : requests_) outstanding += request.left;
  if (outstanding + count > kMaxRequestedSteps)
    throw Error(fmt::format("{} steps are pending", outstanding), where, "wait for the daemon's answer");
  requests_.push_back({command, where, count});
}

void StepSchedule::clear() {
  paused_ = false;
  requests_.clear();
}

namespace {

/// Calls `number` with each number of these parts of a source, in the order of the wire format.
template <class Source, class Number>
void sourceNumbers(Source& source, WindSourceParts parts, const Number& number) {
  for (int c = 0; c < 3 && (parts & kSourcePosition) != 0; ++c) number(source.position[c]);
  for (int c = 0; c < 3 && (parts & kSourceDirection) != 0; ++c) number(source.direction[c]);
  for (const WindSourceNumber& known : windSourceNumbers())
    if ((parts & known.part) != 0) number(source.*known.into);
}

/// Reads a source from a command's values after the first `before`. Throws Error where their count differs.
void readSource(const std::vector<double>& values, size_t before, WindSourceParts parts, WindSource& source,
                const std::string& where) {
  size_t next = before;
  sourceNumbers(source, parts, [&](float& into) {
    if (next < values.size()) into = static_cast<float>(values[next]);
    ++next;
  });
  if (values.size() != next)
    throw Error(fmt::format("this source of wind takes {} numbers, not {}", next, values.size()), where,
                "see Command in docs/wire.md");
  checkWindSource(source, where);
}

void checkPlace(const WindSource& source, const std::string& where) {
  if (!(source.position.cwiseAbs().maxCoeff() <= float{kFarthestPlace}))
    throw Error("the position of a source of wind is too far away", where,
                fmt::format("give x y z in metres, each within {}", kFarthestPlace));
}

}  // namespace

std::vector<double> windSourceValues(const WindSource& source) {
  std::vector<double> values = {static_cast<double>(source.kind)};
  sourceNumbers(source, kAllSourceParts, [&](float number) { values.push_back(double{number}); });
  return values;
}

WindSource windSourceOf(const std::vector<double>& values, const std::string& where) {
  const double kind = values.empty() ? -1 : values[0];
  constexpr double kLastKind = static_cast<double>(WindSource::Kind::kTurbine);
  if (kind != std::floor(kind) || !(kind >= 0 && kind <= kLastKind))
    throw Error("unknown kind of wind source", where, "0 is a cone, 1 a sphere, 2 a turbine");
  WindSource source;
  source.kind = static_cast<WindSource::Kind>(static_cast<int>(kind));
  readSource(values, 1, kAllSourceParts, source, where);
  return source;
}

std::vector<double> windMoveValues(const WindSource& to, WindSourceParts parts, double seconds) {
  std::vector<double> values = {static_cast<double>(parts), seconds};
  sourceNumbers(to, parts, [&](float number) { values.push_back(double{number}); });
  return values;
}

NamedWindSource& WindControl::find(const std::string& name, const std::string& where) {
  std::vector<std::string> names;
  for (NamedWindSource& known : sources_) {
    if (known.name == name) return known;
    names.push_back(known.name);
  }
  const std::string near = didYouMean(name, names);
  const std::string there =
      names.empty() ? "no source exists" : fmt::format("known sources: {}", fmt::join(names, ", "));
  throw Error("unknown source of wind '" + name + "'", where, near.empty() ? there : near);
}

void WindControl::replace(std::vector<NamedWindSource> sources, const std::string& where) {
  AirSystem* const air = airSystem(simulation_.externalForces());
  if (air == nullptr)
    throw Error("this backend does not support wind sources", where,
                "choose --backend simd, gpu or reference");
  air->setSources(withoutNames(sources));
  try {
    simulation_.setParameters(simulation_.parameters());  // re-evaluates whether air is needed
  } catch (const Error&) {
    air->setSources(withoutNames(sources_));
    throw;
  }
  sources_ = std::move(sources);
}

void WindControl::add(const Command& command, const std::string& where) {
  checkWindSourceName(command.name, where);
  for (const NamedWindSource& known : sources_)
    if (known.name == command.name)
      throw Error("a source of wind has the same name: '" + command.name + "'", where,
                  "give it a unique name, or move the existing source");
  if (sources_.size() >= kMaxWindSources)
    throw Error(fmt::format("{} sources of wind exist, the most that a daemon takes", sources_.size()), where,
                "remove one first");
  std::vector<NamedWindSource> sources = sources_;
  sources.push_back({command.name, windSourceOf(command.values, where)});
  checkPlace(sources.back().source, where);
  replace(std::move(sources), where);
}

void WindControl::move(const Command& command, const std::string& where) {
  const NamedWindSource& known = find(command.name, where);
  const std::vector<double>& v = command.values;
  if (v.size() < 2 || v[0] != std::floor(v[0]) || v[0] < 1 || v[0] > kAllSourceParts)
    throw Error("a wind source move names no valid parts", where,
                "give the sum of the parts' bits, the seconds, and the values of the parts");
  if (!(v[1] >= 0 && v[1] <= kLongestWay))
    throw Error(fmt::format("a move of a source of wind takes 0 to {:g} s", kLongestWay), where, "");
  const auto parts = static_cast<WindSourceParts>(v[0]);
  if ((parts & partsOf(known.source.kind)) == 0)
    throw Error(fmt::format("a {} has no {}", windSourceKindName(known.source.kind),
                            unusedParts(known.source.kind, parts)),
                where, "move a value that this kind has");
  WindSource to = known.source;
  readSource(v, 2, parts, to, where);
  if ((parts & kSourcePosition) != 0) checkPlace(to, where);
  for (Ramp& way : tweens_)
    if (way.name == command.name) way.parts &= ~parts;  // the other parts keep moving
  std::erase_if(tweens_, [](const Ramp& way) { return way.parts == 0; });
  tweens_.push_back({command.name, parts, known.source, to, simulation_.time(), v[1]});
}

void WindControl::remove(const Command& command, const std::string& where) {
  find(command.name, where);
  std::vector<NamedWindSource> left = sources_;
  std::erase_if(left, [&](const NamedWindSource& known) { return known.name == command.name; });
  replace(std::move(left), where);
  std::erase_if(tweens_, [&](const Ramp& way) { return way.name == command.name; });
}

void WindControl::restoreFrom(std::vector<NamedWindSource> sources, std::vector<Ramp> tweens,
                              const std::string& where) {
  for (const NamedWindSource& source : sources) {
    checkWindSourceName(source.name, where);
    checkWindSource(source.source, where);
  }
  if (sources.size() > kMaxWindSources)
    throw Error(fmt::format("{} sources of wind are too many", sources.size()), where, "remove some");
  const auto valuesOf = [](const std::vector<NamedWindSource>& all) {
    std::vector<std::pair<std::string, std::vector<double>>> values;
    for (const auto& [name, source] : all) values.emplace_back(name, windSourceValues(source));
    return values;
  };
  if (valuesOf(sources) != valuesOf(sources_)) replace(std::move(sources), where);
  tweens_ = std::move(tweens);
}

void WindControl::advance(double time) {
  if (tweens_.empty()) return;
  for (const Ramp& way : tweens_) {
    const auto part = static_cast<float>(easedFraction(time - way.start, way.seconds));
    for (NamedWindSource& moved : sources_)
      if (moved.name == way.name) copyParts(moved.source, between(way.from, way.to, part), way.parts);
  }
  std::erase_if(tweens_, [&](const Ramp& way) { return time - way.start >= way.seconds; });
  airSystem(simulation_.externalForces())->setSources(withoutNames(sources_));
}

ControlledSimulation::ControlledSimulation(const Settings& settings, const Scene& scene, Publisher& publisher,
                                           uint64_t session)
    : simulation(makeSimulation(scene, settings)),
      parameters(simulation),
      head(scene.motion, scene.head_pivot, scene.skinned, simulation),
      wind(settings.wind_sources, simulation),
      hand(simulation),
      colliders(scene, settings.collider_folder, simulation, publisher, session),
      poses(scene, settings.poses, simulation, head, colliders, publisher) {}

size_t ControlledSimulation::advance() {
  hand.releaseIfOver();
  const double end = simulation.time() + simulation.parameters().time_step;
  const bool is_cut = poses.advance(end, static_cast<int64_t>(steadyTime()));
  moveTo(end);
  if (is_cut) {
    ++cuts;
    simulation.releaseHair();  // the hand stays where the hair was
    simulation.jumpToPoses();
  }
  wind.advance(end);
  simulation.step();
  return simulation.resetDiverged();  // waits for the backend, so that the caller's clock has the whole step
}

void ControlledSimulation::moveTo(double time) {
  head.advance(time);
  colliders.advance(time);
}

void ControlledSimulation::reset() {
  simulation.reset();
  ++resets;
}

ParameterTable ControlledSimulation::table() const {
  ParameterTable table = parameterTable(simulation.parameters());
  for (const auto& [name, source] : wind.sources())
    appendEntry(table, kWindSourceEntry, name, windSourceValues(source));
  colliders.appendTo(table);
  parameters.appendUnused(table);
  return table;
}

}  // namespace strandcast
