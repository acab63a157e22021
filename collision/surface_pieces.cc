#include "collision/surface_pieces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <utility>

#include "collision/mesh_check.h"
#include "core/split_mix.h"

namespace strandcast {
namespace {

/// Disjoint sets with parity: each element has a parity relative to the first of its set.
class ParitySets {
 public:
  explicit ParitySets(size_t count) : parent_(count), against_(count, 0) {
    std::iota(parent_.begin(), parent_.end(), 0u);
  }

  /// The first element of the set, and the parity of `element` relative to it.
  std::pair<uint32_t, uint8_t> find(uint32_t element) {
    uint32_t first = element;
    uint8_t against = 0;
    for (; parent_[first] != first; first = parent_[first]) against ^= against_[first];
    const uint8_t found = against;
    while (parent_[element] != first && element != first) {
      const uint32_t next = parent_[element];
      const uint8_t own = std::exchange(against_[element], against);
      parent_[element] = first;
      against ^= own;
      element = next;
    }
    return {first, found};
  }

  /// Joins two sets; no effect if they are one already.
  void join(uint32_t a, uint32_t b, bool opposed) {
    auto [first, of_a] = find(a);
    auto [second, of_b] = find(b);
    if (first == second) return;
    if (second < first) std::swap(first, second);
    parent_[second] = first;
    against_[second] = static_cast<uint8_t>(of_a ^ of_b ^ (opposed ? 1 : 0));
  }

 private:
  std::vector<uint32_t> parent_;
  std::vector<uint8_t> against_;  // relative to the parent
};

using SortedCorners = std::array<uint32_t, 3>;  // numbers of positions, ascending

/// m. Vertices of open edges within this distance are merged.
double weldingDistance(const TriangleMesh& mesh) {
  Box box;
  for (const auto& triangle : mesh.triangles)
    for (const uint32_t corner : triangle) box.extend(Eigen::Vector3f(mesh.positions[corner]));
  const double farthest = std::max(box.min().cwiseAbs().maxCoeff(), box.max().cwiseAbs().maxCoeff());
  constexpr double kOfDiagonal = 1e-6, kRoundings = 4;
  return std::max(kOfDiagonal * static_cast<double>(box.diagonal().norm()),
                  kRoundings * double{std::numeric_limits<float>::epsilon()} * farthest);
}

using Cell = std::array<int64_t, 3>;  // of a uniform grid

uint64_t hashOf(const Cell& cell) {
  uint64_t hash = 0;
  for (const int64_t c : cell) hash = splitMix64(hash ^ static_cast<uint64_t>(c));
  return hash;
}

}  // namespace

bool SurfacePieces::isFlat(const std::array<uint32_t, 3>& t) const {
  return place_[t[0]] == place_[t[1]] || place_[t[1]] == place_[t[2]] || place_[t[2]] == place_[t[0]];
}

std::array<uint32_t, 2> SurfacePieces::endsOf(const TriangleMesh& mesh, const EdgeUse& use) const {
  const std::array<uint32_t, 3>& t = mesh.triangles[use.triangle];
  size_t c = 0;
  while (c < 2 && placesOf(t[c], t[c + 1]) != use.places) ++c;
  return {t[c], t[(c + 1) % 3]};
}

/// Key of an edge, see EdgeUse::places.
uint64_t SurfacePieces::placesOf(uint32_t from, uint32_t to) const {
  const uint64_t a = place_[from], b = place_[to];
  return std::min(a, b) << 32 | std::max(a, b);
}

void SurfacePieces::gatherEdges(const TriangleMesh& mesh) {
  edges_.clear();
  edges_.reserve(3 * mesh.triangles.size());
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    const std::array<uint32_t, 3>& triangle = mesh.triangles[t];
    if (repeated_[t] != 0 || isFlat(triangle)) continue;
    for (size_t c = 0; c < 3; ++c) {
      const uint32_t from = triangle[c], to = triangle[(c + 1) % 3];
      edges_.push_back({placesOf(from, to), static_cast<uint32_t>(t), place_[from] < place_[to]});
    }
  }
  std::sort(edges_.begin(), edges_.end());
}

/// Whether an edge with three or more triangles exists.
bool SurfacePieces::isCrowded() const {
  bool crowded = false;
  forEachEdge(edges_, [&](std::span<const EdgeUse> uses) { crowded = crowded || uses.size() > 2; });
  return crowded;
}

/// Whether the two triangles of an edge lie on top of each other.
bool SurfacePieces::isFolded(const TriangleMesh& mesh, std::span<const EdgeUse> uses) const {
  constexpr double kFolded = 0.99;  // cosine
  std::array<Eigen::Vector3d, 2> away;
  for (size_t i = 0; i < 2; ++i) {
    const auto [from, to] = endsOf(mesh, uses[i]);
    const auto& t = mesh.triangles[uses[i].triangle];
    const uint32_t third = t[0] != from && t[0] != to ? t[0] : t[1] != from && t[1] != to ? t[1] : t[2];
    const Eigen::Vector3d start = mesh.positions[from].cast<double>(),
                          along = mesh.positions[to].cast<double>() - start,
                          side = mesh.positions[third].cast<double>() - start;
    const double squared = along.squaredNorm();
    away[i] = side - (squared > 0 ? along.dot(side) / squared : 0) * along;
  }
  return away[0].dot(away[1]) > kFolded * away[0].norm() * away[1].norm();
}

/// Merges nearby vertices of open edges. Returns whether any were merged.
bool SurfacePieces::weldOpenEdges(const TriangleMesh& mesh) {
  std::vector<uint8_t> is_open(place_.size(), 0);  // per position
  bool any = false;
  const bool is_crowded = isCrowded();
  forEachEdge(edges_, [&](std::span<const EdgeUse> uses) {
    // In a duplicated surface an open edge has two triangles that lie on top of each other.
    if (uses.size() != 1 && !(is_crowded && uses.size() == 2 && isFolded(mesh, uses))) return;
    is_open[uses[0].places >> 32] = is_open[uses[0].places & 0xFFFFFFFF] = 1;
    any = true;
  });
  if (!any) return false;
  // Two points no farther apart than half a cell share a cell in one of eight grids, each shifted by half a
  // cell along some of the axes.
  const double cell = 2 * weldingDistance(mesh);
  if (!(cell > 0)) return false;
  ParitySets same(place_.size());
  std::vector<uint32_t> open;  // one vertex per position
  for (uint32_t v = 0; v < place_.size(); ++v)
    if (std::exchange(is_open[place_[v]], uint8_t{0}) != 0) open.push_back(v);
  std::vector<std::pair<uint64_t, uint32_t>> hashed;  // hash of a cell, and a vertex in it
  for (int grid = 0; grid < 8; ++grid) {
    const auto cellOf = [&](uint32_t v) {
      Cell at;
      for (int c = 0; c < 3; ++c)
        at[static_cast<size_t>(c)] = static_cast<int64_t>(
            std::floor(static_cast<double>(mesh.positions[v][c]) / cell + 0.5 * (grid >> c & 1)));
      return at;
    };
    hashed.clear();
    for (const uint32_t v : open) hashed.emplace_back(hashOf(cellOf(v)), v);
    std::sort(hashed.begin(), hashed.end());
    for (size_t i = 1, first = 0; i < hashed.size(); ++i) {
      if (hashed[i].first != hashed[first].first)
        first = i;
      else if (cellOf(hashed[i].second) == cellOf(hashed[first].second))
        same.join(place_[hashed[first].second], place_[hashed[i].second], false);
    }
  }
  bool welded = false;
  for (uint32_t& place : place_) {
    const uint32_t one = same.find(place).first;
    welded = welded || one != place;
    place = one;
  }
  return welded;
}

/// Finds triangles with the same three corners and marks all but one as repeated. `many`, per triangle: it
/// represents others that are left out.
bool SurfacePieces::findRepeatedTriangles(const TriangleMesh& mesh, std::vector<uint8_t>& many) {
  struct Known {
    SortedCorners corners;
    uint32_t triangle;
    bool operator<(const Known& other) const {
      return corners != other.corners ? corners < other.corners : triangle < other.triangle;
    }
  };
  std::vector<Known> all;
  all.reserve(mesh.triangles.size());
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (isFlat(mesh.triangles[t])) continue;
    SortedCorners corners;
    for (size_t c = 0; c < 3; ++c) corners[c] = place_[mesh.triangles[t][c]];
    std::sort(corners.begin(), corners.end());
    all.push_back({corners, static_cast<uint32_t>(t)});
  }
  std::sort(all.begin(), all.end());
  bool any = false;
  for (size_t i = 1, first = 0; i < all.size(); ++i) {
    if (all[i].corners != all[first].corners) {
      first = i;
      continue;
    }
    repeated_[all[i].triangle] = 1;
    many[all[first].triangle] = 1;
    any = true;
  }
  return any;
}

/// Finds polygons with the same edges that are divided along different diagonals, as a face and its reverse
/// often are. A polygon is a disc without inner vertices, all of whose edges other triangles use as well.
bool SurfacePieces::findRepeatedPolygons(const TriangleMesh& mesh, std::vector<uint8_t>& many) {
  const size_t triangles = mesh.triangles.size();
  if (!isCrowded()) return false;
  ParitySets sets(triangles);
  const auto joins = [&](std::span<const EdgeUse> uses) { return uses.size() == 2 && !isFolded(mesh, uses); };
  forEachEdge(edges_, [&](std::span<const EdgeUse> uses) {
    if (joins(uses)) sets.join(uses[0].triangle, uses[1].triangle, false);
  });
  std::vector<std::pair<uint32_t, uint64_t>> rims;  // first triangle of a set, and an edge of its rim
  std::vector<uint32_t> sizes(triangles, 0);        // per first triangle of a set: number of triangles
  std::vector<uint8_t> is_polygon(triangles, 1);    // per first triangle of a set
  forEachEdge(edges_, [&](std::span<const EdgeUse> uses) {
    if (joins(uses)) return;
    for (const EdgeUse& use : uses) {
      const uint32_t first = sets.find(use.triangle).first;
      rims.emplace_back(first, uses[0].places);
      if (uses.size() == 1) is_polygon[first] = 0;
    }
  });
  for (uint32_t t = 0; t < triangles; ++t) ++sizes[sets.find(t).first];
  std::sort(rims.begin(), rims.end());
  std::map<std::vector<uint64_t>, uint32_t> known;  // rim -> first triangle of its set
  std::vector<uint8_t> is_repeat(triangles, 0);     // per first triangle of a set
  for (size_t i = 0; i < rims.size();) {
    const uint32_t first = rims[i].first;
    std::vector<uint64_t> rim;
    for (; i < rims.size() && rims[i].first == first; ++i) rim.push_back(rims[i].second);
    if (is_polygon[first] == 0 || rim.size() != sizes[first] + 2) continue;
    const auto [same, is_new] = known.try_emplace(std::move(rim), first);
    if (is_new) continue;
    is_repeat[first] = 1;
    many[same->second] = 1;
  }
  bool any = false;
  for (uint32_t t = 0; t < triangles; ++t) {
    const uint32_t first = sets.find(t).first;
    if (many[first] != 0) many[t] = 1;
    if (is_repeat[first] == 0) continue;
    repeated_[t] = 1;
    any = true;
  }
  return any;
}

/// Of duplicates one stays, or none, whichever leaves an even number of triangles at the surrounding edges. A
/// wall between two closed bodies is removed.
void SurfacePieces::leaveOutRepeats(const TriangleMesh& mesh) {
  const size_t triangles = mesh.triangles.size();
  std::vector<uint8_t> stands_for_many(triangles, 0);
  const bool any_triangles = findRepeatedTriangles(mesh, stands_for_many);
  if (any_triangles) gatherEdges(mesh);
  const bool any_polygons = findRepeatedPolygons(mesh, stands_for_many);
  if (any_polygons) gatherEdges(mesh);
  if (!any_triangles && !any_polygons) return;
  ParitySets walls(triangles);
  const auto many = [&](const EdgeUse& use) { return stands_for_many[use.triangle] != 0; };
  forEachEdge(edges_, [&](std::span<const EdgeUse> uses) {
    if (uses.size() == 2 && many(uses[0]) && many(uses[1]))
      walls.join(uses[0].triangle, uses[1].triangle, false);
  });
  // Per first triangle of a wall: edges that need the wall, minus the others.
  std::vector<int> needed(triangles, 0);
  forEachEdge(edges_, [&](std::span<const EdgeUse> uses) {
    const auto others = uses.size() - static_cast<size_t>(std::count_if(uses.begin(), uses.end(), many));
    if (others == 0) return;
    for (const EdgeUse& use : uses)
      if (many(use)) needed[walls.find(use.triangle).first] += others % 2 == 1 ? 1 : -1;
  });
  bool any_walls = false;
  for (uint32_t t = 0; t < triangles; ++t) {
    if (stands_for_many[t] == 0 || repeated_[t] != 0 || needed[walls.find(t).first] >= 0) continue;
    repeated_[t] = 1;
    any_walls = true;
  }
  if (any_walls) gatherEdges(mesh);
}

void SurfacePieces::join(size_t triangles) {
  ParitySets sets(triangles);
  // Consistently wound neighbours first, so that a one-sided surface keeps the winding of the mesh.
  for (const bool opposed : {false, true})
    forEachEdge(edges_, [&](std::span<const EdgeUse> uses) {
      if (uses.size() == 2 && (uses[0].is_forward == uses[1].is_forward) == opposed)
        sets.join(uses[0].triangle, uses[1].triangle, opposed);
    });
  std::vector<uint8_t> is_used(triangles, 0);
  for (const EdgeUse& use : edges_) is_used[use.triangle] = 1;
  piece_.assign(triangles, kNone);
  against_.assign(triangles, 0);
  for (uint32_t t = 0; t < triangles; ++t) {
    if (is_used[t] == 0) continue;
    const auto [first, against] = sets.find(t);
    piece_[t] = first == t ? static_cast<uint32_t>(count_++) : piece_[first];
    against_[t] = against;
  }
}

SurfacePieces::SurfacePieces(const TriangleMesh& mesh)
    : place_(vertexPlaces(mesh.positions)), repeated_(mesh.triangles.size(), 0) {
  gatherEdges(mesh);
  if (weldOpenEdges(mesh)) gatherEdges(mesh);
  leaveOutRepeats(mesh);
  join(mesh.triangles.size());
}

}  // namespace strandcast
