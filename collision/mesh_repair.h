// Checks of a mesh before queries and bakes, and the repair of its winding.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/geometry.h"

namespace strandcast {

/// Throws Error, with kind and location of the fault, on a mesh without triangles, a vertex that is not
/// finite, or an index out of range.
void requireSoundMesh(const TriangleMesh& mesh);

/// Per vertex, the number of its position. Vertices with equal coordinates share a number.
std::vector<uint32_t> vertexPlaces(const std::vector<Vec3>& positions);

/// An edge with unequal numbers of triangles in its two directions.
struct OpenEdge {
  Vec3 from, to;
  float excess;  ///< triangles that go from `from` to `to`, minus those in the other direction; positive
};

/// Result of checkMesh().
struct MeshCheck {
  size_t triangles = 0;
  size_t without_area = 0;  ///< triangles with collinear corners
  /// Empty for a closed mesh: then the winding number is an integer everywhere, even if the surface
  /// intersects itself.
  std::vector<OpenEdge> open_edges;
};

/// Finds open edges and degenerate triangles. Coincident vertices count as one, so that seams of texture
/// coordinates are no holes. Throws Error as requireSoundMesh.
MeshCheck checkMesh(const TriangleMesh& mesh);

/// Changes made by orientSurface. All zero: the mesh is unchanged, bit for bit.
struct SurfaceRepair {
  size_t triangles = 0;         ///< of the mesh as given
  size_t pieces = 0;            ///< number of pieces: triangles connected by edges
  size_t repeated = 0;          ///< triangles left out: duplicates of another one's corners
  size_t inner = 0;             ///< triangles left out: sheets inside the body that divide it
  size_t turned_triangles = 0;  ///< triangles reversed: wound against the rest of their piece
  size_t turned_pieces = 0;     ///< pieces reversed: wound against the other pieces
  size_t hollows = 0;           ///< pieces inside others that are wound against them and stay: cavities
  bool is_inside_out = false;   ///< the surface as a whole is inside out; it keeps its inside

  bool changed() const { return repeated + inner + turned_triangles + turned_pieces > 0; }
  /// One line per kind of change, for the user.
  std::vector<std::string> lines() const;
};

/// Result of orientSurface().
struct OrientedSurface {
  TriangleMesh mesh;  ///< positions as given; triangles in their order, some reversed, some left out
  SurfaceRepair repair;
};

/// The mesh with its triangles wound so that its winding number tells inside from outside:
/// 1. Coincident vertices count as one. Vertices of open edges within a millionth of the mesh's diagonal
///    (or a few roundings of its coordinates) count as one as well. No vertex is moved.
/// 2. Of triangles with the same three corners, in either winding, one stays; likewise of polygons with the
///    same edges, however they are triangulated. None stays where the others are closed without it, as with
///    the shared wall of two boxes.
/// 3. Triangles that share an edge with no third one belong to one *piece* and are wound consistently. The
///    minority by area is reversed.
/// 4. A piece is wound outward if it encloses a positive volume; an open piece is closed for this test by a
///    fan from the centre of its open edges. The sign of most of the volume decides whether the pieces as a
///    whole are inside out. A piece against that is reversed, except one inside the others: that is a cavity.
/// 5. A sheet that ends at edges of three or more triangles and has inside on both sides is left out.
///
/// A mesh that needs no change is returned unchanged, also if it is inside out as a whole. Takes O(n log n)
/// time. Throws Error as requireSoundMesh.
OrientedSurface orientSurface(TriangleMesh mesh);

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
  void removeDuplicates(const TriangleMesh& mesh);
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
