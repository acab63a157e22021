#include "io/skeleton.h"

#include "core/geometry.h"

#include <algorithm>
#include <cctype>

namespace strandcast {
namespace {

bool mentionsHead(std::string name) {
  for (char& c : name) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return name.find("head") != std::string::npos;
}

}  // namespace

Placement JointTransform::placement() const {
  Placement out = Placement::Identity();
  out.translate(translation.cast<double>());
  out.rotate(rotation.cast<double>());
  out.scale(scale.cast<double>());
  return out;
}

int Skeleton::find(const std::string& name) const {
  for (size_t j = 0; j < joints.size(); ++j)
    if (name.empty() ? mentionsHead(joints[j].name) : joints[j].name == name) return static_cast<int>(j);
  return -1;
}

std::vector<JointTransform> Skeleton::rest() const {
  std::vector<JointTransform> locals;
  for (const SkeletonJoint& joint : joints) locals.push_back(joint.rest);
  return locals;
}

std::vector<Placement> Skeleton::worldTransforms(std::span<const JointTransform> locals) const {
  std::vector<Placement> world;
  world.reserve(joints.size());
  for (size_t j = 0; j < joints.size(); ++j) {
    const int parent = joints[j].parent;
    world.push_back((parent < 0 ? root : world[static_cast<size_t>(parent)]) * locals[j].placement());
  }
  return world;
}

Eigen::Vector4f ClipSampler::at(double seconds) const {
  const bool cubic = interpolation == ClipInterpolation::kCubicSpline;
  const auto read = [&](size_t key, size_t slot) {
    Eigen::Vector4f out = Eigen::Vector4f::Zero();
    const float* from = values.data() + (cubic ? 3 * key + slot : key) * components;
    std::copy(from, from + components, out.data());
    return out;
  };
  const auto value = [&](size_t key) { return read(key, 1); };
  const auto unit = [&](const Eigen::Vector4f& v) {
    return components == 4 && v.norm() > 0 ? Eigen::Vector4f(v.normalized()) : v;
  };
  const auto after = static_cast<size_t>(std::upper_bound(times.begin(), times.end(), seconds) -
                                         times.begin());  // the first key after `seconds`
  if (after == 0) return unit(value(0));
  if (after == times.size()) return unit(value(after - 1));
  const size_t before = after - 1;
  if (interpolation == ClipInterpolation::kStep) return unit(value(before));
  const double span = static_cast<double>(times[after]) - static_cast<double>(times[before]);
  const auto t = static_cast<float>((seconds - static_cast<double>(times[before])) / span);
  if (cubic) {
    const auto length = static_cast<float>(span);
    const float t2 = t * t, t3 = t2 * t;
    return unit((2 * t3 - 3 * t2 + 1) * value(before) + length * (t3 - 2 * t2 + t) * read(before, 2) +
                (3 * t2 - 2 * t3) * value(after) + length * (t3 - t2) * read(after, 0));
  }
  if (components == 4)
    return Quat(unit(value(before))).slerp(t, Quat(unit(value(after)))).coeffs();  // the shorter arc
  return (1 - t) * value(before) + t * value(after);
}

void SkeletonClip::pose(double seconds, std::span<JointTransform> locals) const {
  for (const ClipChannel& channel : channels) {
    const Eigen::Vector4f value = samplers[channel.sampler].at(seconds);
    JointTransform& local = locals[channel.joint];
    switch (channel.path) {
      case ClipPath::kTranslation:
        local.translation = value.head<3>();
        break;
      case ClipPath::kRotation:
        local.rotation.coeffs() = value;
        break;
      case ClipPath::kScale:
        local.scale = value.head<3>();
        break;
    }
  }
}

void SkeletonClip::weigh(double seconds, std::span<float> weights) const {
  for (const MorphChannel& channel : morphs)
    weights[channel.target] = samplers[channel.sampler].at(seconds)[0];
}

Quat jointRotation(const Placement& joint) {
  const Eigen::Matrix3d linear = joint.linear();
  return nearestRotation(linear.determinant() < 0 ? Eigen::Matrix3d(-linear) : linear);
}

}  // namespace strandcast
