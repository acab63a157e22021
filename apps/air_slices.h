#pragma once
#include <span>
#include <string>
#include <vector>

#include "air/air_system.h"
#include "core/simulation.h"
#include "io/image.h"

namespace strandcast {

/// The quantity that a slice through the air shows.
enum class AirQuantity { kDensity, kWind, kPressure, kDivergence };
/// "density", "wind", "pressure" or "divergence"; Error otherwise.
AirQuantity airQuantity(const std::string& name);
/// The options that put the quantity on a grid: "--set wind_grid=1".
const char* settingsOf(AirQuantity quantity);
/// Whether the fields hold the quantity.
bool isOnGrid(const AirFields& fields, AirQuantity quantity);
/// Whether the newest step computed the quantity on a grid. Throws Error where this backend's grids cannot be
/// read.
bool isOnGrid(Simulation& simulation, AirQuantity quantity);
/// The fields of the newest step. Throws Error where the quantity is on no grid, naming the setting that puts
/// it there, or where this backend's grids cannot be read.
const AirFields& fieldsWith(Simulation& simulation, AirQuantity quantity);

/// A slice as a picture, with the scale of its colours.
struct AirSlice {
  Image image;
  double full = 0;   ///< value that the fullest colour stands for
  const char* unit;  ///< unit of `full`
};

/// A slice across `axis` (0 to 2) through the middle of the grid, `size` pixels along each edge. Colour runs
/// from white to the full colour at the slice's largest absolute value: red above 0, blue below. Bodies are
/// grey. Hair within one cell of the slice is drawn as dots. Wind is drawn as its speed, with arrows two
/// cells apart.
AirSlice airSlice(const AirFields& fields, AirQuantity quantity, int axis, std::span<const Vec3> hair,
                  int size);

}  // namespace strandcast
