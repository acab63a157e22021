#pragma once
#include <span>
#include <string>
#include <vector>

#include "air/air_fields.h"
#include "core/simulation.h"
#include "render/image.h"

namespace strandcast {

/// What a slice through the air shows.
enum class AirQuantity { kDensity, kWind, kPressure, kDivergence };
/// "density", "wind", "pressure" or "divergence"; Error otherwise.
AirQuantity airQuantity(const std::string& name);
/// The settings that put it on a grid, as options: "--set wind_grid=1".
const char* settingsOf(AirQuantity quantity);
/// Whether it is on a grid.
bool isOnGrid(const AirFields& fields, AirQuantity quantity);
/// Whether it was in the newest step. Error where this backend's grids cannot be looked at.
bool isOnGrid(Simulation& simulation, AirQuantity quantity);
/// Its fields in the newest step. Error where it is on no grid, saying which setting puts it there, or this
/// backend's grids cannot be looked at.
const AirFields& fieldsWith(Simulation& simulation, AirQuantity quantity);

struct AirSlice {
  Image image;
  double full = 0;   ///< what the fullest colour stands for
  const char* unit;  ///< of it
};

/// A slice across `axis` (0 to 2) through the middle of the grid, `size` pixels along each edge: from white
/// to the full colour of the slice's largest value, red above and blue below 0; bodies grey, hair within a
/// cell of the slice as dots. Of wind its speed, with arrows along it, two cells apart.
AirSlice airSlice(const AirFields& fields, AirQuantity quantity, int axis, std::span<const Vec3> hair,
                  int size);

}  // namespace strandcast
