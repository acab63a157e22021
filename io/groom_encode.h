#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "core/strand_set.h"

namespace strandcast {

/// Encodes a .tfx file, version 4: positions and strand UVs bit for bit, w = 0 for pinned vertices and 1 for
/// others. Radii and parts are not stored. Throws Error (naming `name`) when there are no strands or their
/// vertex counts differ.
std::vector<std::byte> encodeTfx(const StrandSet& strands, const std::string& name);

/// Encodes a .hair file: positions bit for bit, thickness = twice the radius when there are radii. Pins, UVs
/// and parts are not stored. Throws Error when there are no strands or one has more than 65,536 vertices.
std::vector<std::byte> encodeHair(const StrandSet& strands, const std::string& name);

/// Encodes a .usda file: linear BasisCurves, Y up, UVs per curve, widths = twice the radius when there are
/// radii. Positions are written as the shortest decimals that round-trip. Pins and parts are not stored.
/// `unit_meters`: metres per unit of the positions, 0 if unknown. Throws Error when there are no strands.
std::vector<std::byte> encodeUsda(const StrandSet& strands, float unit_meters, const std::string& name);

}  // namespace strandcast
