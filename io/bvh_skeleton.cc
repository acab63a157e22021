#include "io/bvh_skeleton.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/error.h"
#include "io/bvh_text.h"

namespace strandcast {
namespace {

/// Whether joint `above` is `joint` or an ancestor of it.
bool isDescendantOf(const BvhClip& clip, int joint, int above) {
  while (joint > above) joint = clip.joints[static_cast<size_t>(joint)].parent;
  return joint == above;
}

/// Weighted quantile of the bone ratios: the ratio below which lies a `share` of the body's length.
double ratioAt(const std::vector<std::pair<double, double>>& ratios, double share) {
  double all = 0, sum = 0;
  for (const auto& [ratio, length] : ratios) all += length;
  for (const auto& [ratio, length] : ratios) {
    sum += length;
    if (sum >= share * all) return ratio;
  }
  return ratios.back().first;
}

/// Pairs (ratio of body bone to clip bone, length of body bone), sorted by ratio.
std::vector<std::pair<double, double>> boneRatios(const std::vector<BvhMatch::Bone>& bones) {
  std::vector<std::pair<double, double>> ratios;
  for (const BvhMatch::Bone& bone : bones)
    ratios.emplace_back(bone.body.norm() / static_cast<double>(bone.clip.norm()), bone.body.norm());
  std::sort(ratios.begin(), ratios.end());
  return ratios;
}

Quat quarterTurn() {
  return Quat(Eigen::AngleAxisf(-std::numbers::pi_v<float> / 2, Eigen::Vector3f::UnitX()));
}

}  // namespace

BvhMatch::BvhMatch(const BvhClip& clip, const Skeleton& skeleton) {
  for (const SkeletonJoint& joint : skeleton.joints) {
    namesakes.push_back(joint.name.empty() ? -1 : clip.find(joint.name));
    joints += namesakes.back() >= 0 ? 1 : 0;
  }
  const std::vector<Placement> rest = skeleton.worldTransforms(skeleton.rest());
  for (size_t j = 0; j < namesakes.size(); ++j) {
    if (namesakes[j] < 0) continue;
    int above = skeleton.joints[j].parent;
    while (above >= 0 && namesakes[static_cast<size_t>(above)] < 0)
      above = skeleton.joints[static_cast<size_t>(above)].parent;
    if (above < 0 || !isDescendantOf(clip, namesakes[j], namesakes[static_cast<size_t>(above)])) continue;
    const Bone bone{rest[j].translation() - rest[static_cast<size_t>(above)].translation(),
                    clip.restPosition(static_cast<size_t>(namesakes[j])) -
                        clip.restPosition(static_cast<size_t>(namesakes[static_cast<size_t>(above)]))};
    if (bone.body.norm() > 0 && bone.clip.norm() > 0) bones.push_back(bone);
  }
}

Quat BvhMatch::upright(const BvhClip& clip, size_t head) const {
  double as_it_is = 0, turned = 0, all = 0;
  for (const Bone& bone : bones) {
    const Eigen::Vector3d direction = bone.clip.cast<double>().normalized();
    as_it_is += bone.body.dot(direction);
    turned += bone.body.dot((quarterTurn() * Vec3(direction.cast<float>())).cast<double>());
    all += bone.body.norm();
  }
  constexpr double kClear = 0.01;  // share of the total length of bones
  if (!(std::abs(as_it_is - turned) > kClear * all)) return clip.upright(head);
  return turned > as_it_is ? quarterTurn() : Quat(Quat::Identity());
}

BvhUnit unitOf(const BvhClip& clip, const BvhMatch* match, float given) {
  constexpr double kAlike = 2;  // factor within which ratios, and units, count as alike
  BvhUnit out;
  const std::vector<std::pair<double, double>> ratios =
      match != nullptr ? boneRatios(match->bones) : std::vector<std::pair<double, double>>();
  const double median = ratios.empty() ? 0 : ratioAt(ratios, 0.5);
  if (given > 0) {
    out.meters = given;
    const double off = ratios.empty() ? 1 : static_cast<double>(given) / median;
    if (off > kAlike || off < 1 / kAlike)
      out.warnings.push_back(
          fmt::format("with a unit of {:g} m its bones are {:.3g} times as long as the body's: is "
                      "--clip-unit-meters right?",
                      given, off));
    return out;
  }
  if (ratios.empty()) {
    out.meters = clip.guessedUnit();
    const float size = clip.size();
    if (size > 0)
      out.warnings.push_back(fmt::format(
          "its unit is guessed: {:g} m, which makes its skeleton {:.3g} m large ({:.4g} units); give "
          "--clip-unit-meters to be sure",
          out.meters, size * out.meters, size));
    else
      out.warnings.push_back(
          fmt::format("its unit is guessed: {:g} m, as its joints are in one place; give --clip-unit-meters",
                      out.meters));
    return out;
  }
  out.meters = static_cast<float>(median);
  out.notes.push_back(
      fmt::format("its unit is guessed: {:.4g} m, the ratio of {} bone{} of the body to the clip's; give "
                  "--clip-unit-meters to be sure",
                  median, ratios.size(), ratios.size() == 1 ? "" : "s"));
  if (ratioAt(ratios, 0.75) > kAlike * ratioAt(ratios, 0.25))
    out.warnings.push_back(
        fmt::format("its bones are {:.3g} to {:.3g} m a unit long as the body's are: is it of "
                    "another skeleton?",
                    ratios.front().first, ratios.back().first));
  return out;
}

namespace {

/// Cubic spline through values per frame, with central differences as tangents (Catmull-Rom).
ClipSampler splineThrough(const std::vector<Eigen::Vector4f>& values, uint32_t components,
                          double frame_time) {
  ClipSampler out;
  out.interpolation = ClipInterpolation::kCubicSpline;
  out.components = components;
  for (size_t f = 0; f < values.size(); ++f) {
    out.times.push_back(static_cast<float>(frame_time * static_cast<double>(f)));
    const size_t before = f == 0 ? 0 : f - 1, after = std::min(f + 1, values.size() - 1);
    const auto seconds = static_cast<float>(frame_time * static_cast<double>(after - before));
    const Eigen::Vector4f tangent =
        seconds > 0 ? Eigen::Vector4f((values[after] - values[before]) / seconds) : Eigen::Vector4f::Zero();
    for (const Eigen::Vector4f& v : {tangent, values[f], tangent})
      out.values.insert(out.values.end(), v.data(), v.data() + components);
  }
  return out;
}

/// Flips the signs of quaternions so that each has a non-negative dot product with the previous one.
void alignSigns(std::vector<Eigen::Vector4f>& quaternions) {
  for (size_t f = 1; f < quaternions.size(); ++f)
    if (quaternions[f].dot(quaternions[f - 1]) < 0) quaternions[f] *= -1;
}

}  // namespace

BvhOnSkeleton onSkeleton(const BvhClip& bvh, const Skeleton& skeleton, float unit_meters,
                         const std::string& name) {
  const BvhMatch match(bvh, skeleton);
  const std::vector<int>& namesake = match.namesakes;
  BvhOnSkeleton out;
  out.joints = match.joints;
  if (out.joints == 0)
    throw Error("no joint of the clip has the name of one of the body's", name,
                "rename them: the clip has " + BvhText::shown(bvh.joints.front().name) + ", the body " +
                    BvhText::shown(skeleton.joints.front().name));
  BvhUnit unit = unitOf(bvh, &match, unit_meters);
  out.unit_meters = unit.meters;
  out.notes = std::move(unit.notes);
  out.warnings = std::move(unit.warnings);
  const Quat up = match.upright(bvh, static_cast<size_t>(std::max(bvh.find(""), 0)));
  const std::vector<Placement> rest = skeleton.worldTransforms(skeleton.rest());
  const size_t joints = skeleton.joints.size();
  std::vector<std::vector<Eigen::Vector4f>> turns(joints), moves(joints);
  std::vector<Quat> moved(joints);  // world rotation relative to rest
  for (size_t f = 0; f < bvh.frames; ++f)
    for (size_t j = 0; j < joints; ++j) {
      const SkeletonJoint& joint = skeleton.joints[j];
      const bool is_root = joint.parent < 0;
      const auto parent = static_cast<size_t>(joint.parent);
      const Placement& above = is_root ? skeleton.root : rest[parent];
      const Quat above_moved = is_root ? Quat(Quat::Identity()) : moved[parent];
      moved[j] = above_moved;
      if (namesake[j] < 0) continue;
      const auto other = static_cast<size_t>(namesake[j]);
      const Pose pose = bvh.pose(other, f);
      moved[j] = (up * pose.rotation * up.conjugate()).normalized();
      const Quat axes = jointRotation(above);
      const Quat turn = axes.conjugate() * above_moved.conjugate() * moved[j] * axes * joint.rest.rotation;
      turns[j].emplace_back(turn.normalized().coeffs());
      if (bvh.joints[other].parent >= 0) continue;
      const Vec3 travel = up * (pose.position - bvh.pose(other, 0).position) * out.unit_meters;
      const Eigen::Vector3d local = above.inverse() * (rest[j].translation() + travel.cast<double>());
      moves[j].emplace_back(local.cast<float>().homogeneous());
    }
  out.clip.name = name;
  out.clip.duration = bvh.frame_time * static_cast<double>(bvh.frames - 1);
  const auto add = [&](size_t joint, ClipPath path, const std::vector<Eigen::Vector4f>& values,
                       uint32_t components) {
    out.clip.channels.push_back(
        {static_cast<uint32_t>(joint), path, static_cast<uint32_t>(out.clip.samplers.size())});
    out.clip.samplers.push_back(splineThrough(values, components, bvh.frame_time));
  };
  for (size_t j = 0; j < joints; ++j) {
    alignSigns(turns[j]);
    if (!turns[j].empty()) add(j, ClipPath::kRotation, turns[j], 4);
    if (!moves[j].empty()) add(j, ClipPath::kTranslation, moves[j], 3);
  }
  return out;
}

}  // namespace strandcast
