#include "transport/pose_sender.h"

#include <algorithm>
#include <limits>
#include <random>

#include "core/error.h"
#include "transport/chunks.h"
#include "transport/frame_queue.h"
#include "transport/parameter_table.h"
#include "transport/pose_inbox.h"

namespace strandcast {
namespace {

constexpr std::chrono::milliseconds kNamesPeriod{500};

/// Names as one text. Throws Error where they exceed the wire.
std::string namesText(const std::vector<std::string>& names, size_t most, size_t most_bytes,
                      const char* where) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : " ") + withoutSpaces(name);
  if (names.size() > most || text.size() > most_bytes)
    throw Error("there are too many names", where,
                "give at most " + std::to_string(most) + " of " + std::to_string(most_bytes) + " bytes");
  const std::vector<std::string_view> split = splitNames(text);
  if (split.size() != names.size() || !areDistinctNames(split))
    throw Error("a name is empty, has a control character or occurs twice", where, "name each once");
  return text;
}

void append(std::vector<float>& to, const std::vector<float>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

}  // namespace

PoseSender::PoseSender(uint32_t groom_id, size_t samples) : samples_(samples) {
  std::random_device random;
  while (message_.source == 0) message_.source = random() | static_cast<uint64_t>(random()) << 32;
  message_.groom_id = groom_id;
}

void PoseSender::setNames(const std::vector<std::string>& names,
                          const std::vector<std::string>& weight_names) {
  std::string text = namesText(names, kMaxPoseNames, kMaxPoseNameBytes, "names of poses");
  weight_names_ = namesText(weight_names, kMaxWeightNames, kMaxWeightNameBytes, "names of weights");
  names_ = std::move(text);
  name_count_ = names.size();
  weight_count_ = weight_names.size();
  ++message_.names_revision;
  named_ = {};
  sent_.clear();
}

void PoseSender::cut() {
  ++message_.epoch;
  last_time_.reset();
  sent_.clear();
}

void PoseSender::send(uint64_t time, std::span<const Pose> poses, std::span<const float> weights,
                      std::span<const Vec3> scales) {
  const std::string where = "poses at " + std::to_string(time) + " ns";
  if (last_time_ && time <= *last_time_)
    throw Error("the time does not ascend", where, "call cut() where the clock was set");
  if (name_count_ + weight_count_ == 0 || poses.size() != name_count_ || weights.size() != weight_count_ ||
      (!scales.empty() && scales.size() != name_count_))
    throw Error("the numbers of poses, weights or scales are not those of the names", where,
                "give one for each name of setNames()");
  sent_.push_front({time, {}, {}, {weights.begin(), weights.end()}});
  Sample& sample = sent_.front();
  for (const Pose& pose : poses) {
    sample.poses.insert(sample.poses.end(), pose.position.data(), pose.position.data() + 3);
    const auto& rotation = pose.rotation.coeffs();
    sample.poses.insert(sample.poses.end(), rotation.data(), rotation.data() + 4);
  }
  for (const Vec3& scale : scales) sample.scales.insert(sample.scales.end(), scale.data(), scale.data() + 3);
  fillMessage();
  if (!isSound(message_)) {
    sent_.pop_front();
    throw Error("a number is not finite or out of range", where, "transport/pose_sender.h has the ranges");
  }
  last_time_ = time;
  ++message_.newest;
  if (!message_.names.empty() || !message_.weight_names.empty()) named_ = std::chrono::steady_clock::now();
  if (sent_.size() == samples_) sent_.pop_back();
  message_.sent_time = systemTime();
  write(message_);
}

void PoseSender::fillMessage() {
  const bool with_names = std::chrono::steady_clock::now() - named_ >= kNamesPeriod;
  message_.names = with_names ? names_ : std::string();
  message_.weight_names = with_names ? weight_names_ : std::string();
  message_.time = sent_.front().time;
  message_.ages.clear();
  message_.poses.clear();
  message_.scales.clear();
  message_.weights.clear();
  const bool has_scales = !sent_.front().scales.empty();
  size_t bytes = message_.names.size() + message_.weight_names.size();
  for (const Sample& sample : sent_) {
    const uint64_t age = message_.time - sample.time;
    bytes += bytesOf(sample.poses, sample.scales, sample.weights);
    // A sample without scales cannot stand beside one with them.
    const bool fits = age <= std::numeric_limits<uint32_t>::max() && bytes <= kMaxChunkBytes &&
                      !sample.scales.empty() == has_scales;
    if (!fits && &sample != &sent_.front()) break;
    message_.ages.push_back(static_cast<uint32_t>(age));
    append(message_.poses, sample.poses);
    append(message_.scales, sample.scales);
    append(message_.weights, sample.weights);
  }
}

}  // namespace strandcast
