#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/triangle_mesh.h"

namespace strandcast {

/// Use of an edge by one triangle.
struct EdgeUse {
  uint64_t places;  ///< numbers of the two positions, the lower in the high half
  uint32_t triangle;
  bool is_forward;  ///< runs from the lower to the higher number
  bool operator<(const EdgeUse& other) const {
    return places != other.places ? places < other.places : triangle < other.triangle;
  }
};

/// The triangles of a mesh grouped into *pieces*, connected by edges that exactly two triangles share.
/// Memory: about 100 bytes per triangle.
class SurfacePieces {
 public:
  /// Performs steps 1 to 3 of orientSurface. Precondition: requireSoundMesh() holds.
  explicit SurfacePieces(const TriangleMesh& mesh);

  static constexpr uint32_t kNone = 0xFFFFFFFF;

  /// Number of pieces.
  size_t pieces() const { return count_; }
  /// Per triangle, its piece; kNone if it was left out or has two coincident corners.
  const std::vector<uint32_t>& pieceOf() const { return piece_; }
  /// Per triangle, 0 or 1: its winding is opposite to that of the first triangle of its piece.
  const std::vector<uint8_t>& against() const { return against_; }
  /// Per triangle, 0 or 1: left out as a duplicate.
  const std::vector<uint8_t>& repeated() const { return repeated_; }
  /// Uses of edges by all triangles that have a piece, sorted.
  const std::vector<EdgeUse>& edges() const { return edges_; }
  /// The two vertices of the triangle at the edge, in the order of the triangle.
  std::array<uint32_t, 2> endsOf(const TriangleMesh& mesh, const EdgeUse& use) const;

 private:
  void gatherEdges(const TriangleMesh& mesh);
  bool weldOpenEdges(const TriangleMesh& mesh);
  bool findRepeatedTriangles(const TriangleMesh& mesh, std::vector<uint8_t>& many);
  bool findRepeatedPolygons(const TriangleMesh& mesh, std::vector<uint8_t>& many);
  bool isCrowded() const;
  bool isFolded(const TriangleMesh& mesh, std::span<const EdgeUse> uses) const;
  void leaveOutRepeats(const TriangleMesh& mesh);
  void join(size_t triangles);
  uint64_t placesOf(uint32_t from, uint32_t to) const;
  bool isFlat(const std::array<uint32_t, 3>& triangle) const;

  std::vector<uint32_t> place_;  // per vertex, the number of its position
  std::vector<EdgeUse> edges_;
  std::vector<uint8_t> repeated_, against_;
  std::vector<uint32_t> piece_;
  size_t count_ = 0;
};

/// Calls act(uses) with the uses of each edge. `uses` must be sorted.
template <class Act>
void forEachEdge(std::span<const EdgeUse> uses, Act act) {
  for (size_t i = 0; i < uses.size();) {
    size_t end = i;
    while (end < uses.size() && uses[end].places == uses[i].places) ++end;
    act(uses.subspan(i, end - i));
    i = end;
  }
}

}  // namespace strandcast
