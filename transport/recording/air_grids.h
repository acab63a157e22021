#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "core/geometry.h"
#include "transport/recording/record_file.h"

namespace strandcast {

/// Quantities of a grid of air and hair, in the order of their bits in GridRecord::values.
enum class GridValue : size_t { kDensity, kWindX, kWindY, kWindZ, kPressure, kDivergence, kSolid };
inline constexpr size_t kGridValues = 7;
inline constexpr uint32_t kMaxGridCells = 128;  ///< per axis
inline constexpr uint32_t kGridLayers = 16;     ///< layers of cells per record

/// Air and hair around a frame, as a recording stores them.
struct AirGrids {
  uint32_t cells = 0;          ///< per axis: a multiple of kGridLayers, at most kMaxGridCells
  Vec3 origin = Vec3::Zero();  ///< m, world: the corner of least x, y and z; axes are the world's
  float cell = 0;              ///< m
  /// Per GridValue at the middle of each cell, x fastest, then y: cells^3 values, or none where unknown.
  /// Units: density of strands kg/m^3; wind m/s; pressure Pa; divergence 1/s; solid is 1 in bodies and 0
  /// elsewhere.
  std::array<std::vector<float>, kGridValues> values;

  const std::vector<float>& of(GridValue value) const { return values[static_cast<size_t>(value)]; }
  std::vector<float>& of(GridValue value) { return values[static_cast<size_t>(value)]; }
};

/// Whether the grids have values, all arrays have cells^3 entries or none, and all values are finite.
bool isSound(const AirGrids& grids);

/// Packs kGridLayers layers from first_layer (a multiple of kGridLayers) on; does not set out.number.
/// Precondition: isSound(grids). Values are quantised to 1/32767 of the largest in these layers: the error is
/// at most half of that.
void packLayers(const AirGrids& grids, uint32_t first_layer, GridRecord& out);
/// Appends the layers of a record to `grids`; a record of first_layer 0 starts new grids. False where the
/// record is invalid or is not the next one; `grids` is unspecified then. Memory grows with the data that was
/// there.
bool addLayers(const GridRecord& record, AirGrids& grids);

}  // namespace strandcast
