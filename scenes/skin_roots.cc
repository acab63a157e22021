#include "scenes/skin_roots.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "collision/mesh_query.h"
#include "core/error.h"
#include "core/nearest_rotation.h"
#include "core/pose_check.h"
#include "scenes/skin_parts.h"

namespace strandcast {
namespace {

constexpr int64_t kNoCell = std::numeric_limits<int64_t>::min();  // in place of a cell
using BoneKey = std::array<int64_t, 4>;  ///< a joint and a cell of space, or kNoCell, or a strand's number

/// A root that is near the skin.
struct TiedRoot {
  size_t strand;
  MeshPoint on;
  uint32_t joint;  ///< that carries most of the skin there
  bool whole;      ///< it carries all of it, rigidly
};

/// The joint that carries most of a point of the skin, and whether it carries all.
std::pair<uint32_t, bool> mostOf(const SkinnedMesh& skin, const MeshPoint& on) {
  std::map<uint32_t, float> weights;
  for (int c = 0; c < 3; ++c)
    for (const auto& [binding, weight] : skin.influences[skin.mesh.triangles[on.triangle][c]])
      if (weight > 0 && on.barycentric[c] > 0)
        weights[skin.bindings[binding].joint] += weight * on.barycentric[c];
  const auto most = std::max_element(weights.begin(), weights.end(),
                                     [](const auto& a, const auto& b) { return a.second < b.second; });
  return {most->first, weights.size() == 1};
}

BoneKey keyOf(const TiedRoot& root, float cell) {
  if (root.whole) return {root.joint, kNoCell, 0, 0};
  if (cell == 0) return {root.joint, static_cast<int64_t>(root.strand), 0, 0};
  BoneKey key{root.joint, 0, 0, 0};
  for (int c = 0; c < 3; ++c)
    key[static_cast<size_t>(c) + 1] = static_cast<int64_t>(std::floor(root.on.position[c] / cell));
  return key;
}

/// m: the edge of the smallest cells, each size a fifth larger than the one before, of which there are no
/// more than `most`; 0 where every root may have a bone.
float cellOf(const std::vector<TiedRoot>& roots, const BoneKey& head, size_t most) {
  constexpr float kFinest = 5e-4f, kLarger = 1.2f;
  for (float cell = 0;; cell = cell > 0 ? kLarger * cell : kFinest) {
    std::set<BoneKey> keys;
    for (const TiedRoot& root : roots) keys.insert(keyOf(root, cell));
    keys.erase(head);
    if (keys.size() <= most) return cell;
    if (cell > 2 * kFarthestPose)
      throw Error("there are too few bones for the joints that hair grows on",
                  fmt::format("{} of {}", most, keys.size()), "pin hair to fewer bones");
  }
}

}  // namespace

SkinRoots::SkinRoots(const SkinnedMesh& skin, const std::vector<bool>& rigid, uint32_t joint,
                     const StrandSet& strands, size_t most)
    : root_bones_(strands.strands(), 0) {
  const std::vector<Placement> rest = skin.bindingsAt(skin.skeleton.place(skin.skeleton.rest()));
  for (const Placement& binding : rest) back_.push_back(binding.linear().inverse());
  const MeshQuery query(skin.mesh);
  std::vector<TiedRoot> roots;
  for (size_t s = 0; s < strands.strands(); ++s) {
    const MeshPoint on = query.closest(strands.strand(s)[0]);
    if (on.distance > kFarthestFromSkin) continue;
    const auto [carrier, all] = mostOf(skin, on);
    roots.push_back({s, on, carrier, all && rigid[carrier]});
  }
  const BoneKey head{joint, kNoCell, 0, 0};
  const float cell = cellOf(roots, head, most);
  std::map<BoneKey, uint16_t> bones{{head, uint16_t{0}}};
  size_t on_head = 0;
  for (const TiedRoot& root : roots) {
    const auto [bone, is_new] = bones.try_emplace(keyOf(root, cell), static_cast<uint16_t>(bones.size()));
    if (is_new) addPoint(skin, rest, skin.mesh.triangles[root.on.triangle], root.on.barycentric);
    root_bones_[root.strand] = bone->second;
    on_head += bone->second == 0;
  }
  const std::string& name = skin.skeleton.joints[joint].name;
  if (!roots.empty())
    notes_.push_back(fmt::format("{} of {} roots go with the skin under them, {} of these with all of '{}'",
                                 roots.size(), strands.strands(), on_head, name));
  if (cell > 0)
    notes_.push_back(
        fmt::format("there are more roots than bones: those within {:.2g} mm of each other share one of {}",
                    1e3f * cell, points_.size()));
  if (const size_t far = strands.strands() - roots.size(); far > 0)
    notes_.push_back(fmt::format("{} of {} roots are farther than {:g} mm from the skin: they go with '{}'",
                                 far, strands.strands(), 1e3f * kFarthestFromSkin, name));
}

void SkinRoots::addPoint(const SkinnedMesh& skin, std::span<const Placement> rest,
                         const std::array<uint32_t, 3>& triangle, const Vec3& barycentric) {
  std::map<uint32_t, Eigen::Vector4d> terms;
  for (int c = 0; c < 3; ++c) {
    const uint32_t v = triangle[static_cast<size_t>(c)];
    for (const auto& [binding, weight] : skin.influences[v]) {
      const double share = static_cast<double>(barycentric[c]) * static_cast<double>(weight);
      if (share > 0)
        terms.try_emplace(binding, Eigen::Vector4d::Zero()).first->second +=
            share * skin.stored[v].cast<double>().homogeneous();
    }
  }
  points_.push_back({terms_.size(), Eigen::Vector3d::Zero()});
  for (const auto& [binding, stored] : terms) {
    points_.back().rest += rest[binding].matrix() * stored;
    terms_.push_back({binding, stored});
  }
}

void SkinRoots::addTo(StrandModel& model) const {
  if (model.strands() != root_bones_.size() || model.bones.size() != 1 || !model.pin_bones.empty())
    throw Error("roots on a skin are not those of this model", "SkinRoots::addTo",
                "tie the model of the same strands, before anything is pinned to bones");
  if (points_.empty()) return;
  for (size_t bone = 1; bone <= points_.size(); ++bone) model.bones.push_back(fmt::format("skin {}", bone));
  model.root_bones = root_bones_;
}

void SkinRoots::place(std::span<const Placement> bindings, std::span<Pose> poses) const {
  std::vector<Eigen::Matrix3d> turns;
  for (size_t b = 0; b < bindings.size(); ++b) turns.emplace_back(bindings[b].linear() * back_[b]);
  for (size_t p = 0; p < points_.size(); ++p) {
    const size_t end = p + 1 < points_.size() ? points_[p + 1].first_term : terms_.size();
    Eigen::Vector3d now = Eigen::Vector3d::Zero();
    Eigen::Matrix3d turn = Eigen::Matrix3d::Zero();
    for (size_t t = points_[p].first_term; t < end; ++t) {
      const Term& term = terms_[t];
      now += bindings[term.binding].matrix() * term.stored;
      turn += term.stored[3] * turns[term.binding];
    }
    const Quat rotation = nearestRotation(turn);
    poses[p] = {Vec3((now - rotation.cast<double>() * points_[p].rest).cast<float>()), rotation};
  }
}

}  // namespace strandcast
