#include "scenes/skinned_body.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/name_lookup.h"
#include "io/bvh_skeleton.h"
#include "io/file_bytes.h"
#include "io/file_report.h"
#include "scenes/head_motion.h"

namespace strandcast {
namespace {

Pose rigid(const Placement& placement) {
  return {Vec3(placement.translation().cast<float>()), jointRotation(placement)};
}

Placement placementOf(const Pose& pose) {
  Placement out = Placement::Identity();
  out.translate(pose.position.cast<double>());
  out.rotate(pose.rotation.cast<double>());
  return out;
}

/// The first few distinct names.
std::string firstNamesOf(const std::vector<std::string>& names) {
  constexpr size_t kMax = 8;
  std::vector<std::string> shown;
  for (const std::string& name : names)
    if (const std::string plain = printable(name);
        std::find(shown.begin(), shown.end(), plain) == shown.end())
      shown.push_back(plain);
  const bool are_more = shown.size() > kMax;
  if (are_more) shown.resize(kMax);
  return fmt::format("{}{}", fmt::join(shown, ", "), are_more ? ", ..." : "");
}

/// Suggests the name that was probably meant, or lists those that exist.
std::string suggestionFor(const std::string& name, const std::vector<std::string>& names) {
  const std::string near = didYouMean(name, names);
  return near.empty() ? fmt::format("it has {}", fmt::join(names, ", ")) : near;
}

size_t jointNamed(const Skeleton& skeleton, const std::string& name, const std::string& where) {
  const int found = name.empty() ? -1 : skeleton.find(name);
  if (found >= 0) return static_cast<size_t>(found);
  std::vector<std::string> names;
  for (const SkeletonJoint& joint : skeleton.joints) names.push_back(joint.name);
  throw Error("the body has no joint '" + name + "'", where, suggestionFor(name, names));
}

/// The joint called `name`. Without a name, the head's joint among those that carry skin (other nodes, such
/// as meshes, may have such names, too), or the only joint that carries skin.
size_t rootedJoint(const SkinnedMesh& skin, const std::string& name) {
  if (!name.empty()) return jointNamed(skin.skeleton, name, skin.mesh.name);
  Skeleton carrying;
  std::vector<uint32_t> joints;
  std::vector<std::string> names;
  for (const SkinBinding& binding : skin.bindings) {
    joints.push_back(binding.joint);
    names.push_back(skin.skeleton.joints[binding.joint].name);
    carrying.joints.push_back({skin.skeleton.joints[binding.joint].name, -1, {}});
  }
  const int found = carrying.find("");
  if (found >= 0) return joints[static_cast<size_t>(found)];
  if (joints.size() == 1) return joints.front();
  throw Error("no joint of the body has 'head' in its name", skin.mesh.name,
              fmt::format("name the one that hair grows on (--body-joint): {}", firstNamesOf(names)));
}

SkeletonClip clipNamed(SkinnedMesh& skin, const SkinnedMotion& motion, std::vector<std::string>& notes) {
  const std::string& name = motion.clip;
  if (name.empty()) return {};
  if (lowerExtension(name) == ".bvh") {
    const BvhClip bvh = readBvh(std::filesystem::path(name));
    appendReport(name, bvh.report, notes, skin.report.warnings);
    BvhOnSkeleton found = onSkeleton(bvh, skin.skeleton, motion.clip_unit_meters, name);
    for (const std::string& note : found.notes) notes.push_back(fmt::format("{}: {}", name, note));
    for (const std::string& warning : found.warnings)
      skin.report.warnings.push_back(fmt::format("{}: {}", name, warning));
    notes.push_back(fmt::format("{} of {} joints of the body are moved by {}", found.joints,
                                skin.skeleton.joints.size(), name));
    return std::move(found.clip);
  }
  std::vector<std::string> names;
  for (const SkeletonClip& clip : skin.clips) {
    if (clip.name == name) return clip;
    names.push_back(clip.name);
  }
  const std::string there = names.empty() ? "it has none; give a .bvh file" : suggestionFor(name, names);
  const std::string without = skin.report.omissionsLine();
  throw Error("the body has no clip '" + name + "'", skin.mesh.name,
              without.empty() ? there : there + "; it was read " + without);
}

/// Cuts the parts from the skin wound as by orientSurface: the caps take their winding from it.
std::vector<SkinPart> cutOriented(const SkinnedMesh& skin, SurfaceRepair& repair) {
  OrientedSurface oriented = orientSurface(skin.mesh);
  repair = oriented.repair;
  if (!repair.changed()) return cutSkin(skin);
  SkinnedMesh mended = skin;
  mended.mesh.triangles = std::move(oriented.mesh.triangles);
  return cutSkin(mended);
}

JointTransform between(const JointTransform& a, const JointTransform& b, double t) {
  const auto share = static_cast<float>(t);
  return {a.translation + share * (b.translation - a.translation), a.rotation.slerp(share, b.rotation),
          a.scale + share * (b.scale - a.scale)};
}

}  // namespace

SkinnedBody::SkinnedBody(SkinnedMesh skin, const SkinnedMotion& motion)
    : skin_(std::move(skin)), joint_(rootedJoint(skin_, motion.joint)) {
  choose(motion);
  parts_ = cutOriented(skin_, repair_);
  rest_locals_ = skin_.skeleton.rest();
  rest_ = skin_.skeleton.worldTransforms(rest_locals_);
  for (size_t j = 0; j < rest_.size(); ++j) {
    const int parent = skin_.skeleton.joints[j].parent;
    below_.push_back(j == joint_ || (parent >= 0 && below_[static_cast<size_t>(parent)]));
  }
  for (int j = static_cast<int>(joint_); j >= 0; j = skin_.skeleton.joints[carriers_.back()].parent)
    carriers_.push_back(static_cast<size_t>(j));
  first_ = last_ = rest_locals_;
  clip_.pose(0, first_);
  clip_.pose(clip_.duration, last_);
  noteTravel();
}

/// Notes the travel of the joint that travels farthest.
void SkinnedBody::noteTravel() {
  const std::vector<Placement> placed = skin_.skeleton.worldTransforms(first_);
  size_t farthest = 0;
  double most = 0;
  for (size_t j = 0; j < first_.size(); ++j) {
    const int parent = skin_.skeleton.joints[j].parent;
    const Placement& above = parent < 0 ? skin_.skeleton.root : placed[static_cast<size_t>(parent)];
    const double travel =
        (above.linear() * (last_[j].translation - first_[j].translation).cast<double>()).norm();
    if (!(travel > most)) continue;
    most = travel;
    farthest = j;
  }
  if (most > kNotableTravel) notes_.push_back(travelText("the clip " + clip_.name, nameOf(farthest), most));
}

/// Selects the clip and discards other clips and the targets that nothing weighs.
void SkinnedBody::choose(const SkinnedMotion& motion) {
  clip_ = clipNamed(skin_, motion, notes_);
  skin_.clips.clear();
  if (motion.targets == BodyTargets::kClip) skin_.keepTargets(clip_);
  rest_weights_ = first_weights_ = skin_.restWeights();
  clip_.weigh(0, first_weights_);
  if (skin_.targets.empty()) return;
  std::vector<std::string> names;
  for (const MorphTarget& target : skin_.targets) names.push_back(target.name);
  notes_.push_back(fmt::format("{} {} morph targets ({})",
                               motion.targets == BodyTargets::kClip ? "the clip plays" : "the skin has",
                               skin_.targets.size(), firstNamesOf(names)));
}

Vec3 SkinnedBody::pivot() const { return Vec3(rest_[joint_].translation().cast<float>()); }

std::vector<float> SkinnedBody::jointWeights() const {
  std::vector<float> out;
  for (const SkinInfluences& influences : skin_.influences) {
    float sum = 0;
    for (const auto& [binding, weight] : influences)
      if (weight > 0 && below_[skin_.bindings[binding].joint]) sum += weight;
    out.push_back(std::min(sum, 1.0f));
  }
  return out;
}

SkinnedBody::ClipTime SkinnedBody::clipTime(double seconds) const {
  const double period = clip_.duration;
  const double t = period > 0 ? std::fmod(std::max(seconds, 0.0), period) : 0;
  const double blend = std::min(kLoopBlend, 0.5 * period);
  return {t, period > 0 ? t / period : 0, blend > 0 ? 1 - ease((period - t) / blend) : 0,
          ease(seconds / kStartSeconds)};
}

std::vector<JointTransform> SkinnedBody::played(double seconds) const {
  std::vector<JointTransform> locals = rest_locals_;
  if (clip_.channels.empty()) return locals;
  const ClipTime at = clipTime(seconds);
  clip_.pose(at.seconds, locals);
  for (size_t j = 0; j < locals.size(); ++j) {
    const auto travelled = static_cast<float>(at.share) * (last_[j].translation - first_[j].translation);
    const Vec3 stays = locals[j].translation - travelled;
    locals[j] = between(locals[j], first_[j], at.back);
    locals[j].translation = stays;
    locals[j] = between(rest_locals_[j], locals[j], at.from_rest);
  }
  return locals;
}

std::vector<float> SkinnedBody::weightsAt(double seconds) const {
  std::vector<float> weights = rest_weights_;
  const ClipTime at = clipTime(seconds);
  clip_.weigh(at.seconds, weights);
  for (size_t t = 0; t < weights.size(); ++t) {
    const float looped = std::lerp(weights[t], first_weights_[t], static_cast<float>(at.back));
    weights[t] = std::lerp(rest_weights_[t], looped, static_cast<float>(at.from_rest));
  }
  return weights;
}

Pose SkinnedBody::carried(double seconds) const {
  return rigid(skin_.skeleton.worldTransforms(played(seconds))[joint_]) * rigid(rest_[joint_]).inverse();
}

SkinnedBody::Moment SkinnedBody::at(double seconds, const Pose& head, std::span<const float> weights) const {
  return momentOf(skin_.skeleton.worldTransforms(played(seconds)),
                  weights.empty() ? weightsAt(seconds) : std::vector<float>(weights.begin(), weights.end()),
                  head);
}

SkinnedBody::Moment SkinnedBody::fromPalette(std::span<const std::optional<Placement>> motions,
                                             std::span<const float> weights, const Pose& head) const {
  std::vector<Placement> moved, joints;  // moved: motion from rest of each joint
  for (size_t j = 0; j < rest_.size(); ++j) {
    const int parent = skin_.skeleton.joints[j].parent;
    const Placement inherited = parent < 0 ? Placement::Identity() : moved[static_cast<size_t>(parent)];
    moved.push_back(motions[j].value_or(inherited));
    joints.push_back(moved[j] * rest_[j]);
  }
  return momentOf(std::move(joints),
                  weights.empty() ? rest_weights_ : std::vector<float>(weights.begin(), weights.end()), head);
}

SkinnedBody::Moment SkinnedBody::momentOf(std::vector<Placement> joints, std::vector<float> weights,
                                          const Pose& head) const {
  const Pose carried = rigid(joints[joint_]) * rigid(rest_[joint_]).inverse();
  const Placement turn = placementOf(carried * head * carried.inverse());
  for (size_t j = 0; j < joints.size(); ++j)
    if (below_[j]) joints[j] = turn * joints[j];
  std::vector<Placement> bindings = skin_.bindingsAt(joints, weights);
  return {carried, std::move(joints), std::move(weights), std::move(bindings)};
}

std::vector<SkinnedBody::PlacedPart> SkinnedBody::placedParts(const Moment& moment) const {
  std::vector<PlacedPart> out;
  for (const SkinPart& part : parts_) {
    const Pose pose = partPose(part, moment.bindings);
    out.push_back({pose, partBend(part, moment.bindings, pose)});
  }
  return out;
}

std::vector<Vec3> SkinnedBody::surface(double seconds, const Pose& head) const {
  const Moment moment = at(seconds, head);
  return skin_.blended(moment.joints, moment.weights);
}

/// Per joint, whether neither it nor an ancestor has an animated or non-uniform scale.
std::vector<bool> SkinnedBody::rigidJoints() const {
  constexpr float kRounding = 1e-5f;
  std::vector<bool> rigid(skin_.skeleton.joints.size(), true);
  for (const ClipChannel& channel : clip_.channels)
    if (channel.path == ClipPath::kScale) rigid[channel.joint] = false;
  for (size_t j = 0; j < rigid.size(); ++j) {
    const SkeletonJoint& joint = skin_.skeleton.joints[j];
    const Vec3 size = joint.rest.scale.cwiseAbs();
    if (size.maxCoeff() - size.minCoeff() > kRounding * size.maxCoeff() ||
        (joint.parent >= 0 && !rigid[static_cast<size_t>(joint.parent)]))
      rigid[j] = false;
  }
  return rigid;
}

void SkinnedBody::growOnSkin(const StrandSet& strands, size_t max_bones) {
  roots_.emplace(skin_, rigidJoints(), static_cast<uint32_t>(joint_), strands, max_bones);
}

std::vector<Pose> SkinnedBody::placedRoots(const Moment& moment) const {
  std::vector<Pose> poses(roots_ ? roots_->bones() : 0);
  if (!poses.empty()) roots_->place(moment.bindings, moment.weights, poses);
  return poses;
}

void SkinnedBody::checkJoint(const std::string& joint, const std::string& where) const {
  jointNamed(skin_.skeleton, joint, where);
}

void SkinnedBody::attachToJoint(BodyId body, const std::string& joint) {
  attached_bodies_.emplace_back(body, jointNamed(skin_.skeleton, joint, skin_.mesh.name));
}

const std::string* SkinnedBody::jointOf(BodyId body) const {
  for (const auto& [attached, joint] : attached_bodies_)
    if (attached == body) return &nameOf(joint);
  return nullptr;
}

std::vector<SkinnedBody::AttachedBody> SkinnedBody::placedBodies(const Moment& moment) const {
  std::vector<AttachedBody> out;
  for (const auto& [body, joint] : attached_bodies_) {
    Pose pose = rigid(moment.joints[joint]) * rigid(rest_[joint]).inverse();
    pose.rotation.normalize();
    out.push_back({body, pose});
  }
  return out;
}

void place(const SkinnedBody& body, const SkinnedBody::Moment& moment, const Pose& head,
           Simulation& simulation) {
  Pose carried = moment.carried * head;
  carried.rotation.normalize();
  simulation.setHeadPose(carried);
  const std::vector<Pose> roots = body.placedRoots(moment);
  for (size_t bone = 0; bone < roots.size(); ++bone) simulation.setBonePose(bone + 1, roots[bone]);
  BodyId id = body.first_body;
  for (const SkinnedBody::PlacedPart& part : body.placedParts(moment)) {
    simulation.setBodyPose(id, part.pose);
    if (simulation.body(id).bends) simulation.setBodyBend(id, part.bend);
    ++id;
  }
  for (const SkinnedBody::AttachedBody& attached : body.placedBodies(moment))
    if (simulation.hasBody(attached.body)) simulation.setBodyPose(attached.body, attached.pose);
}

void moveTo(const SkinnedBody* body, double seconds, const Pose& head, Simulation& simulation) {
  if (body == nullptr) return simulation.setHeadPose(head);
  place(*body, body->at(seconds, head), head, simulation);
}

}  // namespace strandcast
