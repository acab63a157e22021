#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "core/triangle_mesh.h"

namespace strandcast {

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

}  // namespace strandcast
