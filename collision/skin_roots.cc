#include "collision/skin_roots.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "collision/mesh_query.h"
#include "collision/skin_parts.h"
#include "core/error.h"
#include "core/geometry.h"

namespace strandcast {
namespace {

constexpr int64_t kNoCell = std::numeric_limits<int64_t>::min();  // stands for no cell
using BoneKey = std::array<int64_t, 4>;  ///< a joint, and a cell of space, kNoCell, or the number of a strand

/// A root near the skin.
struct TiedRoot {
  size_t strand;
  MeshPoint on;
  uint32_t joint;  ///< the joint with the largest weight there
  bool whole;      ///< that joint has the whole weight and is rigid
};

/// The joint with the largest weight at a point of the skin, and whether it has all the weight.
std::pair<uint32_t, bool> dominantJoint(const SkinnedMesh& skin, const MeshPoint& on) {
  std::map<uint32_t, float> weights;
  for (int c = 0; c < 3; ++c)
    for (const auto& [binding, weight] : skin.influences[skin.mesh.triangles[on.triangle][c]])
      if (weight > 0 && on.barycentric[c] > 0)
        weights[skin.bindings[binding].joint] += weight * on.barycentric[c];
  const auto most = std::max_element(weights.begin(), weights.end(),
                                     [](const auto& a, const auto& b) { return a.second < b.second; });
  return {most->first, weights.size() == 1};
}

/// Whether morph targets move a point. `shares`: of all vertices; empty if there are no targets.
bool isMoved(const SkinnedMesh& skin, const std::vector<std::vector<SkinShare>>& shares,
             const MeshPoint& on) {
  if (shares.empty()) return false;
  const auto& corners = skin.mesh.triangles[on.triangle];
  return std::any_of(corners.begin(), corners.end(), [&](uint32_t v) {
    return !shares[v].empty() && shares[v].back().binding >= skin.bindings.size();
  });
}

BoneKey keyOf(const TiedRoot& root, float cell) {
  if (root.whole) return {root.joint, kNoCell, 0, 0};
  if (cell == 0) return {root.joint, static_cast<int64_t>(root.strand), 0, 0};
  BoneKey key{root.joint, 0, 0, 0};
  for (int c = 0; c < 3; ++c)
    key[static_cast<size_t>(c) + 1] = static_cast<int64_t>(std::floor(root.on.position[c] / cell));
  return key;
}

/// Edge in m of the smallest cells, in steps of a factor 1.2, that need no more than `most` bones; 0 if each
/// root may have a bone.
float cellOf(const std::vector<TiedRoot>& roots, const BoneKey& head, size_t most) {
  constexpr float kFinest = 5e-4f, kLarger = 1.2f;
  for (float cell = 0;; cell = cell > 0 ? kLarger * cell : kFinest) {
    std::set<BoneKey> keys;
    for (const TiedRoot& root : roots) keys.insert(keyOf(root, cell));
    keys.erase(head);
    if (keys.size() <= most) return cell;
    if (cell > 2 * kFarthestPose)
      throw Error("too few bones for the joints that hair grows on",
                  fmt::format("{} of {}", most, keys.size()), "pin hair to fewer bones");
  }
}

}  // namespace

SkinRoots::SkinRoots(const SkinnedMesh& skin, const std::vector<bool>& rigid, uint32_t joint,
                     const StrandSet& strands, size_t most)
    : root_bones_(strands.strands(), 0) {
  const std::vector<Placement> rest = skin.bindingsAt(skin.skeleton.worldTransforms(skin.skeleton.rest()));
  rest_weights_ = skin.restWeights();
  joint_bindings_ = skin.bindings.size();
  for (size_t b = 0; b < joint_bindings_; ++b) back_.push_back(rest[b].linear().inverse());
  const std::vector<std::vector<SkinShare>> shares =
      skin.targets.empty() ? std::vector<std::vector<SkinShare>>() : skinShares(skin);
  const MeshQuery query(skin.mesh);
  std::vector<TiedRoot> roots;
  for (size_t s = 0; s < strands.strands(); ++s) {
    const MeshPoint on = query.closest(strands.strand(s)[0]);
    if (on.distance > kFarthestFromSkin) continue;
    const auto [carrier, all] = dominantJoint(skin, on);
    roots.push_back({s, on, carrier, all && rigid[carrier] && !isMoved(skin, shares, on)});
  }
  const BoneKey head{joint, kNoCell, 0, 0};
  const float cell = cellOf(roots, head, most);
  std::map<BoneKey, uint16_t> bones{{head, uint16_t{0}}};
  size_t on_head = 0;
  for (const TiedRoot& root : roots) {
    const auto [bone, is_new] = bones.try_emplace(keyOf(root, cell), static_cast<uint16_t>(bones.size()));
    if (is_new) addPoint(skin, shares, rest, skin.mesh.triangles[root.on.triangle], root.on.barycentric);
    root_bones_[root.strand] = bone->second;
    on_head += bone->second == 0;
  }
  const std::string& name = skin.skeleton.joints[joint].name;
  if (!roots.empty())
    notes_.push_back(fmt::format("{} of {} roots follow the skin under them, {} of these all of '{}'",
                                 roots.size(), strands.strands(), on_head, name));
  if (cell > 0)
    notes_.push_back(
        fmt::format("there are more roots than bones: those within {:.2g} mm of each other share one of {}",
                    1e3f * cell, points_.size()));
  if (const size_t far = strands.strands() - roots.size(); far > 0)
    notes_.push_back(fmt::format("{} of {} roots are farther than {:g} mm from the skin: they follow '{}'",
                                 far, strands.strands(), 1e3f * kFarthestFromSkin, name));
}

void SkinRoots::addPoint(const SkinnedMesh& skin, const std::vector<std::vector<SkinShare>>& shares,
                         std::span<const Placement> rest, const std::array<uint32_t, 3>& triangle,
                         const Vec3& barycentric) {
  std::map<uint32_t, Eigen::Vector4d> terms;
  // Target -> displacements of the corners at rest, m.
  std::map<uint32_t, std::array<Eigen::Vector3d, 3>> moves;
  for (int c = 0; c < 3; ++c) {
    const uint32_t v = triangle[static_cast<size_t>(c)];
    for (const auto& [binding, weight] : skin.influences[v]) {
      const double share = static_cast<double>(barycentric[c]) * static_cast<double>(weight);
      if (share > 0)
        terms.try_emplace(binding, Eigen::Vector4d::Zero()).first->second +=
            share * skin.stored[v].cast<double>().homogeneous();
    }
    if (shares.empty()) continue;
    for (const SkinShare& share : shares[v]) {
      if (share.binding < joint_bindings_) continue;
      terms.try_emplace(share.binding, Eigen::Vector4d::Zero()).first->second +=
          static_cast<double>(barycentric[c]) * share.stored;
      const auto& [target, binding] = skin.target_bindings[share.binding - joint_bindings_];
      const Eigen::Vector3d zero = Eigen::Vector3d::Zero();
      moves.try_emplace(target, std::array{zero, zero, zero}).first->second[static_cast<size_t>(c)] +=
          rest[binding].linear() * share.stored.head<3>();
    }
  }
  Point& point = points_.emplace_back();
  point.rest.setZero();
  for (const auto& [binding, stored] : terms) {
    point.rest += rest[binding].matrix() * stored;
    point.terms.push_back({binding, stored});
  }
  const Vec3& origin = skin.mesh.positions[triangle[0]];
  for (size_t e = 0; e < 2; ++e)
    point.edges.col(static_cast<int>(e)) = (skin.mesh.positions[triangle[e + 1]] - origin).cast<double>();
  for (const auto& [target, corners] : moves) {
    Tilt tilt{target, {}};
    tilt.edges.col(0) = corners[1] - corners[0];
    tilt.edges.col(1) = corners[2] - corners[0];
    point.tilts.push_back(tilt);
  }
}

/// Rotation of the triangle under a root by targets, with joints at rest: the rotation nearest to the linear
/// map of its edges and normal.
Eigen::Matrix3d SkinRoots::rotationByTargets(const Point& point, std::span<const float> weights) const {
  Columns edges = point.edges;
  for (const Tilt& tilt : point.tilts)
    edges += (static_cast<double>(weights[tilt.target]) - static_cast<double>(rest_weights_[tilt.target])) *
             tilt.edges;
  const auto frame = [](const Columns& of, double thickness) {
    Eigen::Matrix3d columns;
    const Eigen::Vector3d normal = of.col(0).cross(of.col(1));
    columns << of.col(0), of.col(1), thickness / std::max(normal.norm(), 1e-30) * normal;
    return columns;
  };
  const double thickness = std::sqrt(point.edges.col(0).cross(point.edges.col(1)).norm());
  const Eigen::Matrix3d turn = frame(edges, thickness) * frame(point.edges, thickness).inverse();
  return turn.allFinite() ? nearestRotation(turn).cast<double>().toRotationMatrix()
                          : Eigen::Matrix3d::Identity();
}

void SkinRoots::addTo(StrandModel& model) const {
  if (model.strands() != root_bones_.size() || model.bones.size() != 1 || !model.pin_bones.empty())
    throw Error("the roots on the skin do not belong to this model", "SkinRoots::addTo",
                "pass the model of the same strands, before anything is pinned to bones");
  if (points_.empty()) return;
  for (size_t bone = 1; bone <= points_.size(); ++bone) model.bones.push_back(fmt::format("skin {}", bone));
  model.root_bones = root_bones_;
}

void SkinRoots::place(std::span<const Placement> bindings, std::span<const float> weights,
                      std::span<Pose> poses) const {
  std::vector<Eigen::Matrix3d> turns;
  for (size_t b = 0; b < joint_bindings_; ++b) turns.emplace_back(bindings[b].linear() * back_[b]);
  for (size_t p = 0; p < points_.size(); ++p) {
    Eigen::Vector3d now = Eigen::Vector3d::Zero();
    Eigen::Matrix3d turn = Eigen::Matrix3d::Zero();
    for (const SkinShare& term : points_[p].terms) {
      now += bindings[term.binding].matrix() * term.stored;
      if (term.binding < joint_bindings_) turn += term.stored[3] * turns[term.binding];
    }
    if (!points_[p].tilts.empty() && !weights.empty()) turn = turn * rotationByTargets(points_[p], weights);
    const Quat rotation = nearestRotation(turn);
    poses[p] = {Vec3((now - rotation.cast<double>() * points_[p].rest).cast<float>()), rotation};
  }
}

}  // namespace strandcast
