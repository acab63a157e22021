#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "core/geometry.h"
#include "transport/recording/recording_fields.h"

namespace strandcast {

/// What a grid of air and hair may hold, in the order of their bits in GridRecord::values.
enum class GridValue : size_t { kDensity, kWindX, kWindY, kWindZ, kPressure, kDivergence, kSolid };
inline constexpr size_t kGridValues = 7;
inline constexpr uint32_t kMostGridCells = 128;  ///< per axis
inline constexpr uint32_t kGridLayers = 16;      ///< of cells, that one record holds

/// The air around the hair, and the hair in it, as a recording keeps them beside a frame.
struct AirGrids {
  uint32_t cells = 0;          ///< per axis: a multiple of kGridLayers up to kMostGridCells
  Vec3 origin = Vec3::Zero();  ///< m, world: the corner of least x, y and z; axes are the world's
  float cell = 0;              ///< m
  /// Per GridValue, in the middle of each cell, x fastest, then y: cells^3, or none where it is not known.
  /// kg/m^3 of the strands themselves, m/s, Pa, 1/s; solid is 1 in bodies and 0 elsewhere.
  std::array<std::vector<float>, kGridValues> values;

  const std::vector<float>& of(GridValue value) const { return values[static_cast<size_t>(value)]; }
  std::vector<float>& of(GridValue value) { return values[static_cast<size_t>(value)]; }
};

/// Whether it holds something, of its shape, and all of it is finite.
bool isSound(const AirGrids& grids);

/// Layers first_layer (a multiple of kGridLayers) and on of sound grids, but not the number of their frame.
/// Values are whole numbers of a unit, which is a 32767th of the largest of these layers: off by at most half
/// of it.
void packLayers(const AirGrids& grids, uint32_t first_layer, GridRecord& out);
/// Adds the layers of a record to `grids`; those from 0 on begin anew. False where the record is not sound or
/// is not the next of these grids, which are arbitrary then. Memory grows with what was there.
bool addLayers(const GridRecord& record, AirGrids& grids);

}  // namespace strandcast
