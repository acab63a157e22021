#pragma once
#include <filesystem>
#include <vector>

#include "core/distance_field.h"
#include "render/image.h"

namespace strandcast {

/// A slice through the field across `axis` (0 to 2) at `part` (0 to 1) of its grid: blue outside, red inside,
/// paler towards the surface, which is a black line; a thin line every four cells near it.
Image fieldSlice(const DistanceField& field, int axis, double part);

/// Writes three slices per axis (x_25.png, x_50.png, ...) into the folder, which is made. Returns their
/// paths.
std::vector<std::filesystem::path> writeFieldSlices(const DistanceField& field,
                                                    const std::filesystem::path& folder);

}  // namespace strandcast
