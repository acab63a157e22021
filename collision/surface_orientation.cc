#include "collision/surface_orientation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "collision/mesh_check.h"
#include "collision/surface_pieces.h"
#include "collision/surface_samples.h"

namespace strandcast {
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
  bool isMostlyAgainst() const { return 2 * area_against > area; }
  /// Volume with the winding of the majority, m^3; 0 if the piece is nearly flat and has no inside.
  double givenVolume() const {
    const double flat = (isClosed() ? 1e-9 : 3e-3) * std::pow(area, 1.5);
    if (!(std::fabs(volume) > flat)) return 0;
    return isMostlyAgainst() ? -volume : volume;
  }
};

/// Decision on a piece.
enum class Verdict : uint8_t { kStays, kIsTurned, kIsHollow, kIsLeftOut };

class Orienter {
 public:
  explicit Orienter(TriangleMesh mesh) : mesh_(std::move(mesh)), surface_(mesh_), pieces_(surface_.pieces()) {
    addTriangles();
    addOpenEdges();
    addVolumes();
    double volume = 0;
    for (const Piece& piece : pieces_) volume += piece.givenVolume();
    is_inside_out_ = volume < 0;
    judge();
  }

  OrientedSurface result() && {
    SurfaceRepair repair;
    repair.triangles = mesh_.triangles.size();
    repair.pieces = pieces_.size();
    repair.is_inside_out = is_inside_out_;
    for (const uint8_t repeated : surface_.repeated()) repair.repeated += repeated;
    for (size_t p = 0; p < pieces_.size(); ++p) {
      const Piece& piece = pieces_[p];
      if (verdicts_[p] == Verdict::kIsLeftOut) {
        repair.inner += piece.triangles;
        continue;
      }
      repair.turned_triangles += piece.isMostlyAgainst() ? piece.triangles - piece.against : piece.against;
      repair.turned_pieces += verdicts_[p] == Verdict::kIsTurned ? 1 : 0;
      repair.hollows += verdicts_[p] == Verdict::kIsHollow ? 1 : 0;
    }
    if (repair.changed()) mesh_.triangles = woundTriangles();
    return {std::move(mesh_), repair};
  }

 private:
  Point place(uint32_t vertex) const { return mesh_.positions[vertex].cast<double>(); }

  void addTriangles() {
    for (size_t t = 0; t < mesh_.triangles.size(); ++t) {
      const uint32_t p = surface_.pieceOf()[t];
      if (p == SurfacePieces::kNone) continue;
      const auto& [a, b, c] = mesh_.triangles[t];
      const double area = 0.5 * (place(b) - place(a)).cross(place(c) - place(a)).norm();
      Piece& piece = pieces_[p];
      if (piece.triangles++ == 0) piece.middle = place(a);
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
    const double length = (place(to) - place(from)).norm();
    Piece& piece = pieces_[p];
    if (piece.isClosed()) piece.middle.setZero();
    piece.open_length += length;
    piece.middle += 0.5 * length * (place(from) + place(to));
    piece.divides = piece.divides && uses.size() > 2;
  }

  void addVolumes() {
    for (size_t t = 0; t < mesh_.triangles.size(); ++t) {
      const uint32_t p = surface_.pieceOf()[t];
      if (p == SurfacePieces::kNone) continue;
      Piece& piece = pieces_[p];
      const auto& [a, b, c] = mesh_.triangles[t];
      const double six =
          (place(a) - piece.middle).dot((place(b) - piece.middle).cross(place(c) - piece.middle));
      piece.volume += (surface_.against()[t] == 0 ? six : -six) / 6;
    }
  }

  /// Whether the piece, with the winding of its majority, is wound against the rest.
  bool isAgainstTheRest(const Piece& piece) const {
    return is_inside_out_ ? piece.givenVolume() > 0 : piece.givenVolume() < 0;
  }

  void judge() {
    verdicts_.assign(pieces_.size(), Verdict::kStays);
    std::vector<uint32_t> unclear;  // pieces for which it matters whether they lie inside the others
    for (uint32_t p = 0; p < pieces_.size(); ++p) {
      const Piece& piece = pieces_[p];
      if (isAgainstTheRest(piece)) verdicts_[p] = Verdict::kIsTurned;
      if (pieces_.size() > 1 && (isAgainstTheRest(piece) || (!piece.isClosed() && piece.divides)))
        unclear.push_back(p);
    }
    if (unclear.empty()) return;
    // Of a triangle soup only the largest pieces are examined; the others keep the verdicts above.
    constexpr size_t kMostUnclear = 4000, kSamplesOfAll = 100000, kSamplesOfOne = 100;
    std::stable_sort(unclear.begin(), unclear.end(),
                     [&](uint32_t a, uint32_t b) { return pieces_[a].area > pieces_[b].area; });
    unclear.resize(std::min(unclear.size(), kMostUnclear));
    const size_t samples = std::min(kSamplesOfOne, kSamplesOfAll / unclear.size());
    const MeshQuery all(outward());
    std::vector<TriangleMesh> own = outwardPieces(unclear);
    for (size_t i = 0; i < unclear.size(); ++i) {
      const Piece& piece = pieces_[unclear[i]];
      const Surrounded surrounded = surroundedBy(all, own[i], samples);
      if (!piece.isClosed() && piece.divides && surrounded.wholly > kNearlyAll)
        verdicts_[unclear[i]] = Verdict::kIsLeftOut;
      else if (isAgainstTheRest(piece) &&
               (piece.isClosed() ? surrounded.wholly > kNearlyAll : surrounded.mean > 0.5))
        verdicts_[unclear[i]] = Verdict::kIsHollow;
    }
  }

  static constexpr double kNearlyAll = 0.95;

  /// How far a piece lies inside the others.
  struct Surrounded {
    double wholly = 0;  ///< share of its area that lies inside
    double mean = 0;    ///< mean winding number of the others, unsigned
  };
  static Surrounded surroundedBy(const MeshQuery& all, const TriangleMesh& piece, size_t count) {
    constexpr double kWithin = 0.75;
    const MeshQuery own(piece);
    const std::vector<SurfaceSample> samples = sampleSurface(piece, count);
    Surrounded out;
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
  bool isTurnedInPiece(size_t t) const {
    return (surface_.against()[t] != 0) != pieces_[surface_.pieceOf()[t]].isMostlyAgainst();
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
    if (isTurnedInPiece(t) != isAgainstTheRest(pieces_[p])) turn(out.triangles.back());
  }

  std::vector<std::array<uint32_t, 3>> woundTriangles() const {
    std::vector<std::array<uint32_t, 3>> triangles;
    for (size_t t = 0; t < mesh_.triangles.size(); ++t) {
      const uint32_t p = surface_.pieceOf()[t];
      if (surface_.repeated()[t] != 0) continue;
      if (p != SurfacePieces::kNone && verdicts_[p] == Verdict::kIsLeftOut) continue;
      triangles.push_back(mesh_.triangles[t]);
      if (p == SurfacePieces::kNone) continue;
      const bool is_turned = isTurnedInPiece(t) != (verdicts_[p] == Verdict::kIsTurned);
      if (is_turned != is_inside_out_) turn(triangles.back());
    }
    return triangles;
  }

  TriangleMesh mesh_;
  const SurfacePieces surface_;
  std::vector<Piece> pieces_;
  std::vector<Verdict> verdicts_;
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
