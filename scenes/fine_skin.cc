#include "scenes/fine_skin.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace strandcast {
namespace {

class Refiner {
 public:
  explicit Refiner(const SkinnedMesh& skin) : skin_(skin) {
    std::vector<std::vector<SkinShare>> shares = skinShares(skin);
    // Merges coincident vertices: files duplicate them at discontinuities of normals or textures.
    std::map<std::array<float, 3>, uint32_t> first;
    std::vector<uint32_t> welded;
    for (size_t v = 0; v < skin.mesh.positions.size(); ++v) {
      const Vec3& p = skin.mesh.positions[v];
      const auto [at, is_new] =
          first.try_emplace({p.x(), p.y(), p.z()}, static_cast<uint32_t>(fine_.positions.size()));
      welded.push_back(at->second);
      if (is_new) {
        fine_.positions.push_back(p);
        fine_.normals.push_back(skin.mesh.normals[v]);
        fine_.shares.push_back(std::move(shares[v]));
      } else {
        fine_.normals[at->second] += skin.mesh.normals[v];
      }
    }
    for (Vec3& normal : fine_.normals) normal.normalize();
    for (std::array<uint32_t, 3> triangle : skin.mesh.triangles) {
      for (uint32_t& v : triangle) v = welded[v];
      fine_.triangles.push_back(triangle);
    }
  }

  FineSkin run() {
    constexpr int kMostRounds = 5;       // down to 1/32 of an edge
    constexpr size_t kEnough = 100'000;  // triangles; a round at most quadruples them
    for (int round = 0; round < kMostRounds && fine_.triangles.size() < kEnough; ++round)
      if (!splitOnce()) break;
    return std::move(fine_);
  }

 private:
  /// Total change of the joints' weights from one vertex to another, 0 to 1.
  double change(uint32_t a, uint32_t b) const {
    // Targets displace edges linearly, so their shares need no vertices in between.
    std::map<uint32_t, double> weights;
    for (const SkinShare& share : fine_.shares[a])
      if (share.binding < skin_.bindings.size())
        weights[skin_.bindings[share.binding].joint] += share.weight();
    for (const SkinShare& share : fine_.shares[b])
      if (share.binding < skin_.bindings.size())
        weights[skin_.bindings[share.binding].joint] -= share.weight();
    double sum = 0;
    for (const auto& joint : weights) sum += 0.5 * std::fabs(joint.second);
    return sum;
  }

  uint32_t middleOf(uint32_t a, uint32_t b) {
    std::map<uint32_t, Eigen::Vector4d> terms;
    for (const uint32_t v : {a, b})
      for (const SkinShare& share : fine_.shares[v])
        terms.try_emplace(share.binding, Eigen::Vector4d::Zero()).first->second += 0.5 * share.stored;
    std::vector<SkinShare> shares;
    for (const auto& [binding, stored] : terms) shares.push_back({binding, stored});
    fine_.shares.push_back(std::move(shares));
    fine_.positions.push_back(0.5f * (fine_.positions[a] + fine_.positions[b]));
    fine_.normals.push_back((fine_.normals[a] + fine_.normals[b]).normalized());
    return static_cast<uint32_t>(fine_.positions.size() - 1);
  }

  double lengthOf(const std::pair<uint32_t, uint32_t>& edge) const {
    return static_cast<double>((fine_.positions[edge.first] - fine_.positions[edge.second]).norm());
  }

  /// Halves each edge along which weights change too much, and long edges next to such places. The decision
  /// depends only on the edge's ends, so the triangles on both sides still share vertices.
  bool splitOnce() {
    // Per vertex, the shortest length over which weights change by kMostChange along an edge, m.
    std::vector<double> ways(fine_.positions.size(), std::numeric_limits<double>::max());
    std::map<std::pair<uint32_t, uint32_t>, double> changes;
    for (const auto& t : fine_.triangles)
      for (size_t c = 0; c < 3; ++c) {
        const std::pair<uint32_t, uint32_t> edge = std::minmax(t[c], t[(c + 1) % 3]);
        const auto [known, is_new] = changes.try_emplace(edge, 0.0);
        if (!is_new) continue;
        known->second = change(edge.first, edge.second);
        if (!(known->second > 0)) continue;
        for (const uint32_t v : {edge.first, edge.second})
          ways[v] = std::min(ways[v], kMostChange / known->second * lengthOf(edge));
      }
    const auto isSplit = [&](const std::pair<uint32_t, uint32_t>& edge, double changed) {
      const auto [less, more] = std::minmax(ways[edge.first], ways[edge.second]);
      return changed > kMostChange || (more > 2 * less && lengthOf(edge) > 2 * less);
    };
    std::map<std::pair<uint32_t, uint32_t>, uint32_t> middles;
    for (const auto& [edge, changed] : changes)
      if (isSplit(edge, changed)) middles[edge] = middleOf(edge.first, edge.second);
    std::vector<std::array<uint32_t, 3>> triangles;
    const auto middle = [&](uint32_t a, uint32_t b) {
      const auto found = middles.find(std::minmax(a, b));
      return found == middles.end() ? kNone : found->second;
    };
    for (std::array<uint32_t, 3> t : fine_.triangles) {
      std::array<uint32_t, 3> m{};
      for (size_t c = 0; c < 3; ++c) m[c] = middle(t[c], t[(c + 1) % 3]);
      const auto halved = 3 - std::count(m.begin(), m.end(), kNone);
      // Rotates the triangle so that a single halved edge comes first, a single unhalved edge last.
      const auto turn = [&] {
        std::rotate(t.begin(), t.begin() + 1, t.end());
        std::rotate(m.begin(), m.begin() + 1, m.end());
      };
      while ((halved == 1 && m[0] == kNone) || (halved == 2 && m[2] != kNone)) turn();
      switch (halved) {
        case 0:
          triangles.push_back(t);
          break;
        case 1:
          triangles.push_back({t[0], m[0], t[2]});
          triangles.push_back({m[0], t[1], t[2]});
          break;
        case 2: {
          triangles.push_back({m[0], t[1], m[1]});
          const auto length = [&](uint32_t a, uint32_t b) {
            return (fine_.positions[a] - fine_.positions[b]).norm();
          };
          if (length(t[0], m[1]) < length(m[0], t[2])) {
            triangles.push_back({t[0], m[0], m[1]});
            triangles.push_back({t[0], m[1], t[2]});
          } else {
            triangles.push_back({t[0], m[0], t[2]});
            triangles.push_back({m[0], m[1], t[2]});
          }
          break;
        }
        default:
          triangles.push_back({t[0], m[0], m[2]});
          triangles.push_back({m[0], t[1], m[1]});
          triangles.push_back({m[2], m[1], t[2]});
          triangles.push_back({m[0], m[1], m[2]});
      }
    }
    fine_.triangles = std::move(triangles);
    return !middles.empty();
  }

  static constexpr uint32_t kNone = ~0u;
  // Less than half of a part between joints, since adjacent parts overlap by as much.
  static constexpr double kMostChange = 0.08;
  const SkinnedMesh& skin_;
  FineSkin fine_;
};

}  // namespace

std::vector<std::vector<SkinShare>> skinShares(const SkinnedMesh& skin) {
  std::vector<std::map<uint32_t, Eigen::Vector4d>> terms(skin.stored.size());
  for (size_t v = 0; v < terms.size(); ++v) {
    std::map<uint32_t, double> weights;
    for (const auto& [binding, weight] : skin.influences[v])
      if (weight > 0) weights[binding] += static_cast<double>(weight);
    for (const auto& [binding, weight] : weights)
      terms[v][binding] = weight * skin.stored[v].cast<double>().homogeneous();
  }
  std::map<std::pair<uint32_t, uint32_t>, uint32_t> numbers;  // (target, binding) -> index
  for (size_t i = 0; i < skin.target_bindings.size(); ++i)
    numbers[{skin.target_bindings[i].target, skin.target_bindings[i].binding}] =
        static_cast<uint32_t>(skin.bindings.size() + i);
  for (uint32_t t = 0; t < skin.targets.size(); ++t)
    for (const auto& [vertex, by] : skin.targets[t].moves)
      for (const auto& [binding, weight] : skin.influences[vertex]) {
        if (!(weight > 0)) continue;
        Eigen::Vector4d move = Eigen::Vector4d::Zero();
        move.head<3>() = static_cast<double>(weight) * by.cast<double>();
        terms[vertex].try_emplace(numbers.at({t, binding}), Eigen::Vector4d::Zero()).first->second += move;
      }
  std::vector<std::vector<SkinShare>> out(terms.size());
  for (size_t v = 0; v < terms.size(); ++v)
    for (const auto& [binding, stored] : terms[v]) out[v].push_back({binding, stored});
  return out;
}

FineSkin fineSkin(const SkinnedMesh& skin) { return Refiner(skin).run(); }

Eigen::Vector3d blended(const std::vector<SkinShare>& shares, std::span<const Placement> bindings) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const SkinShare& share : shares) sum += bindings[share.binding].matrix() * share.stored;
  return sum;
}

}  // namespace strandcast
