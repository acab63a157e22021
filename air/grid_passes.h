#pragma once
#include <cstdint>
#include <string>

#include "air/grid_shape.h"
#include "air/hair_layout.h"
#include "core/contact_primitive.h"

namespace strandcast {

/// The wind grid as its passes see it. Arrays of the shape, from place (0, 0, 0); velocities in m/s.
template <class Scalar>
struct WindView {
  GridShape shape;
  Scalar* velocity[3];      ///< of faces
  Scalar* next[3];          ///< what a pass makes of them
  Scalar* displacement[3];  ///< of cells: how far what comes there has gone over the step, in cells
  Scalar* onward[3];    ///< of cells: how far what is there will go over the step, less than 0 along the wind
  Scalar* centre;       ///< of cells: 4 numbers each, velocity and 0
  Scalar* exchange[4];  ///< of cells: rate x time step, and that times the velocity that air is drawn to
  Scalar* slip[6] = {};           ///< of cells, as draggedAmong() has it: xx, yy, zz, yz, xz, xy
  const void* ambient = nullptr;  ///< for ambient_velocity; null: walls
  /// Component `axis` of what blows beyond the grid, at a place in cells.
  Scalar (*ambient_velocity)(const void* ambient, int axis, const Scalar* at) = nullptr;
  const Scalar* wanted = nullptr;  ///< of cells: outflow that is to be left there, m/s; null: none anywhere
};

/// One level of the pressure's linear system: each cell against its six neighbours.
template <class Scalar>
struct PressureView {
  GridShape shape;
  const Scalar* open[3];           ///< weights of faces
  const Scalar* diagonal;          ///< their sum around a cell, 0 in solids
  const Scalar* inverse_diagonal;  ///< 0 in solids
  const Scalar*
      even;  ///< [cells * cells], per row: the weight of all faces of its cells, 0 where they differ
};

/// A piece of a strand, as it is splatted.
struct StrandSample {
  uint32_t vertex;  ///< its first
  uint32_t share;   ///< first of as many entries of shares
  uint32_t count;   ///< of vertices
  float mass;       ///< kg
};

template <class Scalar>
struct SplatView {
  GridShape shape;
  Scalar frame[12];                   ///< world to cells: 3 rows of 3, then the offset
  Scalar mass_scale, momentum_scale;  ///< from kg and kg m/s to whole numbers
  const float* positions;
  const float* velocities;
  Scalar ahead;  ///< s, by which places go on as velocities say
  const StrandSample* samples;
  const float* shares;   ///< of a sample's vertices in it, sum 1
  const Scalar* masses;  ///< kg, per sample
  Scalar* places;        ///< kPlacePlanes of `stride` numbers, one per sample and 16 to spare
  size_t stride;
  Scalar* motion;  ///< 4 per sample: velocity, 1
};
enum PlacePlane : int {
  kGridPlace,       ///< 3, in cells
  kWorldPlace = 3,  ///< 3, m
  kPlacePlanes = 6
};

/// What samples come to: the largest component of velocity, m/s, and where those lie that are in the grid, in
/// cells; low is above high where none is.
template <class Scalar>
struct SplatReach {
  Scalar fastest, low[3], high[3];
};

/// How crowded samples are: kernels/grid.h.
template <class Scalar>
struct CrowdView {
  const Scalar* density;  ///< of nodes, from place (0, 0, 0)
  const Scalar* rest;     ///< density at rest, per sample and 16 to spare
  Scalar* held;           ///< heldCrowding, as rest
  const Scalar* largest;  ///< what crowding comes to at most with a stiffness of 1, as rest
  Scalar rest_scale, stiffness, gain;
  Scalar scale;  ///< from mass x crowding to whole numbers
};

/// Nodes of the hair grid, from place (0, 0, 0).
template <class Scalar>
struct HairView {
  GridShape shape;
  const Scalar* nodes;     ///< 4 numbers each: momentum per volume, density
  const Scalar* density;   ///< blurred
  const Scalar* crowding;  ///< of the nodes' samples; null where hair is not pushed apart
  const Scalar* crowded;   ///< mass x crowding, blurred
  Scalar slope;            ///< pushAlong in kernels/grid.h
  Scalar turn[9];          ///< of the head, 3 rows: pushes to the world
  Scalar* spread;          ///< `nodes` x density^(-1/2), then blurred; null where hair does not rub
  Scalar part;             ///< that friction takes of what hair moves by against its surroundings
  Scalar* changes;         ///< 4 numbers each: change of velocity, and what it loses of its own
};

/// What is done to a layer, a range of samples, ... Compiled once per lane type.
template <class Scalar>
struct GridPasses {
  std::string name;  ///< "scalar" or of the instruction set
  /// signedDistance() of points, 3 numbers each; `words` of the ShapeData.
  void (*distances)(const MovingPrimitive&, const uint32_t* words, const float* points, size_t count,
                    float* out);
  void (*centre)(const WindView<Scalar>&, int layer);
  /// Into `out`; a negative Courant number (time step over cell, s/m) looks ahead.
  void (*displace)(const WindView<Scalar>&, Scalar courant, Scalar* const* out, int layer);
  void (*advect)(const WindView<Scalar>&, int axis, int layer);
  /// MacCormack: corrects `next` into `out`.
  void (*correct)(const WindView<Scalar>&, int axis, Scalar* out, int layer);
  void (*diffuse)(const WindView<Scalar>&, int axis, Scalar coefficient, int layer);
  void (*exchange)(const WindView<Scalar>&, int axis, int layer);
  /// The same where air slips along hair; the other components are those of `centre`.
  void (*exchangeAmong)(const WindView<Scalar>&, int axis, int layer);

  /// The largest component of velocity, whatever its sign.
  Scalar (*fastest)(const WindView<Scalar>&, int layer);
  /// The pressure's right-hand side: the outflow that is wanted less that there is, 0 in solids.
  void (*outflow)(const WindView<Scalar>&, const PressureView<Scalar>&, Scalar* right, int layer);
  /// From x, or from 0 where it is null.
  void (*smooth)(const PressureView<Scalar>&, const Scalar* x, const Scalar* right, Scalar weight,
                 Scalar* out, int layer);
  void (*residual)(const PressureView<Scalar>&, const Scalar* x, const Scalar* right, Scalar* out, int layer);
  /// Between a level of the pressure and the next coarser one: sums of eight cells, of a coarse layer; and to
  /// the cells of a fine layer that are not solid, what is there in the coarse one.
  void (*restrict)(const GridShape& fine, const Scalar* in, const GridShape& coarse, Scalar* out, int layer);
  void (*prolong)(const PressureView<Scalar>& fine, const GridShape& coarse, const Scalar* in, Scalar* x,
                  int layer);
  /// out = A x; gives dot(x, out).
  double (*apply)(const PressureView<Scalar>&, const Scalar* x, Scalar* out, int layer);
  /// x += a s, r -= a q; gives the largest |r|.
  Scalar (*advance)(const GridShape&, Scalar a, const Scalar* s, const Scalar* q, Scalar* x, Scalar* r,
                    int layer);
  double (*dot)(const GridShape&, const Scalar* a, const Scalar* b, int layer);
  /// s = z + a s
  void (*turn)(const GridShape&, Scalar a, const Scalar* z, Scalar* s, int layer);
  void (*subtractGradient)(const WindView<Scalar>&, const PressureView<Scalar>&, const Scalar* pressure,
                           int axis, int layer);

  // Samples in ranges that begin at multiples of 16.
  /// Where samples are and how fast.
  SplatReach<Scalar> (*place)(const SplatView<Scalar>&, size_t begin, size_t end);
  /// Adds them to nodes of 4 numbers, momentum and mass.
  void (*splat)(const SplatView<Scalar>&, size_t begin, size_t end, int32_t* nodes);
  /// What nodes of one number have at samples; per sample and 16 to spare.
  void (*sampleNumbers)(const SplatView<Scalar>&, size_t begin, size_t end, const Scalar* nodes, Scalar* out);
  /// Adds mass x crowding of samples to nodes of one number.
  void (*crowd)(const SplatView<Scalar>&, size_t begin, size_t end, const CrowdView<Scalar>&, int32_t* nodes);
  /// One axis of a blur by (1 2 1) / 4 of nodes of `numbers` numbers, in a box beyond whose inner nodes `in`
  /// is 0.
  void (*blur)(const GridShape&, int numbers, int axis, const NodeBox& box, const Scalar* in, Scalar* out,
               int layer);
  /// Nodes of a layer in a box: what is to be blurred for friction, and what hair there changes by.
  void (*spread)(const HairView<Scalar>&, const NodeBox& box, int layer);
  void (*forces)(const HairView<Scalar>&, const NodeBox& box, int layer);
  /// What nodes of 4 numbers have at `count` places (in cells, 3 planes of `stride` numbers, 16 of each to
  /// spare), 4 numbers each.
  void (*sample)(const GridShape&, const Scalar* nodes, const Scalar* places, size_t stride, size_t count,
                 Scalar* out);
  /// The same at samples, less its last number x the sample's velocity. `out` from sample `begin` on.
  void (*change)(const SplatView<Scalar>&, const Scalar* nodes, size_t begin, size_t end, Scalar* out);
};

template <class Scalar>
const GridPasses<Scalar>& scalarPasses();
template <>
const GridPasses<float>& scalarPasses<float>();
template <>
const GridPasses<double>& scalarPasses<double>();
/// For the best instruction set that was compiled for and that the machine has.
const GridPasses<float>& simdPasses();
/// Those of a backend: "reference" or "simd"; Error on another name.
const GridPasses<float>& passesOf(const std::string& backend);

}  // namespace strandcast
