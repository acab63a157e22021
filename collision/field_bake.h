#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "collision/mesh_repair.h"
#include "core/distance_field.h"
#include "core/geometry.h"

namespace strandcast {

/// Options of a bake; 0 means a default, see resolveFieldOptions().
struct FieldOptions {
  float hair_radius = 40e-6f;  ///< m, determines `cell` and `band` if these are 0
  float cell = 0;              ///< m, edge of a cell; 0: defaultFieldCell
  float band = 0;  ///< m, distance from the surface within which bricks are stored; 0: defaultFieldBand
  /// m, used instead of `hair_radius` for `band` if it is larger. `cell` does not depend on it: thick hair
  /// does not need a coarser body.
  float thickest_hair = 0;
  /// Whether the winding of triangles is already consistent, as in parts cut from an oriented mesh.
  /// orientSurface is then skipped.
  bool is_oriented = false;
};

/// Default cell, m. With a cell h the interpolated distance to a sphere of radius R has an error of at most
/// h^2 / 4R. The default makes this a quarter of the hair's radius for R an eighth of
/// the body's diagonal (m), about the radius of the head of a bust. The cell is then
/// sqrt(diagonal * radius / 8): 2 mm for hair of 40 um and 0.8 m. Never less than the hair's radius.
float defaultFieldCell(float hair_radius, float diagonal);
/// Default band, m: four cells plus the (thickest) hair's radius. Interpolation reaches two cells, and a hair
/// moves between queries.
float defaultFieldBand(float hair_radius, float cell);

/// Replaces defaults by values for this mesh. Throws Error as requireSoundMesh, when a number is out of
/// range, when the cell is too fine for floats at the mesh's distance from the origin, and when the grid
/// would have more than kMaxGridBricks bricks.
FieldOptions resolveFieldOptions(const TriangleMesh& mesh, const FieldOptions& options);

/// Hash of everything that determines the field: the mesh's positions and triangles as given, the resolved
/// options, and the version of the baking.
uint64_t fieldKey(const TriangleMesh& mesh, const FieldOptions& resolved);

/// Resource limits of a bake. They do not affect the field.
struct BakeLimits {
  int threads = 0;                        ///< 0: all of the machine; does not affect the field
  size_t memory_bytes = size_t{2} << 30;  ///< limit for working memory and field together
};

/// Called on the thread that bakes, with the current activity and the share done, 0 to 1. Returning false
/// stops the bake.
using BakeProgress = std::function<bool(const std::string& what, double part)>;
/// Thrown when BakeProgress returns false.
struct BakeStopped : std::runtime_error {
  BakeStopped() : std::runtime_error("the bake was stopped") {}
};

/// Estimated cost of a bake.
struct BakeEstimate {
  size_t bricks = 0;         ///< upper bound of stored bricks, except those near lids
  size_t field_bytes = 0;    ///< of the field with that many bricks
  size_t working_bytes = 0;  ///< additional memory while baking and writing
  double seconds = 0;        ///< extrapolated from a small sample, on this machine
};

/// Error of a field against the exact distance at random points of the band. At creases and medial axes the
/// exact gradient jumps, and the interpolated one does not: angles are large there with any cell.
struct FieldAccuracy {
  size_t points = 0;
  double worst = 0, rms = 0;                                ///< m, of the distance
  double median_angle = 0, p99_angle = 0, worst_angle = 0;  ///< degrees, of the gradient
  size_t wrong_side = 0;  ///< points farther than a cell from the surface with the wrong sign
  size_t unclear = 0;     ///< points whose winding number is nearer to a half than to an integer
};

/// Bakes the signed distance field of a mesh. The mesh may be open, intersect itself and have parts inside
/// one another; its triangles may be wound either way and be duplicated (orientSurface).
///
/// Distances are exact, to the surface that bounds the outside (FCL's hierarchy). The sign is that of the
/// generalised winding number (Jacobson 2013; evaluated by the series of Barill 2018): inside where its
/// magnitude is above a half. Where the number passes a half over a hole of an open mesh, the inside ends at
/// a lid (BodyDistance). A sheet has outside on both sides.
///
/// The constructor builds the hierarchy and finds the bricks, a small part of the work; bake() does the rest.
/// The field is determined bit for bit by mesh and options, whatever the number of threads.
class FieldBaker {
 public:
  /// Throws Error as resolveFieldOptions does, and when the bake would exceed the memory limit; BakeStopped.
  FieldBaker(const TriangleMesh& mesh, const FieldOptions& options, const BakeLimits& limits = {},
             const BakeProgress& progress = {});
  ~FieldBaker();

  const FieldOptions& options() const;  ///< resolved
  const MeshCheck& mesh() const;        ///< of the oriented mesh
  const SurfaceRepair& repair() const;
  /// Share of the surface with an uncertain inside-outside test, 0 to 1: see uncertainShare in
  /// body_distance.h. 0 for a closed mesh.
  double uncertainShare() const;
  /// Warnings on repairs, and on where inside and outside stay uncertain. One line each, without the name of
  /// the mesh.
  std::vector<std::string> warnings() const;
  const BakeEstimate& estimate() const;

  /// Bakes the field. Throws Error when the memory limit is exceeded; BakeStopped.
  DistanceField bake(const BakeProgress& progress = {});
  /// Number of triangles with inside on both sides. Known after `bake` or `measure`.
  size_t hiddenTriangles() const;
  /// Compares the field with the exact distance at `points` random points.
  FieldAccuracy measure(const DistanceField& field, size_t points, const BakeProgress& progress = {});

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace strandcast
