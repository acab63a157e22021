#include "transport/pose_inbox.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "transport/chunks.h"
#include "transport/frame_queue.h"
#include "transport/parameter_table.h"

namespace strandcast {
namespace {

constexpr std::pair<std::string_view, PosedKind> kKinds[] = {
    {"joint:", PosedKind::kJoint}, {"bone:", PosedKind::kBone}, {"body:", PosedKind::kBody}};

PosedName posedName(std::string_view text) {
  if (text == "head") return {PosedKind::kHead, {}};
  for (const auto& [prefix, kind] : kKinds)
    if (text.starts_with(prefix)) return {kind, withSpaces(text.substr(prefix.size()))};
  return {PosedKind::kOther, withSpaces(text)};
}

bool areWithin(std::span<const float> numbers, float least, float most) {
  return std::all_of(numbers.begin(), numbers.end(), [=](float n) { return n >= least && n <= most; });
}

float length(std::span<const float, 4> rotation) {
  float square = 0;
  for (const float n : rotation) square += n * n;
  return std::sqrt(square);
}

bool isPose(std::span<const float, 7> pose) {
  if (!areWithin(pose.first<3>(), -kFarthestPosed, kFarthestPosed)) return false;
  const float norm = length(pose.last<4>());
  return norm >= 0.5f && norm <= 1.5f;
}

bool areNames(const std::string& text, size_t count) {
  const std::vector<std::string_view> names = splitNames(text);
  return names.size() == count && areDistinctNames(names);
}

}  // namespace

std::vector<PosedName> posedNames(const PoseSamples& samples) {
  std::vector<PosedName> names;
  for (const std::string_view name : splitNames(samples.names)) names.push_back(posedName(name));
  return names;
}

std::vector<std::string> weightNames(const PoseSamples& samples) {
  std::vector<std::string> names;
  for (const std::string_view name : splitNames(samples.weight_names)) names.push_back(withSpaces(name));
  return names;
}

bool isSound(const PoseSamples& samples) {
  const auto& [source, time, sent_time, groom_id, newest, epoch, names_revision, names, weight_names, ages,
               poses, scales, weights, arrival_time] = samples;
  const size_t count = ages.size();
  if (source == 0 || count < 1 || count > kMaxPoseSamples || ages[0] != 0 || ages.back() > time ||
      std::adjacent_find(ages.begin(), ages.end(), std::greater_equal()) != ages.end())
    return false;
  const size_t posed = posesPerSample(samples), weighed = weightsPerSample(samples);
  if (posed > kMaxPoseNames || weighed > kMaxWeightNames || posed + weighed == 0 ||
      poses.size() != 7 * count * posed || weights.size() != count * weighed ||
      (!scales.empty() && scales.size() != 3 * count * posed) || names.size() > kMaxPoseNameBytes ||
      weight_names.size() > kMaxWeightNameBytes ||
      bytesOf(poses, scales, weights) + names.size() + weight_names.size() > kMaxChunkBytes)
    return false;
  const bool has_names = !names.empty() || !weight_names.empty();
  if (has_names && !(areNames(names, posed) && areNames(weight_names, weighed))) return false;
  for (size_t i = 0; i < poses.size(); i += 7)
    if (!isPose(std::span<const float, 7>(poses.data() + i, 7))) return false;
  return areWithin(scales, kLeastScale, kMostScale) && areWithin(weights, -kMostWeight, kMostWeight);
}

bool PoseInbox::push(PoseSamples samples) {
  if ((samples.groom_id != 0 && samples.groom_id != groom_id_) || !isSound(samples)) return false;
  samples.arrival_time = steadyTime();
  for (size_t i = 0; i < samples.poses.size(); i += 7) {
    const std::span<float, 4> rotation(samples.poses.data() + i + 3, 4);
    const float norm = length(rotation);
    for (float& n : rotation) n /= norm;
  }
  const std::lock_guard lock(mutex_);
  waiting_.push_back(std::move(samples));
  if (waiting_.size() > kMaxQueuedPoses) waiting_.pop_front();
  return true;
}

std::optional<PoseSamples> PoseInbox::take() {
  const std::lock_guard lock(mutex_);
  if (waiting_.empty()) return std::nullopt;
  PoseSamples oldest = std::move(waiting_.front());
  waiting_.pop_front();
  return oldest;
}

}  // namespace strandcast
