// Passes over the grids of air and hair, memory layout of these grids, and threads for the passes.
#pragma once
#include <Eigen/Geometry>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/contact_primitive.h"
#include "core/strand_block.h"

namespace strandcast {

/// Memory layout of a cubic grid: x fastest. Rows and layers are padded, so every row, layer and grid has an
/// element before its first and behind its last one, and vectors of 16 may read and write past the end of a
/// row. An index may be -1 or `cells` on one axis at a time.
struct GridShape {
  int cells = 0;  ///< per axis

  size_t row() const { return static_cast<size_t>(cells) + 16; }
  size_t layer() const { return row() * (static_cast<size_t>(cells) + 1); }
  size_t size() const { return layer() * (static_cast<size_t>(cells) + 2) + 16; }
  size_t at(int i, int j, int k) const {
    return layer() * static_cast<size_t>(k + 1) + row() * static_cast<size_t>(j) + static_cast<size_t>(i);
  }
  /// Stride between neighbours along `axis`.
  size_t next(int axis) const { return axis == 0 ? 1 : axis == 1 ? row() : layer(); }
};

/// Nodes or cells from min() to max(), both inclusive.
using NodeBox = Eigen::AlignedBox3i;

/// Values of a grid; GridShape::size() elements (times the components of a node).
template <class Scalar>
using GridArray = std::vector<Scalar, CacheLineAllocator<Scalar>>;

/// The wind grid as its passes see it. Arrays of `shape`, from index (0, 0, 0); velocities in m/s.
template <class Scalar>
struct WindView {
  GridShape shape;
  Scalar* velocity[3];      ///< per face
  Scalar* next[3];          ///< per face: output of a pass
  Scalar* displacement[3];  ///< per cell: displacement over the step of the air that arrives there, in cells
  Scalar* onward[3];     ///< per cell: displacement over the step of the air that is there, negated, in cells
  Scalar* centre;        ///< per cell: 4 numbers, velocity and 0
  Scalar* exchange[4];   ///< per cell: rate x time step, and that times the target velocity (3 components)
  Scalar* slip[6] = {};  ///< per cell, for draggedAmong(): xx, yy, zz, yz, xz, xy
  const void* ambient = nullptr;  ///< first argument of ambient_velocity; null: walls
  /// Component `axis` of the ambient wind, m/s, at a position in cells.
  Scalar (*ambient_velocity)(const void* ambient, int axis, const Scalar* at) = nullptr;
  const Scalar* target_divergence = nullptr;  ///< per cell: target divergence x cell, m/s; null: 0 everywhere
};

/// One level of the pressure's linear system: a seven-point stencil.
template <class Scalar>
struct PressureView {
  GridShape shape;
  const Scalar* open[3];           ///< per face: weight, 0 closed
  const Scalar* diagonal;          ///< per cell: sum of the weights of its faces, 0 in solids
  const Scalar* inverse_diagonal;  ///< per cell; 0 in solids
  const Scalar* even;  ///< [cells * cells], per row: the common weight of all faces of its cells; 0 where
                       ///< weights differ
};

/// A piece of a strand, splatted as one sample.
struct StrandSample {
  uint32_t vertex;  ///< first vertex
  uint32_t share;   ///< first of `count` entries of SplatView::shares
  uint32_t count;   ///< vertices
  float mass;       ///< kg
};

template <class Scalar>
struct SplatView {
  GridShape shape;
  Scalar frame[12];                   ///< positions (m) to cells: 3 rows of 3, then the offset
  Scalar mass_scale, momentum_scale;  ///< fixed-point units per kg and per kg m/s
  const float* positions;             ///< 3 per vertex, m
  const float* velocities;            ///< 3 per vertex, m/s
  Scalar ahead;                       ///< s, positions are extrapolated by so much with their velocities
  const StrandSample* samples;
  const float* shares;   ///< weights of the samples' vertices, sum 1 per sample
  const Scalar* masses;  ///< kg per sample
  Scalar* places;        ///< kPlacePlanes planes of `stride` numbers: one per sample, 16 spare
  size_t stride;
  Scalar* motion;  ///< 4 per sample: velocity (m/s), 1
};
enum PlacePlane : int {
  kGridPlace,       ///< 3 planes, cells
  kWorldPlace = 3,  ///< 3 planes, m from the origin
  kPlacePlanes = 6
};

/// Statistics of samples: the largest component of velocity, m/s, and the bounds of the samples inside the
/// grid, in cells. low > high where no sample is inside.
template <class Scalar>
struct SplatReach {
  Scalar fastest, low[3], high[3];
};

/// Inputs and state of the crowding of samples: crowding() and heldCrowding() in kernels/grid.h.
template <class Scalar>
struct CrowdView {
  const Scalar* density;  ///< per node, kg/m^3, from index (0, 0, 0)
  const Scalar* rest;     ///< rest density, kg/m^3; per sample, 16 spare
  Scalar* held;           ///< result of heldCrowding(); per sample, 16 spare
  const Scalar* largest;  ///< bound of crowding() at a stiffness of 1; per sample, 16 spare
  Scalar rest_scale, stiffness, gain;
  Scalar scale;  ///< fixed-point units per mass x crowding
};

/// Nodes of the hair grid, from index (0, 0, 0).
template <class Scalar>
struct HairView {
  GridShape shape;
  const Scalar* nodes;     ///< 4 per node: momentum per volume (kg/(m^2 s)), density (kg/m^3)
  const Scalar* density;   ///< blurred
  const Scalar* crowding;  ///< mean crowding of a node's samples; null without volume_stiffness
  const Scalar* crowded;   ///< mass x crowding, blurred
  Scalar slope;            ///< for pushAlong() in kernels/grid.h
  Scalar turn[9];          ///< rotation of the head, 3 rows: from grid axes to the world
  Scalar* spread;          ///< `nodes` x density^(-1/2), then blurred; null without hair_friction
  Scalar part;             ///< fraction of the relative velocity that friction removes in the step
  Scalar* changes;  ///< 4 per node: velocity increment, and the fraction of its own velocity that hair loses
};

/// Function table of the passes, each over one layer of a grid or a range of samples. Compiled once per lane
/// type. A pass of a layer writes that layer only, so layers may run concurrently.
template <class Scalar>
struct GridPasses {
  std::string name;  ///< "scalar" or the instruction set
  /// signedDistance() of `count` points, 3 numbers each, m. `words`: ShapeData::words.
  void (*distances)(const MovingPrimitive&, const uint32_t* words, const float* points, size_t count,
                    float* out);
  /// Velocities of cell centres from those of faces.
  void (*centre)(const WindView<Scalar>&, int layer);
  /// Displacements of cells into `out`[3]. `courant`: time step over cell, s/m; negative traces forwards.
  void (*displace)(const WindView<Scalar>&, Scalar courant, Scalar* const* out, int layer);
  /// Semi-Lagrangian advection of `velocity` into `next`.
  void (*advect)(const WindView<Scalar>&, int axis, int layer);
  /// MacCormack correction of `next` into `out`.
  void (*correct)(const WindView<Scalar>&, int axis, Scalar* out, int layer);
  /// One explicit step of viscosity. `coefficient`: viscosity x time / cell^2.
  void (*diffuse)(const WindView<Scalar>&, int axis, Scalar coefficient, int layer);
  /// Implicit exchange of momentum with `exchange`, in place.
  void (*exchange)(const WindView<Scalar>&, int axis, int layer);
  /// The same with anisotropic drag (`slip`). The other two components of velocity come from `centre`.
  void (*exchangeAmong)(const WindView<Scalar>&, int axis, int layer);

  /// Largest absolute component of velocity, m/s.
  Scalar (*fastest)(const WindView<Scalar>&, int layer);
  /// Right-hand side of the pressure: target divergence less divergence, x cell (m/s); 0 in solids.
  void (*outflow)(const WindView<Scalar>&, const PressureView<Scalar>&, Scalar* right, int layer);
  /// One weighted Jacobi sweep from x, or from 0 where x is null.
  void (*smooth)(const PressureView<Scalar>&, const Scalar* x, const Scalar* right, Scalar weight,
                 Scalar* out, int layer);
  /// out = right - A x.
  void (*residual)(const PressureView<Scalar>&, const Scalar* x, const Scalar* right, Scalar* out, int layer);
  /// Transfer between a level and the next coarser one. restrict: a coarse cell gets the sum of its eight
  /// fine cells; `layer` is coarse. prolong: adds a coarse value to its fine cells that are not solid;
  /// `layer` is fine.
  void (*restrict)(const GridShape& fine, const Scalar* in, const GridShape& coarse, Scalar* out, int layer);
  void (*prolong)(const PressureView<Scalar>& fine, const GridShape& coarse, const Scalar* in, Scalar* x,
                  int layer);
  /// out = A x; returns dot(x, out).
  double (*apply)(const PressureView<Scalar>&, const Scalar* x, Scalar* out, int layer);
  /// x += a s, r -= a q; returns the largest |r|.
  Scalar (*advance)(const GridShape&, Scalar a, const Scalar* s, const Scalar* q, Scalar* x, Scalar* r,
                    int layer);
  double (*dot)(const GridShape&, const Scalar* a, const Scalar* b, int layer);
  /// s = z + a s
  void (*updateDirection)(const GridShape&, Scalar a, const Scalar* z, Scalar* s, int layer);
  void (*subtractGradient)(const WindView<Scalar>&, const PressureView<Scalar>&, const Scalar* pressure,
                           int axis, int layer);

  // Passes over samples; a range begins at a multiple of 16.
  /// Positions and velocities of samples from those of vertices.
  SplatReach<Scalar> (*place)(const SplatView<Scalar>&, size_t begin, size_t end);
  /// Adds momentum and mass of samples to nodes of 4 fixed-point numbers.
  void (*splat)(const SplatView<Scalar>&, size_t begin, size_t end, int32_t* nodes);
  /// Interpolates nodes of one number at samples into `out`: per sample, 16 spare.
  void (*sampleNumbers)(const SplatView<Scalar>&, size_t begin, size_t end, const Scalar* nodes, Scalar* out);
  /// Updates `held` and adds mass x crowding of samples to nodes of one fixed-point number.
  void (*crowd)(const SplatView<Scalar>&, size_t begin, size_t end, const CrowdView<Scalar>&, int32_t* nodes);
  /// Blur by (1 2 1) / 4 along one axis, of nodes with `numbers` numbers, in `box`. `in` is 0 outside the
  /// inner nodes of `box`.
  void (*blur)(const GridShape&, int numbers, int axis, const NodeBox& box, const Scalar* in, Scalar* out,
               int layer);
  /// Nodes of a layer in a box. spread: the input of friction's blur. forces: the changes of velocity.
  void (*spread)(const HairView<Scalar>&, const NodeBox& box, int layer);
  void (*forces)(const HairView<Scalar>&, const NodeBox& box, int layer);
  /// Interpolates nodes of 4 numbers at `count` positions into `out`, 4 numbers each. `places`: cells, 3
  /// planes of `stride` numbers, 16 spare in each.
  void (*sample)(const GridShape&, const Scalar* nodes, const Scalar* places, size_t stride, size_t count,
                 Scalar* out);
  /// The same at samples, less the fourth number x the sample's velocity. `out`: from sample `begin` on.
  void (*change)(const SplatView<Scalar>&, const Scalar* nodes, size_t begin, size_t end, Scalar* out);
};

template <class Scalar>
const GridPasses<Scalar>& scalarPasses();
template <>
const GridPasses<float>& scalarPasses<float>();
template <>
const GridPasses<double>& scalarPasses<double>();
/// Passes for the best instruction set that is compiled in and that the machine supports.
const GridPasses<float>& simdPasses();
/// Passes of the backend "reference" or "simd". Throws Error on another name.
const GridPasses<float>& passesOf(const std::string& backend);

/// A pool of threads for layers of a grid or chunks of strands. Results must not depend on which thread runs
/// which item.
class Workers {
 public:
  explicit Workers(int threads);  ///< 0 = all hardware threads
  ~Workers();
  int threads() const { return threads_; }
  /// Calls work(i) for i in 0 .. count - 1, concurrently and in any order; returns when all are done. Does
  /// not allocate.
  template <class Work>
  void forEach(int count, const Work& work) const {
    run(
        count, [](const void* what, int i) { (*static_cast<const Work*>(what))(i); }, &work);
  }

 private:
  struct Arena;
  void run(int count, void (*call)(const void*, int), const void* work) const;

  int threads_;
  std::unique_ptr<Arena> arena_;
};

}  // namespace strandcast
