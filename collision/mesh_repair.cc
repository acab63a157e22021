#include "collision/mesh_repair.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <string>
#include <tuple>
#include <utility>

#include "collision/body_distance.h"
#include "core/error.h"
#include "core/hash.h"

namespace strandcast {

std::vector<uint32_t> vertexPlaces(const std::vector<Vec3>& positions) {
  std::vector<uint32_t> order(positions.size()), position(positions.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto before = [&](uint32_t i, uint32_t j) {
    const Vec3 &a = positions[i], &b = positions[j];
    return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
  };
  std::sort(order.begin(), order.end(), before);
  for (size_t i = 0; i < order.size(); ++i)
    position[order[i]] =
        i > 0 && !before(order[i - 1], order[i]) ? position[order[i - 1]] : static_cast<uint32_t>(i);
  return position;
}

void requireSoundMesh(const TriangleMesh& mesh) {
  const std::string where = mesh.name.empty() ? "mesh" : "mesh " + mesh.name;
  if (mesh.triangles.empty()) throw Error("mesh has no triangles", where, "check that the file holds faces");
  for (size_t i = 0; i < mesh.positions.size(); ++i)
    if (!mesh.positions[i].allFinite())
      throw Error("mesh has a vertex that is not finite", where + ", vertex " + std::to_string(i),
                  "repair the mesh");
  for (size_t i = 0; i < mesh.triangles.size(); ++i)
    for (const uint32_t index : mesh.triangles[i])
      if (index >= mesh.positions.size())
        throw Error("mesh has an index out of range",
                    where + ", triangle " + std::to_string(i) + ", vertex " + std::to_string(index) + " of " +
                        std::to_string(mesh.positions.size()),
                    "repair the mesh");
}

MeshCheck checkMesh(const TriangleMesh& mesh) {
  requireSoundMesh(mesh);
  MeshCheck check;
  check.triangles = mesh.triangles.size();
  const std::vector<uint32_t> position = vertexPlaces(mesh.positions);
  struct Edge {
    uint64_t places;  // numbers of the two positions, the lower in the high half
    uint32_t from, to;
  };
  std::vector<Edge> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (const auto& t : mesh.triangles) {
    const Vec3 &a = mesh.positions[t[0]], &b = mesh.positions[t[1]], &c = mesh.positions[t[2]];
    if (!((b - a).cross(c - a).norm() > 0)) ++check.without_area;
    for (int i = 0; i < 3; ++i) {
      const uint32_t from = t[i], to = t[(i + 1) % 3];
      const uint64_t p = position[from], q = position[to];
      if (p != q) edges.push_back({std::min(p, q) << 32 | std::max(p, q), from, to});
    }
  }
  std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
    return std::tie(a.places, a.from, a.to) < std::tie(b.places, b.from, b.to);
  });
  for (size_t i = 0; i < edges.size();) {
    const Edge& first = edges[i];
    int excess = 0;
    for (; i < edges.size() && edges[i].places == first.places; ++i)
      excess += position[edges[i].from] == position[first.from] ? 1 : -1;
    const Vec3 &from = mesh.positions[first.from], &to = mesh.positions[first.to];
    if (excess > 0) check.open_edges.push_back({from, to, static_cast<float>(excess)});
    if (excess < 0) check.open_edges.push_back({to, from, static_cast<float>(-excess)});
  }
  return check;
}

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
  for (uint32_t& position : place_) {
    const uint32_t one = same.find(position).first;
    welded = welded || one != position;
    position = one;
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
void SurfacePieces::removeDuplicates(const TriangleMesh& mesh) {
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
  removeDuplicates(mesh);
  join(mesh.triangles.size());
}

namespace {

using Point = Eigen::Vector3d;

/// Properties of a piece. Signs refer to the winding of its first triangle.
struct Piece {
  double area = 0, area_against = 0;  ///< m^2, of all triangles, and of those wound against the first
  Point middle = Point::Zero();       ///< m, centre of the open edges; of a closed piece, one of its corners
  double open_length = 0;             ///< m; 0: closed
  size_t triangles = 0, against = 0;
  bool divides = true;  ///< each open edge has three triangles or more
  double volume = 0;    ///< m^3

  bool isClosed() const { return !(open_length > 0); }
  /// Whether the majority by area is wound against the first triangle.
  bool isMajorityReversed() const { return 2 * area_against > area; }
  /// Volume with the winding of the majority, m^3; 0 if the piece is nearly flat and has no inside.
  double givenVolume() const {
    const double flat = (isClosed() ? 1e-9 : 3e-3) * std::pow(area, 1.5);
    if (!(std::fabs(volume) > flat)) return 0;
    return isMajorityReversed() ? -volume : volume;
  }
};

/// Decision on a piece.
enum class PieceState : uint8_t { kUnchanged, kReversed, kCavity, kDiscarded };

class Orienter {
 public:
  explicit Orienter(TriangleMesh mesh) : mesh_(std::move(mesh)), surface_(mesh_), pieces_(surface_.pieces()) {
    addTriangles();
    addOpenEdges();
    addVolumes();
    double volume = 0;
    for (const Piece& piece : pieces_) volume += piece.givenVolume();
    is_inside_out_ = volume < 0;
    classifyPieces();
  }

  OrientedSurface result() && {
    SurfaceRepair repair;
    repair.triangles = mesh_.triangles.size();
    repair.pieces = pieces_.size();
    repair.is_inside_out = is_inside_out_;
    for (const uint8_t repeated : surface_.repeated()) repair.repeated += repeated;
    for (size_t p = 0; p < pieces_.size(); ++p) {
      const Piece& piece = pieces_[p];
      if (piece_states_[p] == PieceState::kDiscarded) {
        repair.inner += piece.triangles;
        continue;
      }
      repair.turned_triangles += piece.isMajorityReversed() ? piece.triangles - piece.against : piece.against;
      repair.turned_pieces += piece_states_[p] == PieceState::kReversed ? 1 : 0;
      repair.hollows += piece_states_[p] == PieceState::kCavity ? 1 : 0;
    }
    if (repair.changed()) mesh_.triangles = orientedTriangles();
    return {std::move(mesh_), repair};
  }

 private:
  Point position(uint32_t vertex) const { return mesh_.positions[vertex].cast<double>(); }

  void addTriangles() {
    for (size_t t = 0; t < mesh_.triangles.size(); ++t) {
      const uint32_t p = surface_.pieceOf()[t];
      if (p == SurfacePieces::kNone) continue;
      const auto& [a, b, c] = mesh_.triangles[t];
      const double area = 0.5 * (position(b) - position(a)).cross(position(c) - position(a)).norm();
      Piece& piece = pieces_[p];
      if (piece.triangles++ == 0) piece.middle = position(a);
      piece.area += area;
      if (surface_.against()[t] == 0) continue;
      ++piece.against;
      piece.area_against += area;
    }
  }

  /// Accumulates edges that a piece has unequally often in their two directions.
  void addOpenEdges() {
    std::vector<std::pair<uint32_t, int>> excess;  // per piece at the edge
    forEachEdge(surface_.edges(), [&](std::span<const EdgeUse> uses) {
      excess.clear();
      for (const EdgeUse& use : uses) {
        const uint32_t p = surface_.pieceOf()[use.triangle];
        const int way = use.is_forward == (surface_.against()[use.triangle] == 0) ? 1 : -1;
        const auto known =
            std::find_if(excess.begin(), excess.end(), [&](const auto& entry) { return entry.first == p; });
        if (known == excess.end())
          excess.emplace_back(p, way);
        else
          known->second += way;
      }
      for (const auto& [p, count] : excess)
        if (count != 0) addOpenEdge(uses, p);
    });
    for (Piece& piece : pieces_)
      if (!piece.isClosed()) piece.middle /= piece.open_length;
  }

  void addOpenEdge(std::span<const EdgeUse> uses, uint32_t p) {
    const auto own = std::find_if(uses.begin(), uses.end(),
                                  [&](const EdgeUse& use) { return surface_.pieceOf()[use.triangle] == p; });
    const auto [from, to] = surface_.endsOf(mesh_, *own);
    const double length = (position(to) - position(from)).norm();
    Piece& piece = pieces_[p];
    if (piece.isClosed()) piece.middle.setZero();
    piece.open_length += length;
    piece.middle += 0.5 * length * (position(from) + position(to));
    piece.divides = piece.divides && uses.size() > 2;
  }

  void addVolumes() {
    for (size_t t = 0; t < mesh_.triangles.size(); ++t) {
      const uint32_t p = surface_.pieceOf()[t];
      if (p == SurfacePieces::kNone) continue;
      Piece& piece = pieces_[p];
      const auto& [a, b, c] = mesh_.triangles[t];
      const double six =
          (position(a) - piece.middle).dot((position(b) - piece.middle).cross(position(c) - piece.middle));
      piece.volume += (surface_.against()[t] == 0 ? six : -six) / 6;
    }
  }

  /// Whether the piece, with the winding of its majority, is wound against the rest.
  bool isOppositelyOriented(const Piece& piece) const {
    return is_inside_out_ ? piece.givenVolume() > 0 : piece.givenVolume() < 0;
  }

  void classifyPieces() {
    piece_states_.assign(pieces_.size(), PieceState::kUnchanged);
    std::vector<uint32_t> unclear;  // pieces for which it matters whether they lie inside the others
    for (uint32_t p = 0; p < pieces_.size(); ++p) {
      const Piece& piece = pieces_[p];
      if (isOppositelyOriented(piece)) piece_states_[p] = PieceState::kReversed;
      if (pieces_.size() > 1 && (isOppositelyOriented(piece) || (!piece.isClosed() && piece.divides)))
        unclear.push_back(p);
    }
    if (unclear.empty()) return;
    // Of a triangle soup only the largest pieces are examined; the others keep the verdicts above.
    constexpr size_t kMaxUnclear = 4000, kSamplesOfAll = 100000, kSamplesOfOne = 100;
    std::stable_sort(unclear.begin(), unclear.end(),
                     [&](uint32_t a, uint32_t b) { return pieces_[a].area > pieces_[b].area; });
    unclear.resize(std::min(unclear.size(), kMaxUnclear));
    const size_t samples = std::min(kSamplesOfOne, kSamplesOfAll / unclear.size());
    const MeshQuery all(outward());
    std::vector<TriangleMesh> own = outwardPieces(unclear);
    for (size_t i = 0; i < unclear.size(); ++i) {
      const Piece& piece = pieces_[unclear[i]];
      const Enclosure surrounded = enclosureOf(all, own[i], samples);
      if (!piece.isClosed() && piece.divides && surrounded.wholly > kEnclosedShare)
        piece_states_[unclear[i]] = PieceState::kDiscarded;
      else if (isOppositelyOriented(piece) &&
               (piece.isClosed() ? surrounded.wholly > kEnclosedShare : surrounded.mean > 0.5))
        piece_states_[unclear[i]] = PieceState::kCavity;
    }
  }

  static constexpr double kEnclosedShare = 0.95;

  /// How far a piece lies inside the others.
  struct Enclosure {
    double wholly = 0;  ///< share of its area that lies inside
    double mean = 0;    ///< mean winding number of the others, unsigned
  };
  static Enclosure enclosureOf(const MeshQuery& all, const TriangleMesh& piece, size_t count) {
    constexpr double kWithin = 0.75;
    const MeshQuery own(piece);
    const std::vector<SurfaceSample> samples = sampleSurface(piece, count);
    Enclosure out;
    for (const SurfaceSample& sample : samples) {
      const double others =
          std::fabs(double{all.windingNumber(sample.position)} - double{own.windingNumber(sample.position)});
      out.wholly += others > kWithin ? 1 : 0;
      out.mean += others;
    }
    const auto found = static_cast<double>(std::max<size_t>(samples.size(), 1));
    return {out.wholly / found, out.mean / found};
  }

  /// Whether triangle t must be reversed to match the majority of its piece.
  bool isReversedInPiece(size_t t) const {
    return (surface_.against()[t] != 0) != pieces_[surface_.pieceOf()[t]].isMajorityReversed();
  }

  static void turn(std::array<uint32_t, 3>& triangle) { std::swap(triangle[1], triangle[2]); }

  /// All pieces, with those wound against the rest reversed.
  TriangleMesh outward() const {
    TriangleMesh out;
    out.positions = mesh_.positions;
    for (size_t t = 0; t < mesh_.triangles.size(); ++t) addOutward(t, out);
    return out;
  }

  std::vector<TriangleMesh> outwardPieces(const std::vector<uint32_t>& which) const {
    std::vector<uint32_t> number(pieces_.size(), SurfacePieces::kNone);
    for (size_t i = 0; i < which.size(); ++i) number[which[i]] = static_cast<uint32_t>(i);
    std::vector<TriangleMesh> out(which.size());
    for (size_t t = 0; t < mesh_.triangles.size(); ++t) {
      const uint32_t p = surface_.pieceOf()[t];
      if (p == SurfacePieces::kNone || number[p] == SurfacePieces::kNone) continue;
      TriangleMesh& piece = out[number[p]];
      addOutward(t, piece);
      for (uint32_t& corner : piece.triangles.back()) {
        piece.positions.push_back(mesh_.positions[corner]);
        corner = static_cast<uint32_t>(piece.positions.size() - 1);
      }
    }
    return out;
  }

  void addOutward(size_t t, TriangleMesh& out) const {
    const uint32_t p = surface_.pieceOf()[t];
    if (p == SurfacePieces::kNone) return;
    out.triangles.push_back(mesh_.triangles[t]);
    if (isReversedInPiece(t) != isOppositelyOriented(pieces_[p])) turn(out.triangles.back());
  }

  std::vector<std::array<uint32_t, 3>> orientedTriangles() const {
    std::vector<std::array<uint32_t, 3>> triangles;
    for (size_t t = 0; t < mesh_.triangles.size(); ++t) {
      const uint32_t p = surface_.pieceOf()[t];
      if (surface_.repeated()[t] != 0) continue;
      if (p != SurfacePieces::kNone && piece_states_[p] == PieceState::kDiscarded) continue;
      triangles.push_back(mesh_.triangles[t]);
      if (p == SurfacePieces::kNone) continue;
      const bool is_turned = isReversedInPiece(t) != (piece_states_[p] == PieceState::kReversed);
      if (is_turned != is_inside_out_) turn(triangles.back());
    }
    return triangles;
  }

  TriangleMesh mesh_;
  const SurfacePieces surface_;
  std::vector<Piece> pieces_;
  std::vector<PieceState> piece_states_;
  bool is_inside_out_ = false;
};

std::string counted(size_t count, const char* one, const char* many) {
  return fmt::format("{} {}", count, count == 1 ? one : many);
}

}  // namespace

std::vector<std::string> SurfaceRepair::lines() const {
  std::vector<std::string> out;
  if (repeated > 0)
    out.push_back(fmt::format("{} of {} triangles repeat others, with the same corners, and are left out",
                              repeated, triangles));
  if (turned_triangles > 0)
    out.push_back(fmt::format("{} of {} triangles are wound against their neighbours, and are turned",
                              turned_triangles, triangles));
  if (turned_pieces > 0)
    out.push_back(fmt::format("{} of {} pieces of the surface {} wound inside out, and {} turned",
                              turned_pieces, pieces, turned_pieces == 1 ? "is" : "are",
                              turned_pieces == 1 ? "is" : "are"));
  if (is_inside_out && hollows > 0)  // an inverted hull around a body looks the same
    out.push_back(fmt::format(
        "the surface is inside out, and {} within it {} taken as hollow: hair goes in there; turn the outer "
        "surface, or leave it out",
        counted(hollows, "piece", "pieces"), hollows == 1 ? "is" : "are"));
  if (inner > 0)
    out.push_back(fmt::format("{} within the body, at edges of three or more, {} left out",
                              counted(inner, "triangle", "triangles"), inner == 1 ? "is" : "are"));
  return out;
}

OrientedSurface orientSurface(TriangleMesh mesh) {
  requireSoundMesh(mesh);
  return Orienter(std::move(mesh)).result();
}

}  // namespace strandcast
