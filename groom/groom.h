#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "core/strand_set.h"
#include "io/groom_file.h"

namespace strandcast {

/// Findings of loading and cleaning a groom. Counts are of strands unless stated.
struct GroomReport {
  size_t strands_read = 0;
  size_t dropped_short = 0;  ///< fewer than 2 distinct vertices, or shorter than 1 % of the median length
  size_t duplicate_vertices = 0;  ///< vertices of kept strands that were merged with a neighbour
  size_t reversed = 0;            ///< strands reversed because their tip was nearer the scalp than the root
  size_t both_ends_pinned = 0;    ///< kept strands whose tip is pinned too
  size_t resampled = 0;           ///< strands of more than 128 vertices, resampled to 128
  /// Metres per unit of the files, given or guessed; a body of the same origin has the same unit.
  float unit_meters = 0;
  bool is_unit_guessed = false;       ///< the unit is neither given nor stated by the files
  UpAxis up = UpAxis::kY;             ///< up axis that the first file was read with
  std::vector<std::string> warnings;  ///< one line each, e.g. that the unit was guessed, and from what
  std::vector<std::string> left_out;  ///< other contents of the files (FileReport); with several files one
                                      ///< line per file, "NAME: A, B"

  std::vector<std::string> lines() const;  ///< to print, besides the warnings
};

/// Strands at rest in metres, Y up, with the findings of loading them.
struct Groom {
  std::string name;  ///< of files: their names without folder and extension, joined by "+"
  StrandSet strands;
  std::vector<StrandGroup> groups;  ///< table for StrandSet::groups; may be more than the strands use
  GroomReport report;
};

/// Figures of a groom that `strandcast info` prints. All zero, with an empty box, for a set without strands.
struct GroomSummary {
  size_t strands = 0, vertices = 0;
  size_t min_vertices = 0, max_vertices = 0;  ///< of one strand
  size_t degenerate_strands = 0;              ///< strands that cleaning drops as too short (GroomReport)
  float min_length = 0, median_length = 0, max_length = 0;  ///< m, along the strand
  Box bounds;                                               ///< m
  size_t guides = 0;                                        ///< strands that are marked as guides
  size_t ids = 0, groups = 0, colours = 0;                  ///< different ones
};
/// Accepts strands in any unit. Lengths and bounds are in the unit of the positions.
GroomSummary summarize(const StrandSet& strands);

/// Reads one or more files (at most 65,535) into one groom in metres, Y up, and cleans it (cleanStrands).
/// `parts` holds the index of each strand's file. Groups of different files stay apart, whatever their ids.
/// Where only some files have guide marks or groups, the strands of the others are no guides, or in a group 0
/// of their file. Other values that only some have are left out, with a warning.
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
/// As loadGroom(), with the strands as the files have them: neither cleaned nor checked for their size.
Groom loadUncleanedGroom(const std::vector<std::filesystem::path>& files, const GroomReadOptions& options);

}  // namespace strandcast
