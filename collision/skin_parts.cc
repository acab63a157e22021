#include "collision/skin_parts.h"

#include <fmt/format.h>
#include <Eigen/Cholesky>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <set>

#include "core/error.h"
#include "core/geometry.h"

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
    constexpr int kMaxRounds = 5;        // down to 1/32 of an edge
    constexpr size_t kEnough = 100'000;  // triangles; a round at most quadruples them
    for (int round = 0; round < kMaxRounds && fine_.triangles.size() < kEnough; ++round)
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
    // Per vertex, the shortest length over which weights change by kMaxChange along an edge, m.
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
          ways[v] = std::min(ways[v], kMaxChange / known->second * lengthOf(edge));
      }
    const auto isSplit = [&](const std::pair<uint32_t, uint32_t>& edge, double changed) {
      const auto [less, more] = std::minmax(ways[edge.first], ways[edge.second]);
      return changed > kMaxChange || (more > 2 * less && lengthOf(edge) > 2 * less);
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
  static constexpr double kMaxChange = 0.08;
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

namespace {

/// Position of a triangle between two joints, the lower index first.
struct Place {
  uint32_t a = 0, b = 0;
  float share = 0;  ///< weight of b over the sum of both
};
/// Key of a part: two joints and a number. With two equal joints, number 0 is the joint's own part; others
/// hold what morph targets move of it.
using PartKey = std::array<uint32_t, 3>;

/// Statistics of the triangles between two joints.
struct Pair {
  int between;      ///< number of parts
  double area = 0;  ///< m^2, of triangles dominated by these two joints
  /// Order in which pairs lose a part, least important first.
  std::pair<bool, double> rank() const { return {between == 1, area / between}; }
};

Place placeOf(const FineSkin& fine, std::span<const SkinBinding> bindings,
              const std::array<uint32_t, 3>& triangle) {
  std::map<uint32_t, float> weights;
  for (const uint32_t v : triangle)
    for (const SkinShare& share : fine.shares[v])
      if (share.binding < bindings.size())
        weights[bindings[share.binding].joint] += static_cast<float>(share.weight());
  std::pair<uint32_t, float> most{0, -1}, next{0, -1};
  for (const auto& joint : weights) {
    if (joint.second > most.second) {
      next = most;
      most = joint;
    } else if (joint.second > next.second) {
      next = joint;
    }
  }
  if (next.second <= 0) return {most.first, most.first, 0};
  const float share = next.second / (most.second + next.second);
  if (most.first < next.first) return {most.first, next.first, share};
  return {next.first, most.first, 1 - share};
}

class Cutter {
 public:
  Cutter(const SkinnedMesh& skin, int between) : skin_(skin), fine_(fineSkin(skin)) {
    for (const auto& triangle : fine_.triangles) {
      places_.push_back(placeOf(fine_, skin.bindings, triangle));
      const Place& place = places_.back();
      if (place.a == place.b) continue;
      Pair& pair = pairs_.try_emplace({place.a, place.b}, Pair{between}).first->second;
      pair.area += areaOf(triangle);
    }
    const std::vector<Placement> world = skin.skeleton.worldTransforms(skin.skeleton.rest());
    const std::vector<Placement> rest = skin.bindingsAt(world);
    for (size_t b = 0; b < skin.bindings.size(); ++b) {
      const Eigen::Matrix3d linear = rest[b].linear();
      back_.push_back(linear.inverse());
      if (!back_.back().allFinite())
        throw Error("a joint has no inverse at rest",
                    skin.mesh.name + ", joint " + nameOf(skin.bindings[b].joint),
                    "export it with a scale above 0");
    }
    back_.resize(rest.size(), Eigen::Matrix3d::Zero());  // of targets: they do not rotate
    moved_ = movedByTargets(rest);
    for (size_t t = 0; t < places_.size(); ++t)
      if (moved_[t]) boxes_[ownOf(places_[t])[0]].extend(Eigen::Vector3f(middleOf(t)));
  }

  std::vector<SkinPart> run() {
    for (assign(); cores_.size() > kMaxSkinParts; assign()) {
      bool less = false;
      if (cells_ > 1 && !boxes_.empty()) {
        cells_ = 1;
        continue;
      }
      for (size_t over = cores_.size() - kMaxSkinParts; over > 0 && lessBetween(); --over) less = true;
      if (!less && cells_ > 0 && !boxes_.empty()) {
        cells_ = 0;
        continue;
      }
      if (!less)
        throw Error(fmt::format("{} joints carry the mesh", cores_.size()), skin_.mesh.name,
                    fmt::format("export it with {} at most", kMaxSkinParts));
    }
    std::vector<SkinPart> parts;
    for (const auto& [key, core] : cores_) parts.push_back(partOf(key, core));
    return parts;
  }

 private:
  // Share of another joint up to which a triangle is in a joint's own, rigid part.
  static constexpr float kOwn = 0.02f;
  // Share of the joint from which a rigid part reaches into a rigid neighbour.
  static constexpr float kReach = 0.3f;

  std::string nameOf(uint32_t joint) const { return skin_.skeleton.joints[joint].name; }
  double areaOf(const std::array<uint32_t, 3>& t) const {
    const Vec3 &a = fine_.positions[t[0]], &b = fine_.positions[t[1]], &c = fine_.positions[t[2]];
    return 0.5 * static_cast<double>((b - a).cross(c - a).norm());
  }
  static PartKey ownOf(const Place& place) {
    const uint32_t joint = place.share < 0.5f ? place.a : place.b;
    return {joint, joint, 0};
  }
  PartKey keyOf(size_t triangle) const {
    const Place& place = places_[triangle];
    const int between = place.a == place.b ? 0 : pairs_.at({place.a, place.b}).between;
    if (between == 0) return movedOf(triangle);
    const float done = (place.share - kOwn) / (1 - 2 * kOwn);
    if (done < 0 || done >= 1) return movedOf(triangle);
    return {place.a, place.b, 1 + static_cast<uint32_t>(done * static_cast<float>(between))};
  }
  static float shareOf(uint32_t joint, const Place& place) {
    return (joint == place.a ? 1 - place.share : 0) +
           (joint == place.b && place.b != place.a ? place.share : 0);
  }
  /// Key of the part of a joint's own triangle. Triangles that targets move are divided by cells of their
  /// bounding box.
  PartKey movedOf(size_t triangle) const {
    PartKey key = ownOf(places_[triangle]);
    if (!moved_[triangle] || cells_ == 0) return key;
    const Box& box = boxes_.at(key[0]);
    const Vec3 size = box.sizes(),
               at = (middleOf(triangle) - Vec3(box.min())).cwiseQuotient(size.cwiseMax(1e-9f));
    key[2] = 1;
    for (int c = 0; c < 3; ++c)
      if (cells_ > 1 && at[c] >= 0.5f && size[c] > 0.5f * size.maxCoeff()) key[2] += 1u << c;
    return key;
  }
  Vec3 middleOf(size_t triangle) const {
    Vec3 sum = Vec3::Zero();
    for (const uint32_t v : fine_.triangles[triangle]) sum += fine_.positions[v] / 3;
    return sum;
  }
  /// Per triangle, whether a target moves one of its corners when the joints are at rest.
  std::vector<bool> movedByTargets(std::span<const Placement> rest) const {
    constexpr double kMin = 1e-5;  // m, at a weight of 1
    std::vector<bool> vertices;
    for (const std::vector<SkinShare>& shares : fine_.shares)
      vertices.push_back(std::any_of(shares.begin(), shares.end(), [&](const SkinShare& share) {
        if (share.binding < skin_.bindings.size()) return false;
        const uint32_t binding = skin_.target_bindings[share.binding - skin_.bindings.size()].binding;
        return (rest[binding].linear() * share.stored.head<3>()).norm() > kMin;
      }));
    std::vector<bool> out;
    for (const auto& t : fine_.triangles)
      out.push_back(std::any_of(t.begin(), t.end(), [&](uint32_t v) { return vertices[v]; }));
    return out;
  }

  /// Removes one part from the pair of joints with the smallest parts; the last part of a pair only after all
  /// pairs have one. Returns false if there is none.
  bool lessBetween() {
    Pair* smallest = nullptr;
    for (auto& [joints, pair] : pairs_)
      if (pair.between > 0 && (smallest == nullptr || pair.rank() < smallest->rank())) smallest = &pair;
    if (smallest == nullptr) return false;
    --smallest->between;
    return true;
  }

  void assign() {
    constexpr size_t kFewest = 8;  // triangles of a part between joints
    cores_.clear();
    for (size_t t = 0; t < places_.size(); ++t) cores_[keyOf(t)].push_back(t);
    for (auto core = cores_.begin(); core != cores_.end();) {
      const auto& [a, b, number] = core->first;
      const bool is_moved = a == b && number != 0;
      if (number == 0 || core->second.size() >= kFewest || (is_moved && number == 1)) {
        ++core;
        continue;
      }
      for (const size_t t : core->second) cores_[is_moved ? PartKey{a, a, 1} : movedOf(t)].push_back(t);
      core = cores_.erase(core);
    }
    bends_.assign(places_.size(), false);
    for (const auto& [key, core] : cores_)
      for (const size_t t : core) bends_[t] = key[2] != 0;
  }

  SkinPart partOf(const PartKey& key, const std::vector<size_t>& core) const {
    SkinPart part;
    part.name = key[2] == 0        ? nameOf(key[0])
                : key[0] == key[1] ? fmt::format("{} moved {}", nameOf(key[0]), key[2])
                                   : fmt::format("{}-{} {}", nameOf(key[0]), nameOf(key[1]), key[2]);
    part.mesh.name = fmt::format("{}, part {}", skin_.mesh.name, part.name);
    std::set<uint32_t> own;
    for (const size_t t : core) own.insert(fine_.triangles[t].begin(), fine_.triangles[t].end());
    // The part's own triangles and a ring around them, so that no gaps open between parts. A rigid part
    // leaves out bending triangles: it would protrude from them. Beside rigid neighbours it reaches farther.
    std::vector<std::array<uint32_t, 3>> triangles;
    for (size_t t = 0; t < places_.size(); ++t) {
      if (key[2] == 0 && bends_[t]) continue;
      const std::array<uint32_t, 3>& triangle = fine_.triangles[t];
      if (std::any_of(triangle.begin(), triangle.end(), [&](uint32_t v) { return own.contains(v); }) ||
          (key[2] == 0 && shareOf(key[0], places_[t]) > kReach))
        triangles.push_back(triangle);
    }
    const bool is_moved = std::any_of(core.begin(), core.end(), [&](size_t t) { return moved_[t]; });
    if (key[2] != 0 || is_moved) sample(triangles, part);
    part.mesh = closed(std::move(triangles), part.mesh.name);
    fit(key, core, part);
    return part;
  }

  /// Farthest point sampling of vertices.
  void sample(const std::vector<std::array<uint32_t, 3>>& triangles, SkinPart& part) const {
    constexpr size_t kSamples = 96;  // the bend has ten terms
    std::set<uint32_t> all;
    for (const auto& triangle : triangles) all.insert(triangle.begin(), triangle.end());
    std::map<uint32_t, float> away;  // m^2, to the nearest sample
    for (const uint32_t v : all) away[v] = std::numeric_limits<float>::max();
    for (size_t n = 0; n < std::min(kSamples, all.size()); ++n) {
      const auto farthest = std::max_element(
          away.begin(), away.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
      const uint32_t next = farthest->first;
      part.samples.push_back({fine_.positions[next], fine_.normals[next], fine_.shares[next]});
      for (auto& [v, distance] : away)
        distance = std::min(distance, (fine_.positions[v] - fine_.positions[next]).squaredNorm());
    }
  }

  /// Closes the triangles: each ring of open edges gets a fan about its centre.
  TriangleMesh closed(std::vector<std::array<uint32_t, 3>> triangles, const std::string& name) const {
    std::map<std::pair<uint32_t, uint32_t>, int> edges;  // count of directed edges minus opposite ones
    for (const auto& t : triangles)
      for (int c = 0; c < 3; ++c) {
        const uint32_t from = t[static_cast<size_t>(c)], to = t[static_cast<size_t>((c + 1) % 3)];
        edges[std::minmax(from, to)] += from < to ? 1 : -1;
      }
    std::map<uint32_t, uint32_t> ring;  // union-find over the vertices of a ring
    const auto find = [&](uint32_t v) {
      while (ring.at(v) != v) v = ring[v] = ring.at(ring.at(v));
      return v;
    };
    for (const auto& [edge, count] : edges) {
      if (count == 0) continue;
      for (const uint32_t v : {edge.first, edge.second}) ring.try_emplace(v, v);
      ring[find(edge.first)] = find(edge.second);
    }
    std::map<uint32_t, std::pair<Vec3, float>> middles;  // ring -> length-weighted sum of positions, length
    for (const auto& [edge, count] : edges) {
      if (count == 0) continue;
      const Vec3 &a = fine_.positions[edge.first], &b = fine_.positions[edge.second];
      auto& [sum, length] = middles.try_emplace(find(edge.first), Vec3::Zero(), 0.0f).first->second;
      sum += 0.5f * (b - a).norm() * (a + b);
      length += (b - a).norm();
    }
    TriangleMesh out;
    out.name = name;
    std::map<uint32_t, uint32_t> vertex;
    const auto add = [&](uint32_t v) {
      const auto [known, is_new] = vertex.try_emplace(v, static_cast<uint32_t>(out.positions.size()));
      if (is_new) out.positions.push_back(fine_.positions[v]);
      return known->second;
    };
    for (const auto& t : triangles) out.triangles.push_back({add(t[0]), add(t[1]), add(t[2])});
    std::map<uint32_t, uint32_t> tips;
    for (const auto& [edge, count] : edges) {
      if (count == 0) continue;
      const uint32_t root = find(edge.first);
      const auto& [sum, length] = middles.at(root);
      if (!(length > 0)) continue;
      const auto [tip, is_new] = tips.try_emplace(root, static_cast<uint32_t>(out.positions.size()));
      if (is_new) out.positions.push_back(sum / length);
      const auto [from, to] = count > 0 ? edge : std::pair(edge.second, edge.first);
      out.triangles.push_back({add(to), add(from), tip->second});
    }
    return out;
  }

  void fit(const PartKey& key, const std::vector<size_t>& core, SkinPart& part) const {
    constexpr double kWhole = 0.999;
    // Regularisation towards the joints' own rotations, for collinear vertices.
    constexpr double kLean = 1e-3;
    const auto wholly = [&](uint32_t v) {
      double weight = 0;
      for (const SkinShare& share : fine_.shares[v])
        if (share.binding < skin_.bindings.size() && skin_.bindings[share.binding].joint == key[0])
          weight += share.weight();  // shares of targets have no weight
      return weight > kWhole;
    };
    std::map<uint32_t, double> areas;
    double whole_area = 0, area = 0;
    for (const size_t t : core) {
      const auto& corners = fine_.triangles[t];
      const double third = areaOf(corners) / 3 + 1e-12;
      for (const uint32_t v : corners) {
        areas[v] += third;
        area += third;
        whole_area += key[2] == 0 && wholly(v) ? third : 0;
      }
    }
    // A joint's own part moves with the joint if more than a quarter of it is weighted to the joint alone.
    const bool joint_alone = whole_area > 0.25 * area;
    if (joint_alone) std::erase_if(areas, [&](const auto& entry) { return !wholly(entry.first); });
    double sum = 0;
    part.middle.setZero();
    for (const auto& [v, weight] : areas) {
      part.middle += weight * fine_.positions[v].cast<double>();
      sum += weight;
    }
    part.middle /= sum;
    double spread = 0;
    for (const auto& [v, weight] : areas)
      spread += weight / sum * (fine_.positions[v].cast<double>() - part.middle).squaredNorm();
    std::map<uint32_t, SkinPart::Moment> moments;
    for (const auto& [v, weight] : areas) {
      const Eigen::Vector3d from_middle = fine_.positions[v].cast<double>() - part.middle;
      for (const auto& [binding, stored] : fine_.shares[v]) {
        auto& moment = moments[binding];
        const double own = weight / sum;
        if (moment.middle.isZero())
          moment = {binding, decltype(moment.spread)::Zero(), decltype(moment.middle)::Zero()};
        moment.spread += own * stored * from_middle.transpose();
        moment.spread.topRows<3>() += kLean * (spread + 1e-12) * own * stored[3] * back_[binding];
        moment.middle += own * stored;
      }
    }
    for (const auto& [binding, moment] : moments) part.moments.push_back(moment);
  }

  const SkinnedMesh& skin_;
  const FineSkin fine_;
  std::map<std::pair<uint32_t, uint32_t>, Pair> pairs_;
  std::vector<Place> places_;      ///< per triangle
  std::vector<bool> bends_;        ///< per triangle: it is in a part that bends
  std::vector<bool> moved_;        ///< per triangle: targets move it
  std::map<uint32_t, Box> boxes_;  ///< joint -> bounds of its own triangles that targets move, m
  int cells_ = 2;                  ///< cells of such bounds along the long axes; 0: own parts bend as a whole
  std::vector<Eigen::Matrix3d> back_;  ///< per binding, the inverse of its linear part at rest
  std::map<PartKey, std::vector<size_t>> cores_;
};

}  // namespace

std::vector<SkinPart> cutSkin(const SkinnedMesh& skin, int between) { return Cutter(skin, between).run(); }

Pose partPose(const SkinPart& part, std::span<const Placement> bindings) {
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const SkinPart::Moment& moment : part.moments) {
    const auto& m = bindings[moment.binding].matrix();
    covariance += m * moment.spread;
    middle += m * moment.middle;
  }
  const Quat rotation = nearestRotation(covariance);
  return {Vec3((middle - rotation.cast<double>() * part.middle).cast<float>()), rotation};
}

SurfaceBend partBend(const SkinPart& part, std::span<const Placement> bindings, const Pose& pose) {
  using Products = Eigen::Matrix<double, 10, 1>;
  constexpr double kLean = 1e-4;  // regularisation towards no bend, where samples do not determine it
  constexpr double kOff = 0.05;   // share of the part's size: distance from the skin up to which the bend is
                                  // to move space with the skin
  constexpr double kMin = 1e-5;   // m
  const Eigen::Vector3d middle = part.middle;
  const Eigen::Quaterniond back = pose.rotation.cast<double>().conjugate();
  double size = 0;
  for (const SkinPart::Sample& sample : part.samples)
    size = std::max(size, (sample.rest.cast<double>() - middle).norm());
  if (!(size > 0)) return {};
  Eigen::Matrix<double, 10, 10> squares = Eigen::Matrix<double, 10, 10>::Zero();
  Eigen::Matrix<double, 10, 3> rights = Eigen::Matrix<double, 10, 3>::Zero();
  double farthest = 0;
  for (const SkinPart::Sample& sample : part.samples) {
    const Eigen::Vector3d now = back * (blended(sample.shares, bindings) - pose.position.cast<double>());
    const Eigen::Vector3d shift = sample.rest.cast<double>() - now, q = (now - middle) / size;
    Products products;
    products << 1, q, q.cwiseAbs2(), q.x() * q.y(), q.y() * q.z(), q.z() * q.x();
    squares.selfadjointView<Eigen::Lower>().rankUpdate(products);
    rights += products * shift.transpose();
    const Eigen::Vector3d n = kOff * sample.normal.cast<double>();
    products << 0, n, 2 * n.cwiseProduct(q), n.x() * q.y() + n.y() * q.x(), n.y() * q.z() + n.z() * q.y(),
        n.z() * q.x() + n.x() * q.z();
    squares.selfadjointView<Eigen::Lower>().rankUpdate(products);
    farthest = std::max(farthest, shift.norm());
  }
  SurfaceBend bend;
  bend.middle = middle.cast<float>();
  if (!(farthest > kMin)) return bend;
  for (int i = 1; i < 10; ++i) squares(i, i) += kLean * static_cast<double>(part.samples.size());
  const Eigen::Matrix<double, 10, 3> terms = squares.selfadjointView<Eigen::Lower>().ldlt().solve(rights);
  for (int i = 0; i < 10; ++i) {
    const int degree = i == 0 ? 0 : i < 4 ? 1 : 2;
    bend.terms[static_cast<size_t>(i)] = (terms.row(i).transpose() / std::pow(size, degree)).cast<float>();
  }
  return bend;
}

}  // namespace strandcast
