#pragma once
#include <span>
#include <string>
#include <vector>

#include "air/air_fields.h"
#include "render/image.h"

namespace strandcast {

/// What a slice through the air shows.
enum class AirQuantity { kDensity, kWind, kPressure, kDivergence };
/// "density", "wind", "pressure" or "divergence"; Error otherwise.
AirQuantity airQuantity(const std::string& name);
/// Error where the fields do not have it, saying which setting gives it.
void checkHas(const AirFields& fields, AirQuantity quantity);

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
