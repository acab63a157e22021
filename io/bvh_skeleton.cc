#include "io/bvh_skeleton.h"

#include <algorithm>
#include <utility>

#include "core/error.h"
#include "io/bvh_text.h"
#include "io/bvh_unit.h"

namespace strandcast {
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
  const std::vector<Placement> rest = skeleton.place(skeleton.rest());
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
