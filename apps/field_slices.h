#pragma once
#include <filesystem>
#include <vector>

#include "core/distance_field.h"
#include "io/image.h"

namespace strandcast {

/// A slice through the field across `axis` (0 to 2) at the fraction `part` (0 to 1) of its grid. Blue is
/// outside, red inside, both paler towards the surface, which is a black line. Near the surface a thin line
/// marks every four cells.
Image fieldSlice(const DistanceField& field, int axis, double part);

/// Writes three slices per axis (x_25.png, x_50.png, ...) into the folder, which it creates. Returns their
/// paths.
std::vector<std::filesystem::path> writeFieldSlices(const DistanceField& field,
                                                    const std::filesystem::path& folder);

}  // namespace strandcast
