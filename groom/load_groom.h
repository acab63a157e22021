#pragma once
#include <filesystem>
#include <vector>

#include "groom/groom.h"
#include "io/groom_file.h"

namespace strandcast {

/// Reads one or more files (at most 65,535) into one groom in metres, Y up, and cleans it (cleanStrands).
/// `parts` holds the index of each strand's file.
///
/// A given unit applies to all files. Else each file that states its unit is read in that unit; one unit is
/// guessed for all files when none states it. The up axis is each file's own unless given. Warns when a given
/// unit or axis contradicts a file, and of a size or position that no hair has.
///
/// A pin of vertex 1 is dropped where vertex 0 is pinned and vertex 2 is free, unless pins are kept: the
/// root's frame is clamped instead.
///
/// Throws Error as readRawGroom(), and when a unit is not positive, when only some of the files state their
/// unit, when a vertex lies 10 km away, or when no strand is left.
Groom loadGroom(const std::vector<std::filesystem::path>& files, const GroomReadOptions& options);

}  // namespace strandcast
