#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "core/triangle_mesh.h"

namespace strandcast {

/// What orientSurface changed. All zero: the mesh is as it was given, bit for bit.
struct SurfaceRepair {
  size_t triangles = 0;         ///< of the mesh as given
  size_t pieces = 0;            ///< of triangles that share edges
  size_t repeated = 0;          ///< triangles left out: another has the same three corners
  size_t inner = 0;             ///< triangles left out: sheets within the body that divide it
  size_t turned_triangles = 0;  ///< wound against the rest of their piece
  size_t turned_pieces = 0;     ///< turned as a whole: they were wound against the other pieces
  size_t hollows = 0;           ///< pieces within others that stay wound against them: they are hollows
  bool is_inside_out = false;   ///< the surface as a whole: it is taken as it is meant

  bool changed() const { return repeated + inner + turned_triangles + turned_pieces > 0; }
  /// A line for each kind of change, for people.
  std::vector<std::string> lines() const;
};

struct OrientedSurface {
  TriangleMesh mesh;  ///< positions as given; triangles in their order, some turned, some left out
  SurfaceRepair repair;
};

/// The mesh with its triangles wound so that its winding number tells inside from outside:
/// 1. Vertices in one place count as one. Vertices of open edges within a millionth of the mesh's diagonal
///    (or a few roundings of its coordinates) count as one as well. No vertex is moved.
/// 2. Of triangles with the same three corners, wound alike or not, one stays; likewise of polygons with the
///    same edges, however they are divided. None stays where the others are closed without it, as of two
///    boxes that share a wall.
/// 3. Triangles that share an edge with no third are wound alike: they are a *piece*. What fewer of a piece's
///    area need is turned.
/// 4. A piece is wound outwards when it encloses a positive volume; an open one is closed by fans from the
///    middle of its open edges. The pieces as a whole may be inside out, as most of their volume is. A piece
///    against that is turned, but for one wholly within the others: that is a hollow.
/// 5. A sheet that ends at edges of three or more triangles and has inside on both sides is left out.
/// A mesh of which nothing has to be changed comes back as it is, also one that is inside out as a whole.
/// Takes time in n log n of its triangles. Throws Error as requireSoundMesh.
OrientedSurface orientSurface(TriangleMesh mesh);

}  // namespace strandcast
