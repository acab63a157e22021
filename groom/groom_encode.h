#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "core/strand_set.h"

namespace strandcast {

/// The bytes of a .tfx file, version 4: positions and strand UVs bit for bit, w = 0 where pinned and 1
/// elsewhere. Radii and parts have no place in it. Throws Error (naming `name`) when there are no strands or
/// their counts differ.
std::vector<std::byte> encodeTfx(const StrandSet& strands, const std::string& name);

/// The bytes of a .hair file: positions bit for bit, thickness = twice the radius when there are radii; pins,
/// UVs and parts have no place in it. Throws Error when there are no strands or one has more than 65,536
/// vertices.
std::vector<std::byte> encodeHair(const StrandSet& strands, const std::string& name);

/// The text of a .usda file: linear BasisCurves, Y up, positions as the shortest numbers that give them back,
/// widths = twice the radius when there are radii, UVs per curve; pins and parts have no place in it.
/// `unit_meters` of its positions, 0 where it is not known. Throws Error when there are no strands.
std::vector<std::byte> encodeUsda(const StrandSet& strands, float unit_meters, const std::string& name);

}  // namespace strandcast
