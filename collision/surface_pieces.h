#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/triangle_mesh.h"

namespace strandcast {

/// An edge as one triangle has it.
struct EdgeUse {
  uint64_t places;  ///< numbers of the two places, the lower in the high half
  uint32_t triangle;
  bool is_forward;  ///< from the lower to the higher
  bool operator<(const EdgeUse& other) const {
    return places != other.places ? places < other.places : triangle < other.triangle;
  }
};

/// The triangles of a mesh joined into *pieces*: over edges that exactly two triangles share. Memory: about
/// 100 bytes a triangle.
class SurfacePieces {
 public:
  /// See orientSurface, 1 to 3. The mesh must be sound.
  explicit SurfacePieces(const TriangleMesh& mesh);

  static constexpr uint32_t kNone = 0xFFFFFFFF;

  size_t pieces() const { return count_; }
  /// Per triangle its piece; kNone of those that were left out, or that have two corners in one place.
  const std::vector<uint32_t>& pieceOf() const { return piece_; }
  /// Per triangle, 0 or 1: it is wound against the first of its piece.
  const std::vector<uint8_t>& against() const { return against_; }
  /// Per triangle, 0 or 1: left out, as another has its corners.
  const std::vector<uint8_t>& repeated() const { return repeated_; }
  /// Sorted, of all triangles that have a piece.
  const std::vector<EdgeUse>& edges() const { return edges_; }
  /// The vertices that the triangle has at the edge, in its order.
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

  std::vector<uint32_t> place_;  // per vertex
  std::vector<EdgeUse> edges_;
  std::vector<uint8_t> repeated_, against_;
  std::vector<uint32_t> piece_;
  size_t count_ = 0;
};

/// act(the uses of one edge) for every edge of sorted uses.
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
