#include "service/live_poses.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include "core/error.h"
#include "core/quantile.h"
#include "service/commands.h"
#include "service/controls.h"
#include "transport/chunks.h"
#include "transport/frame_queue.h"
#include "transport/parameter_table.h"

namespace strandcast {
namespace {

constexpr size_t kMaxSources = 16;
constexpr int kMaxNamesTold = 8;                     ///< revisions of a source's names in the log
constexpr int32_t kMostLost = 10'000;                ///< samples; a larger gap is a jump of their numbers
constexpr int64_t kSilence = kNsPerSecond / 2;       ///< after which another source may move the same
constexpr int64_t kGone = 3 * kNsPerSecond;          ///< of silence, after which a source is dropped
constexpr uint64_t kLatestTime = uint64_t{1} << 62;  ///< ns
constexpr int kMostlyExact = 61;  ///< of the last 64 steps, for steps that wait for no second sample
constexpr size_t kFramesMeasured = 1000, kClocksMeasured = 200;

int64_t nanosecondsOf(double seconds) { return std::llround(1e9 * seconds); }
double toMilliseconds(int64_t ns) { return 1e-6 * static_cast<double>(ns); }

Pose poseAt(const std::vector<float>& numbers, size_t index) {
  const float* const n = numbers.data() + 7 * index;
  return {Vec3(n[0], n[1], n[2]), Quat(n[6], n[3], n[4], n[5])};
}

Vec3 scaleAt(const std::vector<float>& numbers, size_t index) {
  return Vec3(numbers[3 * index], numbers[3 * index + 1], numbers[3 * index + 2]);
}

Pose heldPose(const std::vector<double>& v) {
  return {Vec3(Eigen::Vector3d(v[0], v[1], v[2]).cast<float>()),
          Quat(Eigen::Quaterniond(v[6], v[3], v[4], v[5]).cast<float>())};
}

/// The first few of these names.
std::string firstOf(const std::vector<std::string>& names) {
  constexpr ptrdiff_t kMost = 8;
  return fmt::format("{}{}",
                     fmt::join(names.begin(), names.begin() + std::min(kMost, std::ssize(names)), ", "),
                     std::ssize(names) > kMost ? ", ..." : "");
}

void appendName(std::string& names, const std::string& name) {
  if (!names.empty()) names += ' ';
  names += name;
}

void addToRing(std::vector<double>& ring, size_t& count, size_t capacity, double value) {
  if (ring.size() < capacity)
    ring.push_back(value);
  else
    ring[count % capacity] = value;
  ++count;
}

}  // namespace

PoseTargets::PoseTargets(const Scene& scene, Simulation& simulation, HeadMotionControl& head,
                         ColliderRegistry& colliders)
    : simulation_(simulation),
      head_(head),
      colliders_(colliders),
      skinned_(scene.skinned),
      rig_(scene.body_rig),
      head_pivot_(scene.head_pivot) {}

bool PoseTargets::isUnreadJoint(const PosedName& name) const {
  return !skinned_ && name.kind == PosedKind::kJoint && !name.name.empty() &&
         std::find(rig_.joints.begin(), rig_.joints.end(), name.name) != rig_.joints.end();
}

bool PoseTargets::isUnreadWeight(const std::string& name) const {
  return findWeights(name).empty() &&
         std::find(rig_.targets.begin(), rig_.targets.end(), name) != rig_.targets.end();
}

/// The skin moves those before it but the head's.
size_t PoseTargets::firstPinned() const {
  return 1 + (skinned_ && skinned_->roots() ? skinned_->roots()->bones() : 0);
}

PoseTargets::Target PoseTargets::find(const PosedName& name) const {
  const std::vector<std::string>& bones = simulation_.model().bones;
  const auto pinned = bones.begin() + static_cast<ptrdiff_t>(firstPinned());
  switch (name.kind) {
    case PosedKind::kHead:
      return {name.kind, 0, {}, head_pivot_};
    case PosedKind::kJoint:
      if (const int joint = skinned_ && !name.name.empty() ? skinned_->skin().skeleton.find(name.name) : -1;
          joint >= 0) {
        const Skeleton& skeleton = skinned_->skin().skeleton;
        const auto index = static_cast<size_t>(joint);
        return {name.kind,
                index,
                {},
                Vec3(skeleton.worldTransforms(skeleton.rest())[index].translation().cast<float>())};
      }
      break;
    case PosedKind::kBone:
      if (const auto bone = std::find(pinned, bones.end(), name.name); bone != bones.end())
        return {name.kind, static_cast<size_t>(bone - bones.begin()), {}, Vec3::Zero()};
      break;
    case PosedKind::kBody:
      return {name.kind, 0, name.name, Vec3::Zero()};
    case PosedKind::kOther:
      break;
  }
  return {};
}

std::vector<size_t> PoseTargets::findWeights(const std::string& name) const {
  std::vector<size_t> found;
  if (!skinned_) return found;
  const std::vector<MorphTarget>& known = skinned_->skin().targets;
  for (size_t t = 0; t < known.size(); ++t)
    if (known[t].name == name) found.push_back(t);
  return found;
}

std::optional<size_t> PoseTargets::carrier(const std::vector<Target>& targets) const {
  const auto indexOf = [&](PosedKind kind, size_t index) -> std::optional<size_t> {
    for (size_t i = 0; i < targets.size(); ++i)
      if (targets[i].kind == kind && targets[i].index == index) return i;
    return std::nullopt;
  };
  if (skinned_)
    for (const size_t joint : skinned_->carriers())
      if (const auto found = indexOf(PosedKind::kJoint, joint)) return found;
  return indexOf(PosedKind::kHead, 0);
}

void PoseTargets::resolve(const PoseSamples& poses) {
  if (poses.names != names_) {
    targets_.clear();
    for (const PosedName& name : posedNames(poses)) targets_.push_back(find(name));
    const bool has_joints = std::any_of(targets_.begin(), targets_.end(), [](const Target& target) {
      return target.kind == PosedKind::kJoint;
    });
    if (has_joints) head_.releaseJoints();
    names_ = poses.names;
  }
  if (poses.weight_names != weight_names_) {
    weights_.clear();
    for (const std::string& name : weightNames(poses)) weights_.push_back(findWeights(name));
    if (!weights_.empty()) head_.releaseWeights();
    weight_names_ = poses.weight_names;
  }
}

void PoseTargets::apply(const PoseSamples& poses) {
  resolve(poses);
  for (size_t i = 0; i < targets_.size(); ++i) {
    const Target& target = targets_[i];
    const Pose pose = poseAt(poses.poses, i);
    if (target.kind == PosedKind::kHead) head_.poseHead(pose);
    if (target.kind == PosedKind::kBone) simulation_.setBonePose(target.index, pose);
    if (target.kind == PosedKind::kBody) colliders_.place(target.body, pose);
    if (target.kind != PosedKind::kJoint) continue;
    Placement motion = Placement::Identity();
    motion.translate(pose.position.cast<double>());
    motion.rotate(pose.rotation.cast<double>());
    if (!poses.scales.empty()) motion.scale(Eigen::Vector3d(scaleAt(poses.scales, i).cast<double>()));
    head_.poseJoint(target.index, motion);
  }
  for (size_t i = 0; i < weights_.size(); ++i)
    for (const size_t target : weights_[i]) head_.weigh(target, poses.weights[i]);
}

std::vector<PoseTargets::Held> PoseTargets::held() const {
  std::vector<Held> held;
  const HeadMotionControl::Posed& posed = head_.posed();
  const auto add = [&](const std::string& name, const Pose& pose) {
    held.push_back({name, {}});
    appendPose(held.back().values, pose);
  };
  if (posed.head) add("head", *posed.head);
  for (size_t j = 0; j < posed.joints.size(); ++j) {
    if (!posed.joints[j]) continue;
    Held joint{"joint:" + withoutSpaces(skinned_->skin().skeleton.joints[j].name), {}};
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 4; ++column) joint.values.push_back((*posed.joints[j])(row, column));
    joint.values.push_back(posed.joints_carry_hair ? 1 : 0);
    held.push_back(std::move(joint));
  }
  for (size_t t = 0; t < posed.weights.size(); ++t)
    held.push_back({"weight:" + withoutSpaces(skinned_->skin().targets[t].name), {double{posed.weights[t]}}});
  for (size_t bone = firstPinned(); bone < simulation_.model().bones.size(); ++bone) {
    const Pose& pose = simulation_.bonePose(bone);
    if (pose.position != Vec3::Zero() || pose.rotation.coeffs() != Quat::Identity().coeffs())
      add("bone:" + withoutSpaces(simulation_.model().bones[bone]), pose);
  }
  std::erase_if(held, [](const Held& thing) { return !isSoundName(thing.name); });  // of a file
  return held;
}

void PoseTargets::restore(const Held& held, const std::string& where) {
  const std::vector<double>& v = held.values;
  const auto check = [&](bool is_right) {
    if (!is_right)
      throw Error("the pose of '" + held.name + "' is out of range", where,
                  "is the publishing daemon of another version?");
  };
  if (const std::string prefix = "weight:"; held.name.starts_with(prefix)) {
    check(v.size() == 1 &&
          std::fabs(v[0]) <= double{std::numeric_limits<float>::max()});  // a file's, at rest
    for (const size_t target : findWeights(withSpaces(held.name.substr(prefix.size()))))
      head_.weigh(target, static_cast<float>(v[0]));
    return;
  }
  PoseSamples named;
  named.names = held.name;
  const std::vector<PosedName> names = posedNames(named);
  check(names.size() == 1);
  const Target target = find(names[0]);
  if (names[0].kind != PosedKind::kJoint) {
    check(v.size() == 7);
    const Pose pose = heldPose(v);
    check(pose.position.cwiseAbs().maxCoeff() <= kFarthestPosed &&
          std::fabs(pose.rotation.norm() - 1) < 1e-4f);
    if (target.kind == PosedKind::kHead) head_.poseHead(pose);
    if (target.kind == PosedKind::kBone) simulation_.setBonePose(target.index, pose);
    return;
  }
  check(v.size() == 13);
  Placement motion = Placement::Identity();
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column) motion(row, column) = v[static_cast<size_t>(4 * row + column)];
  constexpr double kFarthest = 1e6;
  // Of the least scales on all axes; without one the motion cannot be inverted.
  constexpr double kLeastVolume = 0.5 * double{kLeastScale} * double{kLeastScale} * double{kLeastScale};
  check(motion.affine().cwiseAbs().maxCoeff() <= kFarthest &&
        std::fabs(motion.linear().determinant()) >= kLeastVolume);
  if (target.kind != PosedKind::kJoint) return;
  head_.poseJoint(target.index, motion);
  head_.carryHairByJoints(v[12] != 0);
}

/// A sender of poses.
struct LivePoses::Source {
  /// Something that a sample moves and the simulation has.
  struct Slot {
    size_t at = 0;    ///< index in the message's names of poses or weights
    std::string key;  ///< as in owners_
    bool is_owned = false;
  };

  uint64_t id = 0;
  PoseClock clock;
  PoseLock lock;

  bool has_names = false, has_scales = false;
  int names_told = 0;
  uint32_t revision = 0;          ///< of the names
  size_t posed = 0, weighed = 0;  ///< names
  std::vector<Slot> slots, weights;
  std::vector<Vec3> pivots;
  std::optional<size_t> carrier;  ///< the slot that carries the hair
  std::optional<PoseTrack> track;
  PoseSample sample;  ///< of the track's size

  PoseSamples last;  ///< message
  bool has_last = false;
  uint32_t newest = 0;  ///< greatest number of a sample
  int64_t heard = 0;    ///< steady clock
  int64_t period = 0;   ///< from sample to sample, ns; 0: not known

  const PoseTrack::Step* taken = nullptr;
  uint64_t exact_steps = ~uint64_t{0};  ///< a bit for each of the last 64 that should have had a sample
  bool awaits_period = false;           ///< the lock could not know it
  bool takes_over = false;              ///< its next step is the first with the hair
  bool is_refused = false;              ///< other sources move some of what it names
  bool has_told_refusal = false;
  uint32_t counted = 0;  ///< number of the sample in the last frame
  bool has_counted = false;

  bool isSilent(int64_t now) const { return now - heard > kSilence; }
  bool moves() const {
    const auto isOwned = [](const Slot& slot) { return slot.is_owned; };
    return std::any_of(slots.begin(), slots.end(), isOwned) ||
           std::any_of(weights.begin(), weights.end(), isOwned);
  }
  bool movesHair() const { return carrier && slots[*carrier].is_owned; }
  /// By how much the first step after a lock is before the newest sample, ns: one period where the sender is
  /// slower than the steps. So both samples around the next steps are there, and the pace has nothing to
  /// catch up. PoseLock::followPhase keeps up with a sender that is slower by 0.5 %: its samples all fall on
  /// steps.
  int64_t hold(int64_t step_ns, int64_t longest) const {
    const bool is_slower = period > step_ns + step_ns / 200 && period <= PoseTrack::kLongestInterval;
    return is_slower ? std::min(period, longest) : 0;
  }
  /// How much longer a step waits than for its own sample.
  int64_t wait() const { return std::popcount(exact_steps) >= kMostlyExact ? 0 : period; }
  int64_t wallOf(int64_t step_end, int64_t longest) const {
    return clock.wallOf(lock.timeOf(step_end), wait(), longest);
  }
  std::string name() const { return fmt::format("live source {:016x}", id); }

  void makeTrack(double extrapolate) {
    track.emplace(PoseTrack::Slots{pivots, has_scales, weights.size(), carrier}, extrapolate);
    taken = nullptr;
    sample.poses.resize(slots.size());
    sample.scales.assign(has_scales ? slots.size() : 0, Vec3::Ones());
    sample.weights.resize(weights.size());
  }
};

LivePoses::LivePoses(const Scene& scene, const PoseOptions& options, Simulation& simulation,
                     HeadMotionControl& head, ColliderRegistry& colliders, Publisher& publisher)
    : options_(options),
      simulation_(simulation),
      publisher_(publisher),
      targets_(scene, simulation, head, colliders) {}

LivePoses::~LivePoses() = default;

LivePoses::Source* LivePoses::sourceOf(const PoseSamples& message) {
  for (const std::unique_ptr<Source>& source : sources_)
    if (source->id == message.source) return source.get();
  if (sources_.size() == kMaxSources) {
    if (!std::exchange(has_refused_source_, true))
      spdlog::warn("more than {} live sources send poses: the others are ignored", kMaxSources);
    return nullptr;
  }
  sources_.push_back(std::make_unique<Source>());
  sources_.back()->id = message.source;
  return sources_.back().get();
}

bool LivePoses::adoptNames(Source& source, const PoseSamples& message) {
  const bool has_names = !message.names.empty() || !message.weight_names.empty();
  const bool is_known = source.has_names && source.revision == message.names_revision;
  if (!is_known && !has_names) return false;
  if (!is_known) {
    source.has_names = true;
    const bool is_told = source.names_told++ < kMaxNamesTold;
    source.revision = message.names_revision;
    source.slots.clear();
    source.weights.clear();
    source.pivots.clear();
    source.track.reset();
    source.taken = nullptr;
    std::vector<PoseTargets::Target> targets;
    const std::vector<PosedName> posed = posedNames(message);
    const std::vector<std::string_view> texts = splitNames(message.names);
    for (size_t i = 0; i < posed.size(); ++i) {
      PoseTargets::Target target = targets_.find(posed[i]);
      if (target.kind == PosedKind::kOther) continue;
      source.slots.push_back({i, std::string(texts[i])});
      source.pivots.push_back(target.pivot);
      targets.push_back(std::move(target));
    }
    const std::vector<std::string> weights = weightNames(message);
    for (size_t i = 0; i < weights.size(); ++i)
      if (!targets_.findWeights(weights[i]).empty())
        source.weights.push_back({i, "weight:" + withoutSpaces(weights[i])});
    source.posed = posed.size();
    source.weighed = weights.size();
    source.carrier = targets_.carrier(targets);
    if (is_told)
      spdlog::info("{} names {} things, of which {} are here", source.name(), source.posed + source.weighed,
                   source.slots.size() + source.weights.size());
    if (is_told) warnOfNames(source, message);
  }
  if (posesPerSample(message) != source.posed || weightsPerSample(message) != source.weighed) return false;
  if (source.track && source.has_scales == !message.scales.empty()) return true;
  source.has_scales = !message.scales.empty();
  source.makeTrack(options_.extrapolate);
  return true;
}

void LivePoses::warnOfNames(const Source& source, const PoseSamples& message) const {
  std::vector<std::string> unknown, joints, weights;
  const std::vector<PosedName> posed = posedNames(message);
  const std::vector<std::string_view> texts = splitNames(message.names);
  bool has_unknown_joint = false;
  for (size_t i = 0; i < posed.size(); ++i) {
    if (targets_.find(posed[i]).kind != PosedKind::kOther) continue;
    const bool is_unread = targets_.isUnreadJoint(posed[i]);
    (is_unread ? joints : unknown).emplace_back(texts[i]);
    has_unknown_joint = has_unknown_joint || (posed[i].kind == PosedKind::kJoint && !is_unread);
  }
  for (const std::string& name : weightNames(message))
    if (targets_.findWeights(name).empty())
      (targets_.isUnreadWeight(name) ? weights : unknown).push_back("weight:" + withoutSpaces(name));
  if (!joints.empty())
    spdlog::warn(
        "{} names {} joints of the body's file ({}), which is read without its skin: give "
        "--body-joint or --body-clip",
        source.name(), joints.size(), firstOf(joints));
  if (!weights.empty())
    spdlog::warn(
        "{} names {} morph targets of the body's file ({}) that are not read: give --body-targets all",
        source.name(), weights.size(), firstOf(weights));
  if (!unknown.empty())
    spdlog::warn(
        "{} names what this groom does not have: {}{}", source.name(), firstOf(unknown),
        has_unknown_joint && !targets_.hasJoints() ? "; its body has no skin, and so no joints" : "");
}

void LivePoses::addSamples(Source& source, const PoseSamples& message) {
  for (size_t i = message.ages.size(); i-- > 0;) {  // the oldest first
    PoseSample& sample = source.sample;
    sample.number = message.newest - static_cast<uint32_t>(i);
    sample.epoch = message.epoch;
    sample.time_ns = static_cast<int64_t>(message.time - message.ages[i]);
    for (size_t slot = 0; slot < source.slots.size(); ++slot) {
      const size_t at = i * source.posed + source.slots[slot].at;
      sample.poses[slot] = poseAt(message.poses, at);
      if (source.has_scales) sample.scales[slot] = scaleAt(message.scales, at);
    }
    for (size_t k = 0; k < source.weights.size(); ++k)
      sample.weights[k] = message.weights[i * source.weighed + source.weights[k].at];
    const PoseTrack::Arrival arrival = source.track->add(sample);
    counters_.samples += arrival != PoseTrack::Arrival::kRepeated;
    counters_.late += arrival == PoseTrack::Arrival::kLate;
    counters_.repeated += arrival == PoseTrack::Arrival::kRepeated;
    if (arrival != PoseTrack::Arrival::kRepeated)
      source.clock.arrive(sample.time_ns, static_cast<int64_t>(message.arrival_time));
  }
}

void LivePoses::receive(PoseSamples message, int64_t end_ns) {
  Source* const source = message.time < kLatestTime ? sourceOf(message) : nullptr;
  if (source == nullptr) {
    ++counters_.refused;
    return;
  }
  source->heard = static_cast<int64_t>(message.arrival_time);
  if (!adoptNames(*source, message)) {
    ++counters_.refused;
    return;
  }
  counters_.refused += source->is_refused;
  if (source->slots.empty() && source->weights.empty()) {
    ++counters_.refused;
    return;
  }
  if (message.sent_time != 0) {
    const auto offset = static_cast<int64_t>(systemTime() - steadyTime());
    addToRing(clocks_ms_, clocks_, kClocksMeasured,
              toMilliseconds(source->heard + offset - static_cast<int64_t>(message.sent_time)));
  }
  const auto ahead = static_cast<int32_t>(message.newest - source->newest);
  const bool is_new_epoch = source->has_last && message.epoch != source->last.epoch;
  if (source->has_last && ahead > 0) {
    const auto repeated = static_cast<int32_t>(message.ages.size());
    if (ahead < kMostLost) counters_.lost += static_cast<uint64_t>(std::max(0, ahead - repeated));
    const auto passed = static_cast<int64_t>(message.time - source->last.time);
    if (!is_new_epoch && passed > 0 && source->last.newest == source->newest) source->period = passed / ahead;
  }
  if (source->period == 0 && message.ages.size() > 1)
    source->period = message.ages.back() / static_cast<int64_t>(message.ages.size() - 1);
  if (!source->has_last || ahead > 0) source->newest = message.newest;
  const bool is_of_timeline =
      source->lock.arrive(static_cast<int64_t>(message.time), is_new_epoch, source->heard, end_ns);
  if (is_of_timeline && source->lock.isLocked()) addSamples(*source, message);
  source->last = std::move(message);
  source->has_last = true;
}

void LivePoses::receive(double end, int64_t now) {
  const int64_t end_ns = nanosecondsOf(end);
  for (size_t taken = 0; taken < kMaxQueuedPoses; ++taken) {
    std::optional<PoseSamples> message = publisher_.takePoses();
    if (!message) break;
    receive(std::move(*message), end_ns);
  }
  std::erase_if(sources_, [&](const std::unique_ptr<Source>& source) {
    const bool is_gone = now - source->heard > kGone;
    if (is_gone) spdlog::info("{} has been silent for {} s", source->name(), kGone / kNsPerSecond);
    return is_gone;
  });
}

void LivePoses::assign(int64_t now) {
  std::map<std::string, uint64_t> owners;
  const auto claim = [&](Source& source, const std::string& key) {
    const auto [owner, is_first] = owners.try_emplace(key, source.id);
    if (is_first) return;
    const auto& other = *std::find_if(sources_.begin(), sources_.end(),
                                      [&](const auto& known) { return known->id == owner->second; });
    const auto before = owners_.find(key);
    const bool was_owner = before != owners_.end() && before->second == source.id;
    if (source.isSilent(now) != other->isSilent(now) ? other->isSilent(now) : was_owner)
      owner->second = source.id;
  };
  for (const std::unique_ptr<Source>& source : sources_) {
    for (const Source::Slot& slot : source->slots) claim(*source, slot.key);
    for (const Source::Slot& weight : source->weights) claim(*source, weight.key);
  }
  for (const std::unique_ptr<Source>& source : sources_) {
    source->is_refused = false;
    for (std::vector<Source::Slot>* slots : {&source->slots, &source->weights}) {
      for (Source::Slot& slot : *slots) {
        const uint64_t owner = owners[slot.key];
        slot.is_owned = owner == source->id;
        if (slot.is_owned) continue;
        source->is_refused = true;
        if (!std::exchange(source->has_told_refusal, true))
          spdlog::warn("{} names {}, which live source {:016x} moves until that has been silent for 0.5 s",
                       source->name(), slot.key, owner);
      }
    }
    if (!source->movesHair()) continue;
    const auto before = owners_.find(source->slots[*source->carrier].key);
    if (before == owners_.end() || before->second != source->id) source->takes_over = true;
  }
  owners_ = std::move(owners);
}

bool LivePoses::take(Source& source, int64_t end_ns, int64_t step_ns) {
  const bool was_locked = source.lock.isLocked();
  const int64_t hold = source.hold(step_ns, nanosecondsOf(options_.delay_max));
  if (source.has_last && source.track && source.lock.lockIfDue(end_ns, hold)) {
    counters_.relocks += was_locked;
    if (source.lock.beganTimeline()) {
      source.clock.restart();
      source.track->forget();
      addSamples(source, source.last);
    }
    source.awaits_period = source.period == 0;
    if (hold > 0) source.exact_steps = 0;
  } else if (source.awaits_period && source.period > 0) {
    // Steps have stood at the only sample since, and begin to move from there.
    source.awaits_period = false;
    if (hold > 0) {
      source.lock.holdBack(end_ns, hold);
      source.exact_steps = 0;
    }
  }
  if (!source.lock.isLocked() || !source.track) return false;
  const auto time = [&] { return source.lock.timeOf(end_ns); };
  if (source.taken != nullptr && source.taken->state == PoseState::kResting)
    if (const std::optional<int64_t> nearest = source.track->nearest(time()))
      source.lock.takePhase(time() - *nearest, step_ns);
  source.taken = &source.track->advance(time(), step_ns);
  if (source.taken->state == PoseState::kNone) return false;
  const int64_t age = time() - source.taken->shown.time_ns;
  if (source.taken->is_exact) source.lock.followPhase(age, step_ns);
  // Without the next sample a step is between samples where that is not yet due.
  if (source.taken->state == PoseState::kLive || source.taken->state == PoseState::kRejoining ||
      age < source.period - step_ns / 100)
    source.exact_steps = source.exact_steps << 1 | (source.taken->is_exact ? 1 : 0);
  if (!source.moves()) return false;
  append(source, source.taken->shown);
  return std::exchange(source.takes_over, false) || source.taken->is_cut;
}

void LivePoses::append(const Source& source, const PoseSample& shown) {
  PoseSamples& poses = step_.poses;
  const auto hasRoom = [](const std::string& names, const std::string& more, size_t bytes) {
    return names.size() + 1 + more.size() <= bytes;
  };
  for (size_t slot = 0; slot < source.slots.size(); ++slot) {
    if (!source.slots[slot].is_owned) continue;
    if (poses.poses.size() >= 7 * kMaxPoseNames ||
        !hasRoom(poses.names, source.slots[slot].key, kMaxPoseNameBytes))
      break;
    appendName(poses.names, source.slots[slot].key);
    // Between samples, and after them, numbers may leave the range of messages.
    const Vec3 position = shown.poses[slot].position.cwiseMax(-kFarthestPosed).cwiseMin(kFarthestPosed);
    const Vec3 scale = shown.scales.empty()
                           ? Vec3(Vec3::Ones())
                           : Vec3(shown.scales[slot].cwiseMax(kLeastScale).cwiseMin(kMostScale));
    poses.poses.insert(poses.poses.end(), position.data(), position.data() + 3);
    const auto& rotation = shown.poses[slot].rotation.coeffs();
    poses.poses.insert(poses.poses.end(), rotation.data(), rotation.data() + 4);
    poses.scales.insert(poses.scales.end(), scale.data(), scale.data() + 3);
  }
  constexpr size_t kPrefix = std::string_view("weight:").size();
  for (size_t k = 0; k < source.weights.size(); ++k) {
    if (!source.weights[k].is_owned) continue;
    if (poses.weights.size() >= kMaxWeightNames ||
        !hasRoom(poses.weight_names, source.weights[k].key, kMaxWeightNameBytes))
      break;
    appendName(poses.weight_names, source.weights[k].key.substr(kPrefix));
    poses.weights.push_back(std::clamp(shown.weights[k], -kMostWeight, kMostWeight));
  }
}

const LivePoses::Source* LivePoses::carrier() const {
  const Source* first = nullptr;
  for (const std::unique_ptr<Source>& source : sources_) {
    if (source->taken == nullptr || source->taken->state == PoseState::kNone || !source->moves()) continue;
    if (source->movesHair()) return source.get();
    if (first == nullptr) first = source.get();
  }
  return first;
}

bool LivePoses::advance(double end, int64_t now) {
  if (recorded_) {
    const std::optional<StepPoses> recorded = recorded_(simulation_.steps());
    shown_source_ = recorded ? recorded->poses.source : 0;
    shown_time_ = recorded ? recorded->poses.time : 0;
    if (!recorded) return false;
    targets_.apply(recorded->poses);
    return recorded->is_cut;
  }
  receive(end, now);
  assign(now);
  shown_source_ = shown_time_ = 0;
  if (sources_.empty()) return false;
  step_.step = simulation_.steps();
  step_.is_cut = false;
  PoseSamples& poses = step_.poses;
  poses.names.clear();
  poses.weight_names.clear();
  poses.ages = {0};
  poses.poses.clear();
  poses.scales.clear();
  poses.weights.clear();
  const int64_t step_ns = nanosecondsOf(double{simulation_.parameters().time_step});
  for (const std::unique_ptr<Source>& source : sources_)
    step_.is_cut |= take(*source, nanosecondsOf(end), step_ns);
  const Source* const source = carrier();
  if (source == nullptr) return false;
  const PoseTrack::Step& taken = *source->taken;
  counters_.extrapolated += taken.state == PoseState::kExtrapolating;
  counters_.rested += taken.state == PoseState::kResting;
  counters_.interpolated +=
      !taken.is_exact && (taken.state == PoseState::kLive || taken.state == PoseState::kRejoining);
  counters_.jumps += step_.is_cut;
  shown_source_ = source->id;
  shown_time_ = static_cast<uint64_t>(taken.shown.time_ns);
  poses.source = shown_source_;
  poses.time = shown_time_;
  const auto hasScales = [](const std::unique_ptr<Source>& known) { return known->has_scales; };
  if (std::none_of(sources_.begin(), sources_.end(), hasScales)) poses.scales.clear();
  publisher_.recordPoses(step_);
  targets_.apply(poses);
  return step_.is_cut;
}

void LivePoses::idle(double end, int64_t now) {
  if (recorded_) return;
  receive(end, now);
  assign(now);
  release();
}

std::vector<LivePoses::Delay> LivePoses::delays() const {
  std::vector<Delay> delays;
  for (const std::unique_ptr<Source>& source : sources_)
    if (source->lock.isLocked()) delays.push_back({source->id, source->lock.delay(), source->lock.locks()});
  return delays;
}

void LivePoses::adopt(const Delay& delay) {
  for (const std::unique_ptr<Source>& source : sources_)
    if (source->id == delay.source) {
      source->lock.adopt(delay.ns);
      source->awaits_period = false;
    }
}

std::vector<PoseTargets::Held> LivePoses::held() const {
  std::vector<PoseTargets::Held> held = targets_.held();
  std::erase_if(held, [&](const PoseTargets::Held& thing) { return owners_.contains(thing.name); });
  return held;
}

void LivePoses::restore(const PoseTargets::Held& held, const std::string& where) {
  if (!owners_.contains(held.name)) targets_.restore(held, where);
}

void LivePoses::release() {
  for (const std::unique_ptr<Source>& source : sources_) source->lock.release();
}

std::optional<std::chrono::steady_clock::time_point> LivePoses::wantedAt(double end) const {
  using Time = std::chrono::steady_clock::time_point;
  std::optional<int64_t> latest;
  for (const std::unique_ptr<Source>& source : sources_)
    if (source->lock.isLocked() && source->moves()) {
      const int64_t wanted = source->wallOf(nanosecondsOf(end), nanosecondsOf(options_.delay_max));
      latest = std::max(latest.value_or(wanted), wanted);
    }
  if (!latest) return std::nullopt;
  return Time(std::chrono::nanoseconds(*latest));
}

void LivePoses::countFrame(int64_t now) {
  const Source* const shown = carrier();
  if (shown == nullptr) return;
  Source& source = **std::find_if(sources_.begin(), sources_.end(),
                                  [&](const auto& known) { return known.get() == shown; });
  const PoseSample& sample = source.taken->shown;
  if (std::exchange(source.has_counted, true) && source.counted == sample.number) return;
  source.counted = sample.number;
  addToRing(latencies_ms_, latencies_, kFramesMeasured,
            toMilliseconds(now - sample.time_ns - source.clock.offset()));
}

PoseMetrics LivePoses::metrics(int64_t now) const {
  PoseMetrics out = counters_;
  out.sources = static_cast<uint32_t>(sources_.size());
  out.latency_ms_p50 = quantileOf(latencies_ms_, 0.5);
  out.latency_ms_p99 = quantileOf(latencies_ms_, 0.99);
  out.clock_ms = quantileOf(clocks_ms_, 0.5);
  if (const Source* const source = carrier()) {
    const int64_t longest = nanosecondsOf(options_.delay_max), time = source->taken->shown.time_ns;
    out.state = source->taken->state;
    out.delay_ms = toMilliseconds(source->clock.wallOf(0, source->wait(), longest) - source->clock.offset());
    out.jitter_ms = toMilliseconds(source->clock.lateness());
    out.age_ms = toMilliseconds(now - time - source->clock.offset());
  }
  return out;
}

void LivePoses::checkBodyFree(const std::string& name, const std::string& where) const {
  if (const auto owner = owners_.find("body:" + withoutSpaces(name)); owner != owners_.end())
    refuse(owner->second, "collider '" + name + "'", where);
}

void LivePoses::refuse(uint64_t source, const std::string& what, const std::string& where) {
  throw Error(
      fmt::format("live source {:016x} moves {}", source, what), where,
      fmt::format("end that program; commands move it {} s after its last poses", kGone / kNsPerSecond));
}

void LivePoses::checkHeadFree(const std::string& where) const {
  if (const auto owner = owners_.find("head"); owner != owners_.end())
    refuse(owner->second, "the head", where);
  for (const std::unique_ptr<Source>& source : sources_)
    if (source->movesHair()) refuse(source->id, "the head's joint", where);
}

}  // namespace strandcast
