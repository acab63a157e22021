#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "collision/mesh_check.h"
#include "collision/surface_orientation.h"
#include "core/distance_field.h"
#include "core/triangle_mesh.h"

namespace strandcast {

struct FieldOptions {
  float hair_radius = 40e-6f;  ///< m, what `cell` and `band` follow from where they are 0
  float cell = 0;              ///< m, edge of a cell; 0 = defaultFieldCell
  float band = 0;              ///< m, how far from the surface bricks are stored; 0 = defaultFieldBand
  /// m, that `band` follows from as well where it is more than `hair_radius`; the cell does not, as a body is
  /// no coarser for thick hair.
  float thickest_hair = 0;
  /// Whether triangles are wound as they should be already: then orientSurface does not look at them. Of
  /// parts that were cut from an oriented mesh.
  bool is_oriented = false;
};

/// With a cell h the interpolant of the distance to a sphere of radius R is off by h^2 / 4R at most. The
/// default makes that a quarter of the hair's radius where R is an eighth of the body's diagonal (m), about
/// that of the head of a bust: sqrt(diagonal * radius / 8), 2 mm for hair of 40 um and 0.8 m. Never less than
/// the hair's radius.
float defaultFieldCell(float hair_radius, float diagonal);
/// Four cells and the (thickest) hair's radius: an interpolated value reaches two cells, a hair moves on
/// between.
float defaultFieldBand(float hair_radius, float cell);

/// The options with nothing left to choose, for this mesh. Throws Error as requireSoundMesh, when a number is
/// out of range, when the cell is too fine for floats at the mesh's distance from the origin, and when the
/// grid would have more than kMaxGridBricks bricks.
FieldOptions resolveFieldOptions(const TriangleMesh& mesh, const FieldOptions& options);

/// What the field depends on and nothing else: the mesh's positions and triangles as given, the resolved
/// options and the version of the baking.
uint64_t fieldKey(const TriangleMesh& mesh, const FieldOptions& resolved);

struct BakeLimits {
  int threads = 0;                        ///< 0 = all of the machine; the field does not depend on it
  size_t memory_bytes = size_t{2} << 30;  ///< for working and for the field together
};

/// Called on the baking thread with what is being done and how much of all is done, 0 to 1; false stops it.
using BakeProgress = std::function<bool(const std::string& what, double part)>;
/// Thrown by what BakeProgress stopped.
struct BakeStopped : std::runtime_error {
  BakeStopped() : std::runtime_error("the bake was stopped") {}
};

struct BakeEstimate {
  size_t bricks = 0;         ///< to be stored at most, but for those about lids
  size_t field_bytes = 0;    ///< of the field with as many bricks
  size_t working_bytes = 0;  ///< besides, while baking and writing it
  double seconds = 0;        ///< from a small sample, on this machine
};

/// How far a field is from the exact distance at random points of the band. At creases and medial axes the
/// exact gradient jumps and the field's does not: there angles are large at any cell.
struct FieldAccuracy {
  size_t points = 0;
  double worst = 0, rms = 0;                                ///< m, of the distance
  double median_angle = 0, p99_angle = 0, worst_angle = 0;  ///< degrees, of the gradient
  size_t wrong_side = 0;  ///< points farther than a cell from the surface whose sign is wrong
  size_t unclear = 0;     ///< points whose winding number is nearer to a half than to a whole number
};

/// Bakes the signed distance field of a mesh that may be open, may intersect itself and may have parts inside
/// one another. Its triangles may be wound either way and be there twice (orientSurface). Distances are
/// exact, to the surface that bounds the outside (FCL's hierarchy); the sign is that of the generalised
/// winding number (Jacobson 2013; by the series of Barill 2018): inside where it is above a half in size.
/// Where it passes a half over a hole of an open mesh the inside ends at a lid (BodyDistance). A sheet has
/// outside on both sides.
///
/// Building it makes the hierarchy and finds the bricks, a small part of the work; the rest is `bake`.
/// Neither the number of threads nor anything but mesh and options changes a bit of the field.
class FieldBaker {
 public:
  /// Throws Error as resolveFieldOptions does and when the bake would need more than the limit; BakeStopped.
  FieldBaker(const TriangleMesh& mesh, const FieldOptions& options, const BakeLimits& limits = {},
             const BakeProgress& progress = {});
  ~FieldBaker();

  const FieldOptions& options() const;  ///< resolved
  const MeshCheck& mesh() const;        ///< of the oriented mesh
  const SurfaceRepair& repair() const;
  /// Of the surface, 0 to 1: see shareInDoubt. 0 of a closed mesh.
  double shareInDoubt() const;
  /// What to warn of: what was repaired, and where inside and outside stay in doubt. A line each, without the
  /// mesh's name.
  std::vector<std::string> warnings() const;
  const BakeEstimate& estimate() const;

  DistanceField bake(const BakeProgress& progress = {});
  /// Triangles that have inside on both sides. Known after `bake` or `measure`.
  size_t hiddenTriangles() const;
  /// Compares with the exact distance at `points` random places.
  FieldAccuracy measure(const DistanceField& field, size_t points, const BakeProgress& progress = {});

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace strandcast
